// Clock edges against plain wide arithmetic: the clock's fixed-point factors must be exact.
#include "model/common/clock.h"

#include <gtest/gtest.h>

#include "model/common/edge_cursor.h"
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

// Walks as the memory path does: mostly small steps on, some back, now and then a leap past the
// reach; and a restart of the clock in between.
TEST(ClockArithmeticTest, CursorAgreesWithItsClock) {
  const Frequency clocks[] = {
      Frequency(243'000'000),       Frequency(121'500'000),      Frequency(340'000'000),
      Frequency(172'500'000),       Frequency(250'000'000),      Frequency(1),
      Frequency(345'000'000, 16),   Frequency(999'999'937),      Frequency(512'000'000'000),
      Frequency(1'000'000'000'000), Frequency(3'000'000'000'000)};
  Rng rng(2);
  for (const Frequency f : clocks) {
    Clock clock(f, 1'234);
    EdgeCursor cursor;
    cursor.follow(clock);
    Picoseconds t = 1'234;
    for (unsigned i = 0; i < 40'000; ++i) {
      if (i == 20'000) {
        clock.restart(Frequency(270'000'000), t + 17);
        cursor.follow(clock);
        t += 17;
      }
      const auto kind = rng.below(200);
      if (kind == 0)
        t += rng.below(kPsPerSecond);
      else if (kind < 20)
        t -= std::min<Picoseconds>(rng.below(40'000), t - clock.start());
      else
        t += rng.below(20'000);
      const std::uint64_t k = clock.edge_at_or_after(t);
      ASSERT_EQ(cursor.edge_at_or_after(t), k) << f << " time " << t;
      ASSERT_EQ(cursor.edge_after(t), clock.edge_after(t)) << f << " time " << t;
      ASSERT_EQ(cursor.edge(k), clock.edge(k)) << f << " edge " << k;
      const std::uint64_t on = k + rng.below(100);
      ASSERT_EQ(cursor.edge(on), clock.edge(on)) << f << " edge " << on;
      // On an edge and beside it, where rounding decides.
      const Picoseconds e = clock.edge(k);
      ASSERT_EQ(cursor.edge_at_or_after(e), clock.edge_at_or_after(e)) << f << " time " << e;
      ASSERT_EQ(cursor.edge_after(e), clock.edge_after(e)) << f << " time " << e;
      ASSERT_EQ(cursor.edge_at_or_after(e + 1), clock.edge_at_or_after(e + 1)) << f;
    }
  }
}

// The reach itself: just inside and just outside of what the base covers.
TEST(ClockArithmeticTest, CursorIsExactUpToItsReach) {
  for (const Frequency f :
       {Frequency(243'000'000), Frequency(340'000'000), Frequency(24'000'000)}) {
    const Clock clock(f);
    for (Picoseconds t = kPsPerMs; t < kPsPerSecond; t += t / 512 + 7) {
      EdgeCursor cursor;
      cursor.follow(clock);  // the base is edge 0 again
      ASSERT_EQ(cursor.edge_at_or_after(t), clock.edge_at_or_after(t)) << f << " time " << t;
      cursor.follow(clock);
      const std::uint64_t k = clock.edge_at_or_after(t) * 64;
      ASSERT_EQ(cursor.edge(k), clock.edge(k)) << f << " edge " << k;
    }
  }
}

}  // namespace
}  // namespace fovea::dram
