// Clocks that change, stop and go under traffic: every request has its outcome, in order, and every
// picosecond of its time one culprit.
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

#include "tb/dram/path.h"

namespace fovea::dram {
namespace {

constexpr Master kA = Master::kVpfe, kB = Master::kVpbe, kC = Master::kRemapEngine;
using Tables = std::array<WaitTable, 2>;

std::uint64_t sum(const Tables& tables, std::size_t m, Waits MasterWaits::*direction) {
  std::uint64_t t = 0;
  for (const WaitTable& table : tables)
    for (const std::uint64_t ps : (table[m].*direction).ps) t += ps;
  return t;
}

/// No master's time became less: an unsigned sum would have wrapped.
void expect_grown(const WaitTable& was, const WaitTable& is) {
  for (std::size_t m = 0; m < kMasterCount; ++m)
    for (std::size_t c = 0; c < kCulprits; ++c) {
      ASSERT_LE(was[m].read.ps[c], is[m].read.ps[c]) << m << " read " << c;
      ASSERT_LE(was[m].write.ps[c], is[m].write.ps[c]) << m << " write " << c;
    }
}

TEST(ClockChangeTest, WaitsAddUpAcrossChanges) {
  const Frequency ddr[] = {Frequency(243'000'000), Frequency(12'000'000), Frequency(160'000'000)};
  const Frequency scr[] = {Frequency(121'500'000), Frequency(6'000'000), Frequency()};
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto below = [&](unsigned n) { return static_cast<unsigned>(random()) % n; };
    Path path(ddr[0], scr[0]);
    std::array<std::uint8_t, 64> data{};
    std::vector<std::unique_ptr<PathRequest>> all;
    Tables was{};
    const auto run = [&](Picoseconds at) {
      while (path.next_decision() < at) {
        path.step();
        const Tables is{path.xbar.waits, path.ddr.waits()};
        for (std::size_t i = 0; i < is.size(); ++i) {
          expect_grown(was[i], is[i]);
          if (testing::Test::HasFatalFailure()) return;
        }
        was = is;
      }
    };
    std::array<unsigned, kMasterCount> under_way{};
    std::array<Picoseconds, kMasterCount> newest{};
    Picoseconds now = 0;
    for (unsigned i = 0; i < 120; ++i) {
      now += below(3) ? below(60'000) : below(900'000);
      run(now + 1);
      if (testing::Test::HasFatalFailure()) return;
      if (below(12) == 0) {
        const Frequency s = scr[below(3)];
        const Frequency d = ddr[below(3)];
        path.xbar.set_clock(s, now);
        path.ddr.set_clocks(d, s, now);
        continue;
      }
      const Master m = std::array{kA, kB, kC}[below(3)];
      under_way.fill(0);
      for (const auto& r : all) under_way[index(r->master)] += r->responses == 0;
      if (under_way[index(m)] >= 32) continue;
      all.push_back(std::make_unique<PathRequest>());
      PathRequest& r = *all.back();
      r.master = m;
      r.write = below(2) != 0;
      r.bytes = static_cast<std::uint8_t>(8u << below(4));
      r.address = below(64) * 64;
      r.data = data.data();
      newest[index(m)] = std::max(now + below(2) * below(400'000), newest[index(m)]);
      path.submit(r, newest[index(m)]);
    }
    now += 100'000'000;
    run(now);
    path.xbar.set_clock(scr[0], now);
    path.ddr.set_clocks(ddr[0], scr[0], now);
    run(now + 1'000'000'000);
    if (testing::Test::HasFatalFailure()) return;
    for (std::size_t m = 0; m < kMasterCount; ++m) {
      std::uint64_t reads = 0, writes = 0;
      Picoseconds last[2] = {0, 0};
      for (const auto& r : all) {
        if (index(r->master) != m) continue;
        ASSERT_EQ(r->responses, 1u);
        ASSERT_GT(r->first, r->issued);
        ASSERT_GE(r->last, r->first);
        EXPECT_GE(r->last, last[r->write]) << "in order within a direction";
        last[r->write] = r->last;
        (r->write ? writes : reads) += r->first - r->issued;
      }
      EXPECT_EQ(sum(was, m, &MasterWaits::read), reads) << m;
      EXPECT_EQ(sum(was, m, &MasterWaits::write), writes) << m;
    }
  }
}

// A video port may be a line ahead when the clock stops.
TEST(ClockChangeTest, RequestToComeWhileTheClockStandsIsSeenAtItsRestart) {
  Path path;  // 8 ns
  std::array<std::uint8_t, 64> data{};
  PathRequest r, later;
  for (PathRequest* q : {&r, &later}) {
    q->master = q == &r ? kB : kC;
    q->write = true;
    q->bytes = 8;
    q->data = data.data();
  }
  path.submit(r, 50'000'000);
  path.xbar.set_clock(Frequency(), 1'000'000);
  path.submit(later, 60'000'000);
  EXPECT_EQ(path.next_decision(), kNever);
  path.xbar.set_clock(Frequency(125'000'000), 100'000'000);
  path.drain();
  // Seen at the edge after the restart, through the bridge in 2, one beat, 2 back.
  EXPECT_EQ(std::min(r.first, later.first), 100'000'000u + (1 + 2 + 1 + 2) * 8'000);
  EXPECT_EQ(std::max(r.first, later.first), 100'000'000u + (1 + 2 + 2 + 2) * 8'000);
}

}  // namespace
}  // namespace fovea::dram
