// model/common/stats.h and clock.h.
#include "model/common/stats.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "model/common/clock.h"
#include "tb/unit/support.h"

namespace fovea {
namespace {

struct Stats : StatGroup {
  Stats() : StatGroup("block") {}
  Counter hits{*this, "hits", "count", "hits"};
  Counter misses{*this, "misses", "count", "misses"};
  Formula ratio{*this, "ratio", "ratio", "hits / all", [this]() -> StatBase::Value {
                  return static_cast<double>(hits.count()) /
                         static_cast<double>(hits.count() + misses.count());
                }};
  int extra = 7;
  void on_reset() override { extra = 0; }
};

TEST(StatGroupTest, NamesCarryTheBlockAndFormulasFollowCounters) {
  Stats s;
  s.hits += 3;
  ++s.misses;
  ASSERT_EQ(s.stats().size(), 3u);
  EXPECT_EQ(s.stats()[2]->name(), "block.ratio");
  EXPECT_EQ(std::get<double>(s.ratio.value()), 0.75);
}

TEST(StatGroupTest, ResetClearsCountersAndWhatIsNoCounter) {
  Stats s;
  s.hits += 3;
  s.reset();
  EXPECT_EQ(s.hits.count(), 0u);
  EXPECT_EQ(s.extra, 0);
}

TEST(HistogramTest, SmallValuesAreExact) {
  Histogram h;
  for (std::uint64_t v = 0; v < 32; ++v) h.add(v);
  // rank ceil(q n) of 0..31
  EXPECT_EQ(h.quantile(0.5), 15u);
  EXPECT_EQ(h.quantile(1.0), 31u);
  EXPECT_EQ(h.quantile(1.0 / 32), 0u);
}

TEST(HistogramTest, MinMaxMeanAreExactAtAnySize) {
  Histogram h;
  h.add(1'000'000'007);
  h.add(3);
  h.add((std::uint64_t{1} << 62) + 1);
  EXPECT_EQ(h.min(), 3u);
  EXPECT_EQ(h.max(), (std::uint64_t{1} << 62) + 1);
  EXPECT_EQ(h.quantile(1.0), h.max());
  EXPECT_DOUBLE_EQ(h.mean(), (4611686018427387905.0 + 1'000'000'007.0 + 3.0) / 3);
}

TEST(HistogramTest, QuantilesStayWithinABucketAboveTheSortedValues) {
  std::mt19937_64 random(20240229);
  std::vector<std::uint64_t> values;
  Histogram h;
  for (int i = 0; i < 5000; ++i) {
    const std::uint64_t v = random() >> (random() % 64);
    if (v >> 62) continue;  // the sum stays in 64 bits for what the mean promises
    values.push_back(v);
    h.add(v);
  }
  std::sort(values.begin(), values.end());
  for (const double q : {0.01, 0.5, 0.95, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
    const std::uint64_t exact = values[rank - 1];
    EXPECT_GE(h.quantile(q), exact) << q;
    // 256 buckets per factor of two: a bucket is at most 1/256 of its lower edge wide.
    EXPECT_LE(h.quantile(q) - exact, exact / 256) << q;
  }
}

TEST(HistogramTest, EmptyHasZeroes) {
  Histogram h;
  EXPECT_EQ(h.quantile(0.5), 0u);
  EXPECT_EQ(h.mean(), 0.0);
  EXPECT_EQ(h.min(), 0u);
  h.add(9);
  h.reset();
  EXPECT_EQ(h.count(), 0u);
  EXPECT_EQ(h.max(), 0u);
}

TEST(ClockTest, EdgesDoNotDrift) {
  // 297 MHz: 297 periods are exactly 1 us; edge k is floor(k * 10^6 / 297).
  const Clock clock{Frequency{297'000'000}, 5};
  EXPECT_EQ(clock.edge(0), 5u);
  EXPECT_EQ(clock.edge(1), 5u + 3367);
  EXPECT_EQ(clock.edge(297), 5u + 1'000'000);
  EXPECT_EQ(clock.edge(297'000'000), 5u + kPsPerSecond);
}

TEST(ClockTest, LookupIsTheInverseOfEdgeAtItsExactTime) {
  const Clock clock{Frequency{30'000'000, 1001}};
  for (std::uint64_t k : {1ull, 2ull, 1000ull, 29'970'030ull}) {
    const Picoseconds t = clock.edge(k);
    EXPECT_EQ(clock.edge_at_or_after(t - 1), k);
    EXPECT_EQ(clock.edge_at_or_after(t), k);
    EXPECT_EQ(clock.edge_at_or_after(t + 1), k + 1);
    EXPECT_EQ(clock.edge_after(t), k + 1);
    EXPECT_EQ(clock.next_edge_after(t - 1), t);
  }
}

TEST(ClockTest, FrequencyChangeRestartsAtItsTimeAndNumberingGoesOn) {
  Clock clock{Frequency{100'000'000}};           // 10 ns
  clock.restart(Frequency{50'000'000}, 25'000);  // edges 0, 10, 20 ns have passed
  EXPECT_EQ(clock.edge(3), 25'000u);
  EXPECT_EQ(clock.edge(4), 45'000u);
  EXPECT_EQ(clock.edge_at_or_after(25'001), 4u);
}

TEST(ClockTest, StoppedClockIsNotRunning) {
  Clock clock{Frequency{1'000'000}};
  clock.restart(Frequency{}, 10);
  EXPECT_FALSE(clock.running());
}

}  // namespace
}  // namespace fovea
