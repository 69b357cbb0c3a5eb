// Every clock has one cause, and timing does not change the results of a program.
#include <cstdlib>
#include <iostream>
#include <random>

#include "tb/iss/vectors.h"

namespace fovea::cpu::test {
namespace {

/// Pseudo-random loads, stores, block transfers, multiplies and uncached accesses over 64 KB, from
/// cached memory; it sleeps now and then if r11 is not 0. Ends with everything in memory and a sum
/// in r0.
const std::string kWork = R"(
  ldr r4, =0x00200000
  ldr r5, =0x00400000
  ldr r6, =12345
  ldr r7, =1664525
  ldr r8, =600
  mov r0, #0
1: mla r6, r7, r6, r8
  mov r1, r6, lsr #16
  bic r1, r1, #3
  ldr r2, [r4, r1]
  add r0, r0, r2
  eor r2, r2, r6
  tst r6, #0x100
  strne r2, [r4, r1]
  strbeq r2, [r4, r1]
  tst r6, #0x1e00
  bne 2f
  bic r1, r1, #0xff
  add r3, r4, r1
  ldmia r3, {r1, r2, r9, r10}
  add r0, r0, r10
  stmia r3!, {r0, r1, r2, r6, r7, r8, r9, r10}
2: tst r6, #0x6000
  bne 3f
  ldrh r2, [r5, #6]
  add r2, r2, #1
  strh r2, [r5, #6]
3: tst r6, #0xf8000
  bne 4f
  cmp r11, #0
  mov r2, #0
  mcrne p15, 0, r2, c7, c0, 4
4: subs r8, r8, #1
  bne 1b
5: mrc p15, 0, r15, c7, c10, 3
  bne 5b
  mov r2, #0
  mcr p15, 0, r2, c7, c10, 4
  svc #2
  .ltorg
)";
constexpr std::uint32_t kCode = 0x0014'0000;

/// Vectors and caches from internal RAM, then the work, which lies in cached memory.
struct Worker : Machine {
  explicit Worker(bool sleeps) {
    section(0x0040'0000, 0x0040'0000, 0, 0);
    std::mt19937 random(1);
    for (std::uint32_t k = 0; k < 65536; k += 4)
      port.set_word(0x0020'0000 + k, static_cast<std::uint32_t>(random()));
    static const Program work = assemble(kWork, kCode);
    static const Program boot = assemble(
        kVectors + kCachesOn + "msr cpsr_c, #0x1f\n ldr r0, =0x00140000\n mov pc, r0\n .ltorg\n",
        0);
    load(work);
    load(boot);
    core.set_reg(11, sleeps);
    on_svc = [this](std::uint32_t n) {
      if (n == 4) {
        core.set_irq(false, time());
        port.interrupt_at(kNever);
      }
    };
  }
  /// The interrupt comes every so often, from `t` on.
  void tick(Picoseconds t, Picoseconds every) {
    port.schedule(t, [this, t, every] {
      core.set_irq(true, t);
      port.interrupt_at(t);
      if (t < limit / 2) tick(t + every, every);
    });
  }
  std::uint64_t bytes(bool write) const {
    std::uint64_t n = 0;
    for (const auto& r : port.log) n += r.write == write ? r.bytes : 0;
    return n;
  }
  std::vector<std::uint8_t> memory() {
    return {port.at(0x0020'0000), port.at(0x0020'0000) + 65536 + 64};
  }
};

void expect_identity(const Counts& from, const Counts& to) {
  std::uint64_t sum = to.issue - from.issue + to.idle - from.idle;
  for (std::size_t k = 0; k < kCauses; ++k) sum += to.stall[k] - from.stall[k];
  EXPECT_EQ(to.cycles - from.cycles, sum);
}

TEST(ConservationTest, TimeDoesNotChangeWhatTheProgramDoes) {
  Worker at_once(false), usual(false), slow(false), uneven(false);
  at_once.port.read_latency = at_once.port.beat = at_once.port.write_latency = 0;
  slow.port.read_latency = 700'000;
  slow.port.beat = 24'000;
  slow.port.write_latency = 300'000;
  std::mt19937 random(5);
  uneven.port.extra = [&] { return Picoseconds{random() % 200'000}; };
  for (Worker* w : {&at_once, &usual, &slow, &uneven}) w->run();
  for (Worker* w : {&usual, &slow, &uneven}) {
    EXPECT_EQ(w->core.counts().instructions, at_once.core.counts().instructions);
    EXPECT_EQ(w->core.reg(0), at_once.core.reg(0));
    EXPECT_EQ(w->bytes(false), at_once.bytes(false));
    EXPECT_EQ(w->bytes(true), at_once.bytes(true));
    EXPECT_EQ(w->memory(), at_once.memory());
    EXPECT_EQ(w->core.counts().issue, at_once.core.counts().issue);
    EXPECT_GT(w->core.clock_count(), at_once.core.clock_count());
  }
  const Counts& c = usual.core.counts();
  EXPECT_GT(c.dcache_writebacks, 0u);
  for (const Cause cause : {Cause::kInterlock, Cause::kIcache, Cause::kDcache, Cause::kUncached,
                            Cause::kTlb, Cause::kCacheOp, Cause::kBusSync})
    EXPECT_GT(usual.stall(cause), 0u) << "the work must meet every kind of stall";
  EXPECT_GT(slow.stall(Cause::kWriteBuffer), 0u);
  EXPECT_GT(slow.stall(Cause::kDrain), 0u);
}

/// An outcome announced ahead of its time or at it: the same clocks, accesses and times.
TEST(ConservationTest, EarlyAndLateOutcomesGiveTheSameTimes) {
  for (const bool sleeps : {false, true}) {
    Worker early(sleeps), late(sleeps);
    late.port.decide_late = true;
    for (Worker* w : {&early, &late}) {
      w->tick(2'000'000, 3'333'331);
      w->run();
    }
    EXPECT_EQ(early.core.clock_count(), late.core.clock_count());
    EXPECT_EQ(early.core.counts().idle, late.core.counts().idle);
    EXPECT_EQ(early.core.counts().idle > 0, sleeps);
    EXPECT_GT(taken(early).size(), 10u);
    EXPECT_EQ(early.core.counts().stall, late.core.counts().stall);
    EXPECT_EQ(early.memory(), late.memory());
    ASSERT_EQ(early.port.log.size(), late.port.log.size());
    for (std::size_t k = 0; k < early.port.log.size(); ++k) {
      ASSERT_EQ(early.port.log[k].at, late.port.log[k].at) << "access " << k;
      ASSERT_EQ(early.port.log[k].address, late.port.log[k].address) << "access " << k;
    }
  }
}

TEST(ConservationTest, WindowsAtRandomTimesAddUp) {
  const std::uint64_t seed =
      std::getenv("FOVEA_SEED") ? std::strtoull(std::getenv("FOVEA_SEED"), nullptr, 0) : 31;
  std::cout << "seed " << seed << "\n";
  std::mt19937_64 random(seed);
  unsigned within_sleep = 0;
  for (unsigned n = 0; n < 40; ++n) {
    Worker w(true);
    w.port.decide_late = n & 1u;
    w.tick(1'000'000 + random() % 1000, 7'000'000 + random() % 10'000'000);
    const Picoseconds first = random() % 60'000'000,
                      second = first + 100'000 + random() % 60'000'000;
    w.port.schedule(first, [&] { w.core.mark_window(first); });
    w.port.schedule(second, [&] { w.core.mark_window(second); });
    w.run();
    const Counts& from = w.core.window_stats().from;
    const Counts& to = w.core.window_stats().to;
    ASSERT_TRUE(w.core.mark_done());
    expect_identity(from, to);
    EXPECT_GE(from.cycles, first / Machine::kClock + 1) << "strictly after the mark";
    EXPECT_GE(to.cycles, second / Machine::kClock + 1);
    // No later than the longest that one instruction can take here: eight words, all missing.
    EXPECT_LE(from.cycles, first / Machine::kClock + 1 + 400);
    EXPECT_LE(to.cycles, second / Machine::kClock + 1 + 400);
    EXPECT_GT(to.cycles, from.cycles);
    within_sleep +=
        from.idle && w.core.counts().idle > from.idle && from.cycles == first / Machine::kClock + 1;
  }
  EXPECT_GT(within_sleep, 0u) << "some marks must fall into a sleep";
}

TEST(ConservationTest, MarkInASleepSplitsItExactly) {
  Machine m;
  m.port.schedule(400'001, [&] { m.core.mark_window(400'001); });
  m.port.schedule(799'999, [&] { m.core.mark_window(799'999); });
  m.port.schedule(1'000'000, [&] {
    m.core.set_irq(true, 1'000'000);
    m.port.interrupt_at(1'000'000);
  });
  m.execute("mov r0, #0\n mcr p15, 0, r0, c7, c0, 4\n nop");
  const Counts& from = m.core.window_stats().from;
  const Counts& to = m.core.window_stats().to;
  EXPECT_EQ(from.cycles, 101u);
  EXPECT_EQ(to.cycles, 200u);
  EXPECT_EQ(to.idle - from.idle, 99u);
  EXPECT_EQ(to.instructions, from.instructions);
  expect_identity(from, to);
}

/// The clock changes under the core while its buffers are full: numbering goes on, sums too.
TEST(ConservationTest, ClockChangeInTheMiddle) {
  std::vector<std::uint8_t> memory;
  for (const std::uint64_t hertz : {250'000'000u, 100'000'000u, 297'000'000u}) {
    for (const Picoseconds at : {30'000'000u, 30'010'001u, 41'234'567u}) {
      Worker w(false);
      w.port.ahb_period = 0;
      w.port.decide_late = true;
      w.port.schedule(at, [&w, at, hertz] { w.core.set_clock(Frequency(hertz), at); });
      w.run();
      if (memory.empty()) memory = w.memory();
      EXPECT_EQ(w.memory(), memory);
    }
  }
}

/// A mark that is made while an instruction is executed is taken at its end, although no event is due.
TEST(ConservationTest, MarkWithinAnInstruction) {
  Machine m;
  std::vector<std::uint64_t> at;
  m.on_svc = [&](std::uint32_t) {
    at.push_back(m.core.clock_count());
    m.core.mark_window(m.time());
  };
  m.execute("mov r0, #100\n svc #3\n1: subs r0, r0, #1\n bne 1b\n svc #4\n mov r0, #100\n2: subs r0, r0, #1\n bne 2b");
  ASSERT_EQ(at.size(), 2u);
  ASSERT_TRUE(m.core.mark_done());
  EXPECT_EQ(m.core.window_stats().from.cycles, at[0] + 3);
  EXPECT_EQ(m.core.window_stats().to.cycles, at[1] + 3);
}

}  // namespace
}  // namespace fovea::cpu::test
