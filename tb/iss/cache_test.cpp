// The caches hold their own data: stale data stay stale until the program cleans or invalidates
// them.
#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

using Kind = BusAccess::Kind;
constexpr std::uint32_t kLine = 0x0020'0000;  ///< a line of cached memory
constexpr std::uint32_t kNop = 0xE1A00000u, kMark = 0xEF000001u;

/// Caches on, r4 = kLine, its page in the TLB, the fill over, code in internal RAM. r12 is lost.
const std::string kStart = std::string(kCachesOn) +
                           " ldr r4, =0x00200000\n ldr r0, [r4, #0x800]\n mov r12, #20\n"
                           "9: subs r12, r12, #1\n bne 9b\n";

class CacheTest : public testing::Test {
 protected:
  Machine m;
  /// Fills of the D-cache after the prologue's own.
  unsigned fills() const {
    unsigned n = 0;
    for (const auto& r : m.port.data_log()) n += r.kind == Kind::kWrap8;
    return n - 1;
  }
  std::vector<BusRecord> writes() const {
    std::vector<BusRecord> out;
    for (const auto& r : m.port.log)
      if (r.write) out.push_back(r);
    return out;
  }
};

TEST_F(CacheTest, DataIsStaleUntilInvalidated) {
  m.port.set_word(kLine, 1);
  m.on_svc = [this](std::uint32_t) { m.port.set_word(kLine, 2); };
  m.execute(kStart +
            "ldr r1, [r4]\n svc #3\n ldr r2, [r4]\n mcr p15, 0, r4, c7, c6, 1\n ldr r3, [r4]");
  EXPECT_EQ(m.core.reg(1), 1u);
  EXPECT_EQ(m.core.reg(2), 1u);
  EXPECT_EQ(m.core.reg(3), 2u);
}

TEST_F(CacheTest, InvalidateBySetAndWayAndAll) {
  m.port.set_word(kLine, 1);
  unsigned n = 1;
  m.on_svc = [&](std::uint32_t) { m.port.set_word(kLine, ++n); };
  // kLine is in set 0; the line at +0x800 came first, into way 0, so this one is in way 1.
  m.execute(kStart +
            "ldr r1, [r4]\n svc #3\n mov r5, #0x80000000\n mcr p15, 0, r5, c7, c6, 2\n"
            "ldr r2, [r4]\n mov r5, #0x40000000\n mcr p15, 0, r5, c7, c6, 2\n ldr r3, [r4]\n"
            "svc #3\n mov r5, #0\n mcr p15, 0, r5, c7, c6, 0\n ldr r6, [r4]");
  EXPECT_EQ(m.core.reg(2), 1u) << "another way was invalidated";
  EXPECT_EQ(m.core.reg(3), 2u);
  EXPECT_EQ(m.core.reg(6), 3u);
}

TEST_F(CacheTest, InvalidateLosesWhatWasNotCleaned) {
  m.port.set_word(kLine, 1);
  m.execute(kStart +
            "ldr r1, [r4]\n mov r1, #9\n str r1, [r4]\n mcr p15, 0, r4, c7, c6, 1\n ldr r2, [r4]");
  EXPECT_EQ(m.core.reg(2), 1u);
  EXPECT_TRUE(writes().empty());
}

/// A store that hits stays in the cache until one of the clean operations.
class CleanTest : public CacheTest, public testing::WithParamInterface<const char*> {};
TEST_P(CleanTest, BringsDirtyDataToMemory) {
  std::vector<std::uint32_t> seen;
  m.port.set_word(kLine, 1);
  m.on_svc = [&](std::uint32_t) { seen.push_back(m.port.word(kLine)); };
  const std::string drain = "mov r5, #0\n mcr p15, 0, r5, c7, c10, 4\n svc #3\n";
  m.execute(kStart + "ldr r1, [r4]\n mov r1, #9\n str r1, [r4]\n" + drain + GetParam() + "\n" +
            drain + "ldr r2, [r4]");
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0], 1u);
  EXPECT_EQ(seen[1], 9u);
  EXPECT_EQ(m.core.reg(2), 9u);
  ASSERT_EQ(writes().size(), 1u);
  EXPECT_EQ(writes()[0].address, kLine);
  EXPECT_EQ(writes()[0].bytes, 16u) << "one dirty half";
  EXPECT_EQ(writes()[0].kind, Kind::kIncr4);
}
INSTANTIATE_TEST_SUITE_P(Operations, CleanTest,
                         testing::Values("mcr p15, 0, r4, c7, c10, 1", "mcr p15, 0, r4, c7, c14, 1",
                                         "mov r5, #0x40000000\n mcr p15, 0, r5, c7, c10, 2",
                                         "mov r5, #0x40000000\n mcr p15, 0, r5, c7, c14, 2",
                                         "1: mrc p15, 0, r15, c7, c10, 3\n bne 1b",
                                         "1: mrc p15, 0, r15, c7, c14, 3\n bne 1b"));

TEST_F(CacheTest, TestAndCleanTakesOneStepForEachDirtyLine) {
  m.execute(kStart +
            "add r6, r4, #0x400\n ldr r1, [r4]\n ldr r1, [r4, #64]\n ldr r1, [r6]\n str r1, [r4]\n"
            "str r1, [r4, #64]\n str r1, [r6]\n mov r7, #0\n"
            "1: add r7, r7, #1\n mrc p15, 0, r15, c7, c10, 3\n bne 1b\n"
            "mov r5, #0\n mcr p15, 0, r5, c7, c10, 4");
  EXPECT_EQ(m.core.reg(7), 4u) << "three dirty lines, and the step that finds none";
  EXPECT_EQ(writes().size(), 3u);
}

TEST_F(CacheTest, CleanKeepsTheLineAndCleanInvalidateDoesNot) {
  m.execute(kStart + "ldr r1, [r4]\n mcr p15, 0, r4, c7, c10, 1\n ldr r1, [r4]\n");
  EXPECT_EQ(fills(), 1u);
  Machine other;
  other.execute(kStart + "ldr r1, [r4]\n mcr p15, 0, r4, c7, c14, 1\n ldr r1, [r4]\n");
  EXPECT_EQ(other.core.counts().dcache_read_fills, 3u);
}

TEST_F(CacheTest, StoreMissDoesNotAllocate) {
  m.execute(kStart +
            "mov r1, #7\n str r1, [r4]\n mov r5, #0\n mcr p15, 0, r5, c7, c10, 4\n svc #1\n"
            "ldr r2, [r4]");
  ASSERT_EQ(writes().size(), 1u);
  EXPECT_EQ(writes()[0].bytes, 4u);
  EXPECT_EQ(fills(), 1u) << "the load, not the store";
  EXPECT_EQ(m.port.word(kLine), 7u);
  EXPECT_EQ(m.core.reg(2), 7u);
  EXPECT_EQ(m.core.counts().dcache_write_misses, 1u);
}

TEST_F(CacheTest, HalfLinesAreDirtyByThemselves) {
  struct Row {
    const char* stores;
    std::uint32_t address;
    unsigned bytes;
  };
  for (const Row& row :
       {Row{"str r1, [r4, #12]", kLine, 16}, Row{"strb r1, [r4, #16]", kLine + 16, 16},
        Row{"str r1, [r4, #4]\n strh r1, [r4, #30]", kLine, 32}}) {
    Machine each;
    each.execute(kStart + "ldr r1, [r4]\n" + row.stores +
                 "\n mcr p15, 0, r4, c7, c10, 1\n mov r5, #0\n mcr p15, 0, r5, c7, c10, 4");
    const auto& last = each.port.log.back();
    EXPECT_TRUE(last.write);
    EXPECT_EQ(last.address, row.address) << row.stores;
    EXPECT_EQ(last.bytes, row.bytes) << row.stores;
    EXPECT_EQ(last.kind, row.bytes == 32 ? Kind::kIncr8 : Kind::kIncr4);
  }
}

TEST_F(CacheTest, WriteThroughHitUpdatesCacheAndMemory) {
  m.section(kLine, kLine, 1, 0);
  m.execute(kStart +
            "ldr r1, [r4]\n mov r1, #7\n str r1, [r4]\n ldr r2, [r4]\n mov r5, #0\n"
            "mcr p15, 0, r5, c7, c10, 4");
  EXPECT_EQ(m.core.reg(2), 7u);
  EXPECT_EQ(m.port.word(kLine), 7u);
  EXPECT_EQ(fills(), 1u);
  ASSERT_EQ(writes().size(), 1u);
  EXPECT_EQ(writes()[0].bytes, 4u);
}

TEST_F(CacheTest, ForcedWriteThroughByTheDebugRegister) {
  m.execute(kStart +
            "mov r5, #4\n mcr p15, 7, r5, c15, c0, 0\n ldr r1, [r4]\n mov r1, #7\n str r1, [r4]\n"
            "mov r5, #0\n mcr p15, 0, r5, c7, c10, 4");
  EXPECT_EQ(m.port.word(kLine), 7u);
}

/// 80 ns = 20 clocks to the critical word, 8 ns = 2 clocks a word, 1 clock into the core.
TEST_F(CacheTest, FillIsWrapEightFromTheCriticalWordAndStreams) {
  m.execute(kStart + "add r5, r4, #20\n svc #1\n ldr r0, [r5]\n svc #1\n");
  const auto fill = m.port.data_log().back();
  EXPECT_EQ(fill.kind, Kind::kWrap8);
  EXPECT_EQ(fill.address, kLine + 20);
  EXPECT_EQ(fill.bytes, 32u);
  const std::uint64_t start = m.marks[0] + 3, sync = start & 1u;
  EXPECT_EQ(m.between(), sync + 20 + 1 + 1);
  EXPECT_EQ(m.stall(Cause::kBusSync) > 0 || sync == 0, true);

  // The next word comes two clocks after the first: one of them is the first load's issue.
  Machine next;
  next.execute(kStart + "add r5, r4, #20\n svc #1\n ldr r0, [r5]\n ldr r1, [r5, #4]\n svc #1\n");
  EXPECT_EQ(next.between(), sync + 21 + 2 + 1);
  // The word before the critical one is the last: seven times two clocks later.
  Machine last;
  last.execute(kStart + "add r5, r4, #20\n svc #1\n ldr r0, [r5]\n ldr r1, [r5, #-4]\n svc #1\n");
  EXPECT_EQ(last.between(), sync + 21 + 14 + 1);
  // A hit in another line waits for the end of the fill.
  Machine other;
  other.execute(kStart +
                "add r5, r4, #20\n svc #1\n ldr r0, [r5]\n ldr r1, [r4, #0x800]\n svc #1\n");
  EXPECT_EQ(other.between(), sync + 21 + 14 + 1);
  // So does a store into it; arithmetic does not.
  Machine work;
  work.execute(kStart +
               "add r5, r4, #20\n svc #1\n ldr r0, [r5]\n mov r2, #0\n mov r3, #0\n svc #1\n");
  EXPECT_EQ(work.between(), sync + 21 + 1 + 2);
}

TEST_F(CacheTest, RoundRobinReplacesInOrder) {
  // RR on; ways 0..3 get lines 1..4 of the set, then 5 replaces 1 and 1 replaces 2.
  const std::string text =
      std::string(kCachesOn) +
      "mrc p15, 0, r0, c1, c0, 0\n orr r0, r0, #0x4000\n mcr p15, 0, r0, c1, c0, 0\n"
      "ldr r4, =0x00200000\n mov r5, #0x800\n"
      "ldr r0, [r4]\n ldr r0, [r4, r5]\n ldr r0, [r4, r5, lsl #1]\n add r6, r4, r5\n"
      "ldr r0, [r6, r5, lsl #1]\n ldr r0, [r4, r5, lsl #2]\n";
  m.execute(text + "ldr r0, [r4, r5]\n ldr r0, [r4, r5, lsl #1]\n");
  EXPECT_EQ(m.core.counts().dcache_read_fills, 5u) << "ways 1 and 2 are still there";
  Machine again;
  again.execute(text + "ldr r0, [r4]\n ldr r0, [r4, r5, lsl #1]\n");
  EXPECT_EQ(again.core.counts().dcache_read_fills, 6u) << "way 0 was replaced, then way 1";
  Machine third;
  third.execute(text + "ldr r0, [r4]\n ldr r0, [r4, r5]\n");
  EXPECT_EQ(third.core.counts().dcache_read_fills, 7u);
}

TEST_F(CacheTest, LockedWayIsNotReplaced) {
  const auto text = [](const char* lock) {
    return std::string(kCachesOn) +
           "ldr r4, =0x00200000\n mov r5, #0x800\n ldr r0, [r4]\n mov r0, #" + lock +
           "\n mcr p15, 0, r0, c9, c0, 0\n mov r7, #24\n add r6, r4, r5\n"
           "1: ldr r0, [r6], r5\n subs r7, r7, #1\n bne 1b\n svc #1\n ldr r0, [r4]\n";
  };
  m.execute(text("1"));
  EXPECT_EQ(m.core.counts().dcache_read_fills, 25u);
  Machine open;
  open.execute(text("0"));
  EXPECT_EQ(open.core.counts().dcache_read_fills, 26u) << "24 fills at random ways replace it";
}

TEST_F(CacheTest, SecondVirtualAddressIsAnotherLine) {
  m.section(0x0070'0000, kLine, 1, 1);
  m.port.set_word(kLine, 1);
  m.execute(kStart +
            "ldr r6, =0x00700000\n ldr r1, [r4]\n mov r1, #9\n str r1, [r4]\n ldr r2, [r6]\n"
            "mcr p15, 0, r4, c7, c10, 1\n mov r5, #0\n mcr p15, 0, r5, c7, c10, 4\n ldr r3, [r6]\n"
            "mcr p15, 0, r6, c7, c6, 1\n ldr r7, [r6]");
  EXPECT_EQ(m.core.reg(2), 1u);
  EXPECT_EQ(m.core.reg(3), 1u) << "cleaned, but this line is a copy of before";
  EXPECT_EQ(m.core.reg(7), 9u);
}

TEST_F(CacheTest, InstructionsAreStaleUntilInvalidated) {
  m.port.set_word(kLine + 0x100, 0xE3A00001u);  // mov r0, #1
  m.port.set_word(kLine + 0x104, 0xE12FFF1Eu);  // bx lr
  const std::string call = "add r6, r4, #0x100\n blx r6\n";
  m.execute(kStart + call + "mov r7, r0\n ldr r1, [r6]\n add r1, r1, #1\n str r1, [r6]\n" + call +
            "mov r8, r0\n mcr p15, 0, r6, c7, c10, 1\n mov r5, #0\n mcr p15, 0, r5, c7, c10, 4\n" +
            call + "mov r9, r0\n mcr p15, 0, r6, c7, c5, 1\n" + call);
  EXPECT_EQ(m.core.reg(7), 1u);
  EXPECT_EQ(m.core.reg(8), 1u) << "patched in the D-cache only";
  EXPECT_EQ(m.core.reg(9), 1u) << "patched in memory, the I-cache does not look";
  EXPECT_EQ(m.core.reg(0), 2u);
}

TEST_F(CacheTest, InstructionInvalidateWithoutCleanReadsTheOldCode) {
  m.port.set_word(kLine + 0x100, 0xE3A00001u);
  m.port.set_word(kLine + 0x104, 0xE12FFF1Eu);
  m.execute(kStart +
            "add r6, r4, #0x100\n blx r6\n ldr r1, [r6]\n add r1, r1, #1\n str r1, [r6]\n"
            "mov r5, #0\n mcr p15, 0, r5, c7, c5, 0\n blx r6\n");
  EXPECT_EQ(m.core.reg(0), 1u);
}

/// Words of an instruction line arrive two clocks apart, and the core runs as they come. The line
/// is entered at word 2, a mark; word 7 is another.
TEST_F(CacheTest, InstructionsStreamIntoTheCore) {
  Program line;
  line.base = kLine + 0x200;
  line.bytes.resize(36);
  const std::uint32_t words[9] = {kNop, kNop, kMark, kNop, kNop, kNop, kNop, kMark, 0xEF000002};
  std::memcpy(line.bytes.data(), words, 36);
  m.load(line);
  m.execute(kStart + "ldr r6, =0x00200208\n mov pc, r6\n");
  ASSERT_GE(m.marks.size(), 2u);
  EXPECT_EQ(m.marks[1] - m.marks[0], 10u) << "five words later";
  for (const auto& r : m.port.log)
    if (r.port == BusAccess::Port::kInstruction) {
      EXPECT_EQ(r.kind, Kind::kWrap8);
      EXPECT_EQ(r.bytes, 32u);
    }
  EXPECT_EQ(m.port.log.at(m.port.log.size() - 2).address, kLine + 0x208);
}

TEST_F(CacheTest, UncachedFetchIsFourWordsAtATime) {
  Program code =
      assemble("nop\n nop\n nop\n nop\n nop\n nop\n b 1f\n nop\n nop\n1: svc #2\n", kLine);
  m.load(code);
  m.execute("ldr r4, =0x00200000\n mov pc, r4\n");
  std::vector<std::uint32_t> fetched;
  for (const auto& r : m.port.log) {
    EXPECT_EQ(r.kind, Kind::kIncr4);
    fetched.push_back(r.address - kLine);
  }
  EXPECT_EQ(fetched, (std::vector<std::uint32_t>{0, 16, 32}));
  EXPECT_EQ(m.core.counts().icache_fills, 0u);
}

TEST_F(CacheTest, InstructionCacheWorksWithoutTheMmu) {
  Program code = assemble("nop\n nop\n nop\n nop\n nop\n nop\n nop\n svc #2\n", kLine);
  m.load(code);
  m.execute(
      "mrc p15, 0, r0, c1, c0, 0\n orr r0, r0, #0x1000\n mcr p15, 0, r0, c1, c0, 0\n ldr r4, "
      "=0x00200000\n"
      "mov pc, r4\n");
  ASSERT_EQ(m.port.log.size(), 1u);
  EXPECT_EQ(m.port.log[0].kind, Kind::kWrap8);
}

TEST_F(CacheTest, UncachedSwapIsLocked) {
  m.section(kLine, kLine, 0, 0);
  m.port.set_word(kLine, 5);
  m.execute(std::string(kCachesOn) +
            "ldr r4, =0x00200000\n mov r1, #9\n swp r0, r1, [r4]\n ldr r2, [r4]\n");
  EXPECT_EQ(m.core.reg(0), 5u);
  EXPECT_EQ(m.core.reg(2), 9u);
  unsigned locked = 0;
  for (const auto& r : m.port.log) {
    EXPECT_EQ(r.locked, r.address == kLine && locked < 2) << r.address;
    locked += r.locked;
  }
  EXPECT_EQ(locked, 2u);
}

TEST_F(CacheTest, SizesAreParameters) {
  // 4 KB: the D-cache has 32 sets, so lines 1 KB apart share one; the fifth drives one out.
  const std::string text =
      std::string(kCachesOn) +
      "ldr r4, =0x00200000\n mov r2, #0\n1: ldr r0, [r4, r2]\n add r2, r2, #0x400\n cmp r2, "
      "#0x1400\n bne 1b\n"
      "mov r2, #0\n2: ldr r0, [r4, r2]\n add r2, r2, #0x400\n cmp r2, #0x1400\n bne 2b\n"
      "mrc p15, 0, r5, c0, c0, 1\n";
  Machine small(Machine::Settings{{"cpu.dcache.size", "4KiB"}});
  small.execute(text);
  EXPECT_GT(small.core.counts().dcache_read_fills, 5u);
  EXPECT_EQ(small.core.reg(5), 0x1D0D2152u);  // size code 3 (4 KB) in bits 20:18
  m.execute(text);
  EXPECT_EQ(m.core.counts().dcache_read_fills, 5u);
}

TEST_F(CacheTest, UncachedReadsAreSinglesAndDoNotAllocate) {
  m.section(kLine, kLine, 0, 0);
  m.execute(std::string(kCachesOn) + "ldr r4, =0x00200000\n ldmia r4, {r0-r3}\n ldr r0, [r4]\n");
  unsigned singles = 0;
  for (const auto& r : m.port.data_log())
    if (!r.write && r.address >= kLine && r.address < kLine + 16) {
      ++singles;
      EXPECT_EQ(r.kind, Kind::kSingle);
      EXPECT_EQ(r.bytes, 4u);
    }
  EXPECT_EQ(singles, 5u);
}

/// Writes are acknowledged after 40 ns = 10 clocks.
TEST_F(CacheTest, UnbufferedWriteStallsAndBufferedDoesNot) {
  const std::string text = std::string(kCachesOn) +
                           "ldr r4, =0x00200000\n ldr r0, [r4]\n svc #1\n str r0, [r4]\n svc #1\n";
  m.section(kLine, kLine, 0, 0);
  m.execute(text);
  const std::uint64_t sync = (m.marks[0] + 3) & 1u;
  EXPECT_EQ(m.between(), sync + 10 + 1);
  Machine buffered;
  buffered.section(kLine, kLine, 0, 1);
  buffered.execute(text);
  EXPECT_EQ(buffered.between(), 1u);
}

/// Eight words in a hit line each way, and the loop around: 8 + 8 + 1 + 3 clocks.
TEST_F(CacheTest, CopyLoopOfCachedLinesTakesTwentyClocks) {
  m.execute(kStart +
            "add r1, r4, #0x400\n mov r10, r4\n mov r11, r1\n mov r12, #2\n"
            "0: ldr r0, [r10]\n ldr r0, [r10, #32]\n ldr r0, [r11]\n ldr r0, [r11, #32]\n"
            "nop\n nop\n mov r9, #0\n3: add r9, r9, #1\n cmp r9, #40\n bne 3b\n svc #1\n"
            "1: ldmia r10!, {r0-r7}\n stmia r11!, {r0-r7}\n subs r12, r12, #1\n bne 1b\n svc #1\n");
  EXPECT_EQ(m.between(), 20u + 18u) << "the last branch is not taken";
}

}  // namespace
}  // namespace fovea::cpu::test
