// Clock edges against plain wide arithmetic: the clock's fixed-point factors must be exact.
#include "model/common/clock.h"

#include <gtest/gtest.h>

#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

using Wide = unsigned __int128;

TEST(ClockArithmeticTest, EdgesEqualWideDivision) {
  const Frequency clocks[] = {Frequency(243'000'000),     Frequency(121'500'000),
                              Frequency(340'000'000),     Frequency(172'500'000),
                              Frequency(86'250'000),      Frequency(27'000'000),
                              Frequency(24'000'000),      Frequency(1),
                              Frequency(432'000'000),     Frequency(1'000'000'000),
                              Frequency(345'000'000, 16), Frequency(1'000'000'000'000),
                              Frequency(250'000'000),     Frequency(500'000'000'000),
                              Frequency(297'000'000),     Frequency(148'500'000),
                              Frequency(7'812'500),       Frequency(1'023'000'000)};
  Rng rng(1);
  for (const Frequency f : clocks) {
    const Clock clock(f, 1'234);
    const Wide num = f.num, den = f.den;
    for (unsigned i = 0; i < 20'000; ++i) {
      // Up to ten simulated hours, beyond what the factors serve; every fourth time next to an
      // edge, where rounding decides.
      Picoseconds t = rng.below(Picoseconds{i % 3 ? 60u : 36'000u} * kPsPerSecond);
      const auto k = static_cast<std::uint64_t>(Wide{t} * num / (Wide{kPsPerSecond} * den));
      const auto edge = static_cast<Picoseconds>(Wide{k} * kPsPerSecond * den / num);
      ASSERT_EQ(clock.edge(k), 1'234 + edge) << f << " edge " << k;
      if (i % 4 == 0) t = edge + i / 4 % 3 - (edge > 0 ? 1 : 0);
      // The first edge at or after t: its time is, its predecessor's is not.
      const std::uint64_t n = clock.edge_at_or_after(1'234 + t);
      ASSERT_GE(clock.edge(n), 1'234 + t) << f << " time " << t;
      if (n > 0) {
        ASSERT_LT(clock.edge(n - 1), 1'234 + t) << f << " time " << t;
      }
      ASSERT_GT(clock.edge(clock.edge_after(1'234 + t)), 1'234 + t);
    }
  }
}

TEST(ClockArithmeticTest, AStoppedClockStaysAtItsLastEdge) {
  Clock clock(Frequency(100'000'000), 0);
  clock.restart(Frequency{}, 1'000'000);
  EXPECT_EQ(clock.edge_at_or_after(5'000'000), 100u);
  EXPECT_EQ(clock.edge(100), 1'000'000u);
}

}  // namespace
}  // namespace fovea::dram
