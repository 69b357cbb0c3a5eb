// Interrupt controller, timer counter and PLL arithmetic, without SystemC.
#include <gtest/gtest.h>

#include "model/periph/core/aintc_core.h"
#include "model/periph/core/pll_rules.h"
#include "model/periph/core/timer_counter.h"

namespace fovea::periph {
namespace {

constexpr std::uint64_t bit(unsigned n) { return std::uint64_t{1} << n; }

struct AintcTest : testing::Test {
  AintcCore core{/*level_capture=*/false};
  std::uint32_t read(std::uint32_t offset) { return read(core, offset); }
  static std::uint32_t read(AintcCore& c, std::uint32_t offset) {
    std::uint32_t v = 0;
    EXPECT_EQ(c.regs.read(offset, 4, v), Access::kOk);
    return v;
  }
  void write(std::uint32_t offset, std::uint32_t v) { core.regs.write(offset, 4, v); }
  void enable(unsigned n) { write(n < 32 ? 0x18 : 0x1C, 1u << n % 32); }
  void pulse(unsigned n) {
    core.set_sources(bit(n));
    core.set_sources(0);
  }
};

TEST_F(AintcTest, StatusIsAllOnesAfterReset) {
  for (std::uint32_t r : {0x00, 0x04, 0x08, 0x0C}) EXPECT_EQ(read(r), 0xFFFFFFFFu) << r;
  EXPECT_EQ(read(0x18), 0u);
  EXPECT_EQ(read(0x30), 0x77777777u);
}

TEST_F(AintcTest, RisingEdgeLatchesWhileDisabledAndThePinWaitsForTheEnable) {
  pulse(32);
  EXPECT_EQ(read(0x0C), 0xFFFFFFFEu);  // 0 = pending
  EXPECT_EQ(read(0x04), 0xFFFFFFFFu);  // not shown as FIQ
  EXPECT_FALSE(core.irq());
  EXPECT_EQ(read(0x14), 0u);
  enable(32);
  EXPECT_TRUE(core.irq());
  EXPECT_EQ(read(0x14), 4u * 33);
}

TEST_F(AintcTest, DisableAtOnceDropsPinAndEntryButKeepsTheLatch) {
  enable(5);
  pulse(5);
  ASSERT_TRUE(core.irq());
  write(0x18, 0);
  EXPECT_FALSE(core.irq());
  EXPECT_EQ(read(0x14), 0u);
  EXPECT_EQ(read(0x08), ~(1u << 5));
}

TEST_F(AintcTest, IdmodeHoldsADisabledInterruptUntilItsAcknowledge) {
  write(0x20, 4);
  enable(5);
  pulse(5);
  write(0x18, 0);
  EXPECT_TRUE(core.irq());
  write(0x08, 1u << 5);
  EXPECT_FALSE(core.irq());
}

TEST_F(AintcTest, AnAcknowledgeEndsTheHoldOfIdmodeForLaterEdgesToo) {
  write(0x20, 4);
  enable(5);
  pulse(5);
  write(0x18, 0);
  write(0x08, 1u << 5);
  pulse(5);  // disabled now, so this one only latches
  EXPECT_FALSE(core.irq());
  EXPECT_EQ(read(0x08), ~(1u << 5));
}

TEST_F(AintcTest, WritingOneAcknowledgesOnlyThatSource) {
  write(0x18, 0x30);
  pulse(4);
  pulse(5);
  write(0x08, 1u << 4);
  EXPECT_EQ(read(0x08), ~(1u << 5));
  EXPECT_TRUE(core.irq());
  write(0x08, 0xFFFFFFFF);
  EXPECT_FALSE(core.irq());
}

TEST_F(AintcTest, SourceStillHighDoesNotLatchAgain) {
  enable(40);
  core.set_sources(bit(40));
  write(0x0C, 1u << 8);
  core.set_sources(bit(40));
  EXPECT_FALSE(core.irq());
  core.set_sources(0);
  core.set_sources(bit(40));
  EXPECT_TRUE(core.irq());
}

TEST_F(AintcTest, LevelCaptureLatchesASourceStillHighAgain) {
  AintcCore level{true};
  level.regs.write(0x1C, 4, 1u << 8);
  level.set_sources(bit(40));
  level.regs.write(0x0C, 4, 1u << 8);
  EXPECT_TRUE(level.irq());
  level.set_sources(0);
  level.regs.write(0x0C, 4, 1u << 8);
  EXPECT_FALSE(level.irq());
}

TEST_F(AintcTest, HigherPriorityComesFirstAndTiesGoToTheLowerNumber) {
  write(0x18, 0xFFFFFFFF);
  pulse(20);
  pulse(9);
  EXPECT_EQ(read(0x14), 4u * 10);
  write(0x38, 0x77727777);  // source 20: priority 2
  EXPECT_EQ(read(0x14), 4u * 21);
}

TEST_F(AintcTest, PrioritiesZeroAndOneAreFiq) {
  write(0x30, 0x77777170);  // source 0: 0, source 2: 1
  write(0x18, 0x7);
  pulse(2);
  EXPECT_TRUE(core.fiq());
  EXPECT_FALSE(core.irq());
  EXPECT_EQ(read(0x00), ~4u);
  EXPECT_EQ(read(0x08), ~0u);
  pulse(0);
  EXPECT_EQ(read(0x10), 4u * 1);
  write(0x08, ~0u);  // an IRQ acknowledge does not reach a FIQ
  EXPECT_TRUE(core.fiq());
  write(0x00, ~0u);
  EXPECT_FALSE(core.fiq());
  pulse(2);
  write(0x30, 0x77777270);  // source 2: now an IRQ, also one that is pending
  EXPECT_FALSE(core.fiq());
  EXPECT_TRUE(core.irq());
}

TEST_F(AintcTest, EntryIsBasePlusNumberPlusOneTimesSize) {
  write(0x24, 0x01234560 | 2);         // 16-byte entries
  EXPECT_EQ(read(0x14), 0x01234560u);  // spurious
  enable(63);
  pulse(63);
  EXPECT_EQ(read(0x14), 0x01234560u + 64 * 16);
}

TEST_F(AintcTest, RawEntryAlsoShowsDisabledSources) {
  pulse(7);
  EXPECT_EQ(read(0x14), 0u);
  write(0x20, 2);
  EXPECT_EQ(read(0x14), 4u * 8);
  EXPECT_FALSE(core.irq());
}

TEST_F(AintcTest, EntryFollowsWhatIsPendingAtTheRead) {
  write(0x18, ~0u);
  pulse(9);
  EXPECT_EQ(read(0x14), 4u * 10);
  pulse(3);
  EXPECT_EQ(read(0x14), 4u * 4);
  write(0x08, 1u << 3);
  EXPECT_EQ(read(0x14), 4u * 10);
}

TEST(TimerCounterTest, PeriodicMatchesEveryPeriodPlusOne) {
  TimerCounter c(32);
  c.set_period(9, 0);
  c.start(0, /*once=*/false);
  EXPECT_EQ(c.next_match(0), 9u);
  EXPECT_EQ(c.next_match(8), 9u);
  EXPECT_EQ(c.next_match(9), 19u);
  EXPECT_EQ(c.value(8), 8u);
  EXPECT_EQ(c.value(9), 9u);
  EXPECT_EQ(c.value(10), 0u);
  EXPECT_EQ(c.value(25), 5u);
}

TEST(TimerCounterTest, OnceStopsAtThePeriod) {
  TimerCounter c(32);
  c.set_period(9, 0);
  c.start(100, true);
  EXPECT_EQ(c.next_match(100), 109u);
  EXPECT_EQ(c.value(500), 9u);
  EXPECT_EQ(c.next_match(109), kNever);
}

/// SPRUH82C, match: the counter is 0 one count after its period, also if it was put there.
TEST(TimerCounterTest, CounterThatStartsAtThePeriodContinuesFromZero) {
  TimerCounter c(32);
  c.set_value(5, 0);
  c.set_period(5, 0);
  c.start(100, false);
  EXPECT_EQ(c.next_match(100), 106u);
  EXPECT_EQ(c.next_match(105), 106u);
  EXPECT_EQ(c.next_match(106), 112u);
  for (std::uint64_t n = 0; n < 20; ++n) EXPECT_EQ(c.value(100 + n), (5 + n) % 6) << n;
  TimerCounter whole(64);
  whole.set_value(~0ull, 0);
  whole.set_period(~0ull, 0);
  whole.start(0, false);
  EXPECT_EQ(whole.value(0), ~0ull);
  EXPECT_EQ(whole.value(1), 0u);
  EXPECT_EQ(whole.next_match(0), kNever) << "in 2^64 counts";
}

TEST(TimerCounterTest, CounterAboveThePeriodRunsOverItsTop) {
  // SPRUH82C, counter overflow: from 0x10000 with period 0xFFFF up to 2^32 - 1, then to 0xFFFF.
  TimerCounter c(32);
  c.set_value(0x10000, 0);
  c.set_period(0xFFFF, 0);
  c.start(0, false);
  EXPECT_EQ(c.next_match(0), (1ull << 32) - 0x10000 + 0xFFFF);
  EXPECT_EQ(c.value((1ull << 32) - 0x10000), 0u);
}

TEST(TimerCounterTest, PrescalerDividesAndKeepsItsPhaseAcrossAWrite) {
  TimerCounter c(32);
  c.set_period(100, 0);
  c.start(0, false, 4);
  EXPECT_EQ(c.value(3), 0u);
  EXPECT_EQ(c.value(4), 1u);
  c.set_value(50, 6);  // phase 2
  EXPECT_EQ(c.value(7), 50u);
  EXPECT_EQ(c.value(8), 51u);
  EXPECT_EQ(c.next_match(6), 8u + 49 * 4);
}

TEST(TimerCounterTest, PeriodZeroNeverMatches) {
  TimerCounter c(32);
  c.start(0, false);
  EXPECT_EQ(c.next_match(0), kNever);
  EXPECT_EQ(c.value(77), 77u);
}

// A match 2^62 clocks ahead is the last one that is told, with and without a prescaler.
TEST(TimerCounterTest, TheFurthestMatchThatIsTold) {
  constexpr std::uint64_t kFar = std::uint64_t{1} << 62;
  for (const std::uint64_t prescale : {1u, 4u}) {
    TimerCounter c(64);
    c.set_period(kFar / prescale, 0);
    c.start(7, false, prescale);
    EXPECT_EQ(c.next_match(7), 7 + kFar) << prescale;
    c.stop(7);
    c.set_period(kFar / prescale + 1, 7);
    c.start(7, false, prescale);
    EXPECT_EQ(c.next_match(7), kNever) << prescale;
  }
}

TEST(TimerCounterTest, SixtyFourBitFreeRunningCounterHasNoMatchInSight) {
  TimerCounter c(64);
  c.set_period(~0ull, 0);
  c.start(0, false);
  EXPECT_EQ(c.next_match(1000), kNever);
  EXPECT_EQ(c.value(1000), 1000u);
}

TEST(PllRulesTest, DoublesTheMultiplier) {
  EXPECT_EQ(vco(Frequency(24'000'000), 0x51, 0x8007), Frequency(486'000'000));
  EXPECT_EQ(vco(Frequency(24'000'000), 0x63, 0x8007), Frequency(594'000'000));
  EXPECT_TRUE(vco(Frequency(24'000'000), 0x51, 0x0007).stopped());
  // 680 MHz does not divide by 9 in whole hertz: the frequency stays a fraction.
  EXPECT_EQ(divided(vco(Frequency(24'000'000), 0x55, 0x8005), 0x8008), Frequency(680'000'000, 9));
}

}  // namespace
}  // namespace fovea::periph
