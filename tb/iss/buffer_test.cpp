// The write buffer (four addresses, sixteen words) and the victim buffer (one line).
#include <algorithm>

#include "tb/iss/machine.h"

namespace fovea::cpu::test::buffer {
namespace {

using Kind = BusAccess::Kind;
constexpr std::uint32_t kBlock = 0x0020'0000;
/// Caches on, r4 = kBlock, its page in the TLB, the fill over. r12 is lost. The program's own page is
/// looked up first, behind the two instructions fetched before the MMU was on.
const std::string kStart = std::string(kCachesOn) +
                           " nop\n nop\n ldr r4, =0x00200000\n ldr r0, [r4, #0xc00]\n mov r12, #20\n"
                           "9: subs r12, r12, #1\n bne 9b\n";
const std::string kDrain = "mov r12, #0\n mcr p15, 0, r12, c7, c10, 4\n";

class BufferTest : public testing::Test {
 protected:
  Machine m;
  /// "W20 R32 ..." of the D port from the first access after the prologue on.
  std::string traffic() const {
    std::string out;
    bool begun = false;
    for (const auto& r : m.port.data_log()) {
      if (begun)
        out += std::string(out.empty() ? "" : " ") + (r.write ? "W" : "R") +
               std::to_string(r.bytes) + "@" + std::to_string(r.address - kBlock);
      begun |= r.kind == Kind::kWrap8;  // the prologue's load
    }
    return out;
  }
};

TEST_F(BufferTest, FourScatteredStoresDoNotStall) {
  m.execute(kStart +
            "svc #1\n str r0, [r4]\n str r0, [r4, #64]\n str r0, [r4, #128]\n str r0, [r4, #192]\n"
            "svc #1\n" +
            kDrain);
  EXPECT_EQ(m.between(), 4u);
  EXPECT_EQ(m.stall(Cause::kWriteBuffer), 0u);
  EXPECT_EQ(traffic(), "W4@0 W4@64 W4@128 W4@192");
}

/// The first write is acknowledged ten clocks after it went out at the AHB edge.
TEST_F(BufferTest, FifthScatteredStoreWaitsForTheFirstAcknowledge) {
  m.execute(kStart +
            "svc #1\n str r0, [r4]\n str r0, [r4, #64]\n str r0, [r4, #128]\n str r0, [r4, #192]\n"
            "str r0, [r4, #256]\n svc #1\n" +
            kDrain);
  const std::uint64_t first = m.marks[0] + 3, out = first + (first & 1u);
  EXPECT_EQ(m.between(), out + 10 + 1 - first);
  EXPECT_EQ(m.stall(Cause::kWriteBuffer), out + 10 - (first + 4));
}

/// A drain counts if there was something to wait for.
TEST_F(BufferTest, DrainsThatWaitedAreCounted) {
  m.execute(kStart + kDrain + "str r0, [r4]\n" + kDrain + kDrain + "str r0, [r4]\n str r0, [r4, #64]\n" + kDrain);
  EXPECT_EQ(m.core.drains(), 2u);
}

TEST_F(BufferTest, SixteenWordsFillIt) {
  // Two STM of eight words fit, a third store waits although addresses are free.
  m.execute(kStart +
            "svc #1\n stmia r4, {r0-r3, r5-r8}\n add r4, r4, #64\n stmia r4, {r0-r3, r5-r8}\n"
            "svc #1\n str r0, [r4, #64]\n svc #1\n" +
            kDrain);
  EXPECT_EQ(m.between(0), 17u);
  EXPECT_GT(m.between(1), 1u);
}

TEST_F(BufferTest, StmIsSplitIntoEightFourAndSingles) {
  m.execute(kStart + "stmia r4, {r0-r12}\n" + kDrain);
  EXPECT_EQ(traffic(), "W32@0 W16@32 W4@48");
}

TEST_F(BufferTest, StmDoesNotCrossAKilobyteInOneBurst) {
  m.execute(kStart + "add r4, r4, #0x3f0\n stmia r4, {r0-r3, r5-r8}\n" + kDrain);
  EXPECT_EQ(traffic(), "W16@1008 W16@1024");
}

TEST_F(BufferTest, BurstsMayEndAtAKilobyte) {
  m.execute(kStart + "add r4, r4, #0x3e0\n stmia r4, {r0-r3, r5-r8}\n add r4, r4, #0x410\n stmia r4, {r0-r3}\n" +
            kDrain);
  EXPECT_EQ(traffic(), "W32@992 W16@2032");
}

TEST_F(BufferTest, AdjacentStoresAreNotMerged) {
  m.execute(kStart + "str r0, [r4]\n str r0, [r4, #4]\n strb r0, [r4, #8]\n strh r0, [r4, #10]\n" +
            kDrain);
  EXPECT_EQ(traffic(), "W4@0 W4@4 W1@8 W2@10");
}

TEST_F(BufferTest, ReadOfAPendingWriteDrainsFirst) {
  m.execute(kStart +
            "mov r1, #7\n mov r2, #8\n str r2, [r4, #0x100]\n str r1, [r4]\n str r2, [r4, #0x200]\n"
            "ldr r3, [r4, #4]\n ldr r5, [r4]\n");
  EXPECT_EQ(traffic(), "W4@256 W4@0 W4@512 R32@4");
  EXPECT_EQ(m.core.reg(5), 7u);
}

TEST_F(BufferTest, OtherReadsPassQueuedWritesButNotTheOneUnderWay) {
  m.execute(kStart +
            "str r0, [r4]\n str r0, [r4, #64]\n str r0, [r4, #128]\n ldr r1, [r4, #0x400]\n" +
            kDrain);
  EXPECT_EQ(traffic(), "W4@0 R32@1024 W4@64 W4@128");
}

TEST_F(BufferTest, UncachedReadKeepsDeviceOrder) {
  m.section(0x0030'0000, 0x0030'0000, 0, 0);
  m.execute(kStart +
            "ldr r6, =0x00300000\n ldr r1, [r6]\n svc #1\n str r0, [r4]\n str r0, [r4, #64]\n"
            "ldr r1, [r6, #4]\n");
  const auto log = m.port.data_log();
  ASSERT_GE(log.size(), 3u);
  EXPECT_TRUE(log[log.size() - 3].write);
  EXPECT_TRUE(log[log.size() - 2].write);
  EXPECT_EQ(log.back().address, 0x0030'0004u);
}

TEST_F(BufferTest, DrainWaitsForEveryAcknowledge) {
  m.execute(kStart +
            "svc #1\n str r0, [r4]\n str r0, [r4, #64]\n str r0, [r4, #128]\n mov r12, #0\n"
            "mcr p15, 0, r12, c7, c10, 4\n svc #1\n");
  // Three writes one after the other, ten clocks each from the first one's AHB edge, then the MCR.
  const std::uint64_t first = m.marks[0] + 3, out = first + (first & 1u);
  EXPECT_EQ(m.marks[1], out + 30);
  EXPECT_GT(m.stall(Cause::kDrain), 0u);
}

/// A dirty line makes way: the fill is read first, the victim follows while the core runs on.
TEST_F(BufferTest, VictimIsWrittenAfterTheFill) {
  m.execute(std::string(kCachesOn) +
            "mrc p15, 0, r0, c1, c0, 0\n orr r0, r0, #0x4000\n mcr p15, 0, r0, c1, c0, 0\n"
            "ldr r4, =0x00200000\n mov r5, #0x800\n add r6, r4, r5\n ldr r0, [r4]\n ldr r0, [r6]\n"
            "ldr r0, [r4, r5, lsl #1]\n ldr r0, [r6, r5, lsl #1]\n mov r1, #5\n str r1, [r4]\n"
            "str r1, [r4, #16]\n ldr r0, [r4, r5, lsl #2]\n svc #1\n" +
            kDrain);
  const auto log = m.port.data_log();
  const auto& fill = log[log.size() - 2];
  const auto& victim = log.back();
  EXPECT_EQ(fill.address, kBlock + 0x2000);
  EXPECT_EQ(fill.kind, Kind::kWrap8);
  EXPECT_TRUE(victim.write);
  EXPECT_EQ(victim.address, kBlock);
  EXPECT_EQ(victim.bytes, 32u);
  EXPECT_GE(victim.at, fill.last);
  EXPECT_EQ(m.port.word(kBlock), 5u);
  EXPECT_EQ(m.core.counts().dcache_writebacks, 1u);
}

TEST_F(BufferTest, ReadOfTheVictimDrainsIt) {
  m.execute(std::string(kCachesOn) +
            "mrc p15, 0, r0, c1, c0, 0\n orr r0, r0, #0x4000\n mcr p15, 0, r0, c1, c0, 0\n"
            "ldr r4, =0x00200000\n mov r5, #0x800\n add r6, r4, r5\n ldr r0, [r4]\n ldr r0, [r6]\n"
            "ldr r0, [r4, r5, lsl #1]\n ldr r0, [r6, r5, lsl #1]\n mov r1, #5\n str r1, [r4]\n"
            "ldr r0, [r4, r5, lsl #2]\n ldr r2, [r4]\n");
  EXPECT_EQ(m.core.reg(2), 5u);
  const auto log = m.port.data_log();
  EXPECT_TRUE(log[log.size() - 2].write);
  EXPECT_EQ(log.back().address, kBlock);
}

/// While the buffers empty by themselves the core runs on: nothing is sent late.
TEST_F(BufferTest, QueuedWritesFollowEachOtherWithoutAGap) {
  m.execute(kStart +
            "str r0, [r4]\n str r0, [r4, #64]\n str r0, [r4, #128]\n mov r7, #100\n"
            "1: subs r7, r7, #1\n bne 1b\n" +
            kDrain);
  EXPECT_EQ(m.stall(Cause::kDrain), 0u) << "they are long gone";
  std::vector<BusRecord> writes;
  for (const auto& r : m.port.data_log())
    if (r.write) writes.push_back(r);
  ASSERT_EQ(writes.size(), 3u);
  EXPECT_EQ(writes[1].at, writes[0].last);
  EXPECT_EQ(writes[2].at, writes[1].last);
}

/// The port is a checker: it must complain.
TEST(FlatPortTest, ComplainsAboutABrokenContract) {
  FlatPort port(kMemory, 4096);
  BusAccess a, b;
  a.address = b.address = kMemory;
  port.submit(a, 16'000);
  EXPECT_THROW(port.submit(b, 24'000), std::logic_error) << "two on one port";
  b.port = BusAccess::Port::kInstruction;
  EXPECT_THROW(port.submit(b, 8'000), std::logic_error) << "back in time";
  EXPECT_THROW(port.submit(b, 17'000), std::logic_error) << "off the AHB clock";
  b.bytes = 16;
  b.kind = Kind::kIncr4;
  b.address = kMemory + 1024 - 8;
  EXPECT_THROW(port.submit(b, 24'000), std::logic_error) << "across 1 KB";
}

/// Notes what memory holds when the core falls asleep.
struct SleepPort : FlatPort {
  using FlatPort::FlatPort;
  std::vector<std::uint32_t> watched, held;
  Picoseconds wait_for_interrupt(Picoseconds t) override {
    for (const std::uint32_t a : watched) held.push_back(word(a));
    return t + 1'000'000;
  }
};

TEST(SleepTest, WaitForInterruptDrainsBothBuffersFirst) {
  MachineWith<SleepPort> m;
  m.port.decide_late = true;
  m.port.write_latency = 400'000;
  // Two stores past the cache, and the dirty lines of one set, one of which a fifth line drives out.
  m.port.watched = {kBlock, kBlock + 64};
  m.execute(kStart +
            "mov r2, #0x11\n add r5, r4, #0x4000\n mov r3, #4\n"
            "1: ldr r0, [r5]\n str r2, [r5], #0x800\n subs r3, r3, #1\n bne 1b\n"
            "mov r12, #0\n str r2, [r4]\n str r2, [r4, #64]\n ldr r0, [r5]\n"
            "mcr p15, 0, r12, c7, c0, 4\n");
  ASSERT_EQ(m.port.held.size(), 2u);
  EXPECT_EQ(m.port.held[0], 0x11u);
  EXPECT_EQ(m.port.held[1], 0x11u);
  const std::vector<BusRecord> log = m.port.data_log();
  const auto victim = std::find_if(log.begin(), log.end(), [](const BusRecord& r) {
    return r.write && r.bytes == 16 && r.address >= kBlock + 0x4000;
  });
  ASSERT_NE(victim, log.end()) << "nothing was written back";
  EXPECT_EQ(m.port.word(victim->address), 0x11u);
  EXPECT_GE(m.core.counts().idle, 240u);
}

/// A buffered store is out before the two locked accesses of a SWP.
TEST_F(BufferTest, SwapComesBehindBufferedStores) {
  m.section(0x0800'0000, kBlock, 0, 0);
  m.execute(kStart +
            "ldr r5, =0x08000000\n ldr r0, [r5, #0x800]\n add r5, r5, #0x100\n mov r1, #3\n"
            "str r0, [r4]\n str r0, [r4, #64]\n swp r2, r1, [r5]\n" + kDrain);
  const auto log = m.port.data_log();
  ASSERT_GE(log.size(), 4u);
  const auto* const end = &log.back() + 1;
  EXPECT_TRUE(end[-4].write && end[-4].address == kBlock);
  EXPECT_TRUE(end[-3].write && end[-3].address == kBlock + 64);
  EXPECT_TRUE(!end[-2].write && end[-2].locked && end[-2].address == kBlock + 0x100);
  EXPECT_TRUE(end[-1].write && end[-1].locked && end[-1].address == kBlock + 0x100);
}

/// Nothing of a line fill that failed stays: the next load asks the bus again, and so does one of the
/// line that had to go for it.
TEST_F(BufferTest, FailedFillIsNotKept) {
  m.section(0x0800'0000, 0x7000'0000, 1, 1);
  const auto fills = [this] {
    const auto log = m.port.data_log();
    return std::count_if(log.begin(), log.end(),
                         [](const BusRecord& r) { return r.address >> 28 == 7; });
  };
  // All four lines of set 0, which is that of the failing ones, too.
  for (std::uint32_t k = 0; k < 4; ++k) m.port.set_word(kBlock + 0x800 * k, 1u << k);
  const std::string sum =
      "mov r6, #0\n mov r7, r4\n mov r3, #4\n8: ldr r0, [r7], #0x800\n add r6, r6, r0\n"
      "subs r3, r3, #1\n bne 8b\n";
  std::vector<std::ptrdiff_t> seen;
  m.on_svc = [&](std::uint32_t) { seen.push_back(fills()); };
  m.execute(kStart +
            "ldr r5, =0x08000000\n" + sum + "mov r8, r6\n ldr r0, [r5]\n svc #3\n ldr r1, [r5]\n"
            "svc #3\n ldr r2, [r5, #4]\n svc #3\n" + sum);
  EXPECT_EQ(seen, (std::vector<std::ptrdiff_t>{1, 2, 3}));
  EXPECT_EQ(m.core.reg(8), 1u + 2 + 4 + 8);
  EXPECT_EQ(m.core.reg(6), m.core.reg(8));
}

// A clock at an edge of the bus stays; any other waits for the next edge, whatever the ratio of the clocks is.
TEST(BusInterfaceTest, TheNextEdgeOfTheBusIsTheNextMultipleOfTheRatio) {
  FlatPort port(0, 4096);
  for (unsigned ratio = 1; ratio <= 8; ++ratio) {
    const BusInterface bus(port, ratio);
    for (std::uint64_t cycle = 0; cycle < 200; ++cycle) {
      std::uint64_t edge = cycle;
      while (edge % ratio != 0) ++edge;
      EXPECT_EQ(bus.ahb(cycle), edge) << ratio << " " << cycle;
    }
  }
}

}  // namespace
}  // namespace fovea::cpu::test::buffer
