// What seldom happens to rows: T_RASMAX closes them, partial-array self-refresh loses them, the
// memory's clock stands. And how long the part was in which state.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "model/common/check.h"
#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

using mem::Cmd;
using mem::LowPower;
constexpr Master kA = Master::kVpfe, kB = Master::kVpbe;

Request read(Master m, std::uint32_t address, unsigned bytes = 16) {
  Request r;
  r.master = m;
  r.address = address;
  r.bytes = bytes;
  return r;
}

/// One read opens a row of bank 3 at clock kOpened; then reads of another bank keep the controller
/// busy, and refresh is postponed for longer than the test.
struct Busy {
  static constexpr std::uint64_t kOpened = 18;  // seen at 10, scheduled from 10 + 8
  DdrBench bench;
  std::vector<std::unique_ptr<Request>> all;

  explicit Busy(unsigned row_intervals, unsigned interval = 300, bool hits = false)
      : bench(options(row_intervals, interval)) {
    all.push_back(std::make_unique<Request>(read(kA, at(1, 3))));
    bench.submit(*all.back(), 9);
    for (unsigned i = 0; i < 1500; ++i) {
      all.push_back(std::make_unique<Request>(read(kB, at(1, hits ? 3 : 0, i % 128 * 16))));
      while (bench.input_taken()) bench.step();
      bench.submit_at(*all.back(), std::max<Picoseconds>(bench.now(), 20 * kTck));
    }
    bench.drain();
  }
  static BenchOptions options(unsigned row_intervals, unsigned interval) {
    BenchOptions o;
    o.config.refresh_interval = interval;
    o.config.row_intervals = row_intervals;
    o.params = {{"refresh.need", "32"}, {"refresh.must", "64"}, {"refresh.gap", "64"}};
    return o;
  }
};

// Exactly n intervals after the ACT: the reads' columns are four clocks apart, and the PRE comes
// between them.
TEST(RowTimeTest, RowIsClosedAfterItsIntervals) {
  for (const unsigned n : {1u, 2u, 5u}) {
    for (unsigned interval = 300; interval < 312; ++interval) {
      const Busy b(n, interval);
      EXPECT_EQ(b.bench.clock_of(Cmd::kPre, 3), Busy::kOpened + std::uint64_t{n} * interval)
          << n << " x " << interval;
      EXPECT_EQ(b.bench.checker.total(), 0u) << b.bench.checker.text();
      EXPECT_EQ(b.bench.count(Cmd::kPre), b.bench.ddr.stats.overdue_rows.count());
    }
  }
  EXPECT_EQ(Busy(31).bench.count(Cmd::kPre), 0u) << "the reads end before that";
}

TEST(RowTimeTest, RowInUseIsClosedTooAndOpenedAgain) {
  const Busy b(2, 300, true);
  EXPECT_GT(b.bench.ddr.stats.overdue_rows.count(), 5u);
  for (unsigned i = 0; i + 1 < b.bench.ddr.stats.overdue_rows.count(); ++i) {
    const std::uint64_t pre = b.bench.clock_of(Cmd::kPre, 3, i);
    EXPECT_EQ(b.bench.clock_of(Cmd::kAct, 3, i + 1), pre + 5) << "tRP";
    EXPECT_LE(b.bench.clock_of(Cmd::kPre, 3, i + 1) - pre, 600u + 5 + 8);
  }
  for (const auto& r : b.all) EXPECT_EQ(r->done, 1u);
  EXPECT_EQ(b.bench.checker.total(), 0u) << b.bench.checker.text();
}

TEST(RowTimeTest, WithoutRefreshNothingCountsIntervals) {
  const Busy b(1, 0);
  EXPECT_EQ(b.bench.count(Cmd::kPre), 0u);
}

// Requests that come all the time, each to another row of two banks: the family's thresholds let
// refresh wait for eight intervals, a T_RASMAX of three does not let a row wait for it.
TEST(RowTimeTest, NoRowIsOpenForLongerThanProgrammed) {
  for (const unsigned n : {1u, 3u, 6u}) {
    BenchOptions o;
    o.config.refresh_interval = 400;
    o.config.row_intervals = n;
    DdrBench b(o);
    Rng rng(n);
    std::vector<std::unique_ptr<Request>> all;
    for (unsigned i = 0; i < 4000; ++i) {
      all.push_back(std::make_unique<Request>(
          read(rng.below(2) ? kA : kB, at(0, static_cast<unsigned>(rng.below(8)), 64), 64)));
      while (b.input_taken()) b.step();
      b.submit_at(*all.back(), std::max<Picoseconds>(b.now(), kTck));
    }
    b.drain();
    std::array<std::uint64_t, 8> opened{};
    std::uint64_t longest = 0;
    std::uint32_t open = 0;
    for (const Logged& l : b.log) {
      if (l.cmd == Cmd::kAct) opened[l.bank] = l.clock, open |= 1u << l.bank;
      if (l.cmd != Cmd::kPre && l.cmd != Cmd::kPreAll) continue;
      for (unsigned k = 0; k < 8; ++k) {
        if (!(open >> k & 1u) || (l.cmd == Cmd::kPre && l.bank != k)) continue;
        longest = std::max(longest, l.clock - opened[k]);
        open &= ~(1u << k);
      }
    }
    // A burst under way is finished; eight rows due at once take a command each.
    EXPECT_LE(longest, n * 400u + 16 + 8) << n;
    EXPECT_GT(longest, n * 400u - 400) << n;
    EXPECT_GT(b.ddr.stats.overdue_rows.count(), 0u) << n;
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  }
}

// A controller without an observer of its commands passes over the refreshes of a long idle time: what follows, and
// all that is counted, is the same.
TEST(IdleTimeTest, LongTimesOfRefreshesEndTheSame) {
  const auto run = [](bool listened, std::uint64_t seed) {
    Rng rng(seed);
    BenchOptions o;
    o.config.refresh_interval = 200 + static_cast<unsigned>(rng.below(3000));
    DdrBench b(o);
    if (!listened) b.listening.reset();
    std::vector<std::uint64_t> seen;
    std::vector<std::unique_ptr<Request>> all;
    Picoseconds now = kTck;
    for (unsigned i = 0; i < 8; ++i) {
      now += rng.below(2) ? rng.below(kPsPerMs * 10) : rng.below(kPsPerUs);
      if (rng.below(3) == 0) b.ddr.catch_up(now);
      now += rng.below(kPsPerUs * 3);
      for (unsigned k = 0; k < 3; ++k) {
        all.push_back(std::make_unique<Request>(
            read(k & 1 ? kA : kB, at(static_cast<std::uint32_t>(rng.below(3)), 1), 64)));
        while (b.input_taken()) b.step();
        b.submit_at(*all.back(), now = std::max(now, b.now()));
      }
      b.drain();
      now = std::max(now, b.now());
      const auto& s = b.ddr.stats;
      seen.insert(seen.end(), {s.refreshes.count(), s.row_misses.count(), s.row_conflicts.count(),
                               s.row_open_clocks.count(), s.queued_clocks.count()});
      for (const MasterWaits& w : b.ddr.waits())
        seen.insert(seen.end(), w.read.ps.begin(), w.read.ps.end());
    }
    for (const auto& r : all) seen.insert(seen.end(), {r->first, r->last});
    return seen;
  };
  for (std::uint64_t seed = 1; seed <= 40; ++seed)
    ASSERT_EQ(run(true, seed), run(false, seed)) << "seed " << seed;
  // A whole hour takes no time.
  DdrBench b;
  b.listening.reset();
  b.ddr.catch_up(3600 * kPsPerSecond);
  EXPECT_EQ(b.ddr.stats.refreshes.count(), (3600 * 250'000'000ull - 1) / 1895);
}

BenchOptions sleeping(LowPower mode) {
  BenchOptions o;
  o.config.low_power = mode;
  o.params = {{"request_latency", "0 cycles"}};
  return o;
}

// Seen at 101: the clock starts, n clocks later CKE rises, tXSNR later comes the ACT.
TEST(ClockStopTest, RestartPutsOffTheExitFromSelfRefresh) {
  for (const unsigned n : {0u, 1u, 2u, 9u}) {
    BenchOptions o = sleeping(LowPower::kClockStop);
    o.params.emplace_back("clock_restart", std::to_string(n) + " cycles");
    DdrBench b(o);
    Request r = read(kA, at(1, 0));
    b.submit(r, 100);
    b.drain();
    EXPECT_EQ(b.clock_of(Cmd::kSrx), 101u + n);
    EXPECT_EQ(b.clock_of(Cmd::kAct), 101u + n + 34);
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  }
}

TEST(ClockStopTest, SetAndClearedInSelfRefreshWithoutWaking) {
  BenchOptions o = sleeping(LowPower::kSelfRefresh);
  o.params.emplace_back("clock_restart", "7 cycles");
  DdrBench b(o);
  const auto set = [&](LowPower mode, std::uint64_t clock) {
    o.config.low_power = mode;
    b.ddr.configure(o.config, clock * kTck);
    b.ddr.catch_up(clock * kTck);
    EXPECT_EQ(b.ddr.asleep(), mode);
  };
  b.ddr.catch_up(50 * kTck);
  set(LowPower::kClockStop, 100);
  set(LowPower::kSelfRefresh, 300);
  set(LowPower::kClockStop, 400);
  set(LowPower::kSelfRefresh, 500);
  EXPECT_EQ(b.count(Cmd::kSre), 1u);
  EXPECT_EQ(b.count(Cmd::kSrx), 0u);
  EXPECT_EQ(b.ddr.stats.clock_stop_clocks.count(), 200u + 100u);
  Request r = read(kA, at(1, 0));
  b.submit(r, 502);  // seen at 503; the clock runs steadily from 501 + 7
  b.drain();
  EXPECT_EQ(b.clock_of(Cmd::kSrx), 508u);
  set(LowPower::kOff, 4000);
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
}

// A lone read of one burst: ACT at 10, RD at 15. The row is open until the first refresh.
TEST(ResidencyTest, ClocksWithARowOpenAddUp) {
  BenchOptions o;
  o.config.refresh_interval = 1000;
  o.params = {{"request_latency", "0 cycles"}};
  DdrBench b(o);
  Request one = read(kA, at(1, 0)), two = read(kB, at(1, 1));
  b.submit(one, 9);
  b.drain();
  b.ddr.catch_up(99 * kTck);
  EXPECT_EQ(b.ddr.stats.row_open_clocks.count(), 100u - 10);
  b.submit(two, 200);
  b.drain();
  b.ddr.catch_up(3000 * kTck);
  EXPECT_EQ(b.clock_of(Cmd::kPreAll), 1001u);
  EXPECT_EQ(b.ddr.stats.row_open_clocks.count(), 1001u - 10) << "two rows at a time count once";
  b.ddr.stats.reset();
  b.ddr.catch_up(4000 * kTck);
  EXPECT_EQ(b.ddr.stats.row_open_clocks.count(), 0u);
}

// RDA at 15 closes its row at tRAS = 10 + 11; an ACT of another bank at 13 is inside.
TEST(ResidencyTest, RowsThatCloseThemselvesCountOnce) {
  BenchOptions o;
  o.params = {{"request_latency", "0 cycles"}, {"scheduler", "closed_page"}};
  DdrBench b(o);
  Request one = read(kA, at(1, 0)), two = read(kB, at(1, 1));
  b.submit(one, 9);
  b.submit(two, 9);
  b.drain();
  EXPECT_EQ(b.clock_of(Cmd::kAct, 1), 13u);
  EXPECT_EQ(b.clock_of(Cmd::kRda, 1), 19u);
  b.ddr.catch_up(500 * kTck);
  EXPECT_EQ(b.ddr.stats.row_open_clocks.count(), 24u - 10) << "bank 1 closes at 13 + 11";
}

TEST(ResidencyTest, SleepIsTakenApart) {
  const auto clocks = [](LowPower mode) {
    BenchOptions o = sleeping(mode);
    DdrBench b(o);
    Request r = read(kA, at(1, 0));
    b.submit(r, 9);
    b.drain();
    b.ddr.catch_up(999 * kTck);
    const auto& s = b.ddr.stats;
    return std::array{s.power_down_clocks.count(), s.active_power_down_clocks.count(),
                      s.self_refresh_clocks.count(), s.clock_stop_clocks.count()};
  };
  // Asleep from 1 on, awake at 10; ACT at 13, RD at 18, over at 18 + CL + 4 + 1.
  EXPECT_EQ(clocks(LowPower::kPowerDown),
            (std::array<std::uint64_t, 4>{9 + 1000 - 28, 1000 - 28, 0, 0}));
  const auto self = clocks(LowPower::kSelfRefresh), stop = clocks(LowPower::kClockStop);
  // SRX at 10, RD at 10 + tXSRD, PREA 4 and SRE another 6 clocks later; with the clock's restart all
  // of it comes a clock later.
  EXPECT_EQ(self[2], 9u + (1000 - 220));
  EXPECT_EQ(stop[2], 10u + (1000 - 221));
  EXPECT_EQ(self[3], 0u);
  EXPECT_EQ(stop[3], stop[2]);
  EXPECT_EQ(self[0] + self[1] + stop[0] + stop[1], 0u);
}

std::uint64_t warnings(const DdrBench& bench) {
  std::uint64_t n = 0;
  for (const auto& [what, count] : bench.diagnostics.counts())
    if (what.second.find("PASR") != std::string::npos) n += count;
  return n;
}

/// A mobile part of 64 MiB, 4 banks of 8192 rows of 2 KiB, wakes after `slept` of self-refresh.
struct Partial {
  DdrBench bench;
  static BenchOptions options(unsigned kept_log2, bool bank_on_top) {
    BenchOptions o = sleeping(LowPower::kSelfRefresh);
    o.params.insert(o.params.end(), {{"part", "mt46h32m16lf"}, {"retention", "20us"}});
    o.config.timing.banks = 4;
    o.config.timing.mobile = true;
    o.config.refreshed_log2 = kept_log2;
    o.config.bank_on_top = bank_on_top;
    return o;
  }
  Partial(unsigned kept_log2, bool bank_on_top, Picoseconds slept) : bench(options(kept_log2, bank_on_top)) {
    std::fill_n(bench.store().at(0), bench.store().size(), std::uint8_t{1});
    Request r = read(kA, 0);
    bench.submit_at(r, slept + kTck - 1);  // asleep at clock 1, awake one clock after this
    bench.drain();
  }
  std::uint8_t byte(std::uint32_t row, unsigned bank, bool bank_on_top, std::uint32_t column = 0) {
    return *bench.store().at(bank_on_top ? (bank * 8192u + row) * 2048u + column
                                         : at(row, bank, column, 4));
  }
};

TEST(PartialArrayTest, LosesWhatIsNotRefreshedAfterTheRetentionTime) {
  for (const Picoseconds slept : {20 * kPsPerUs, 20 * kPsPerUs + kTck}) {
    const bool lost = slept > 20 * kPsPerUs;
    Partial p(1, false, slept);
    EXPECT_EQ(warnings(p.bench), lost ? 1u : 0u);
    EXPECT_EQ(p.byte(0, 3, false), lost ? 0xA5 : 1);
    EXPECT_EQ(p.byte(0, 1, false), 1);
  }
}

TEST(PartialArrayTest, KeepsTheProgrammedPart) {
  struct {
    unsigned log2, banks, rows;  // banks kept whole; or rows of bank 0
  } const cases[] = {{0, 4, 8192}, {1, 2, 8192}, {2, 1, 8192}, {3, 1, 4096}, {4, 1, 2048}};
  for (const auto& c : cases)
    for (const bool top : {false, true}) {
      Partial p(c.log2, top, kPsPerMs);
      for (unsigned bank = 0; bank < 4; ++bank)
        for (const std::uint32_t row : {0u, 2047u, 2048u, 4095u, 4096u, 8191u})
          for (const std::uint32_t column : {0u, 2047u})
            EXPECT_EQ(p.byte(row, bank, top, column),
                      bank < c.banks && row < c.rows ? 1 : 0xA5)
                << "PASR 1/2^" << c.log2 << " bank " << bank << " row " << row << " top " << top;
      EXPECT_EQ(warnings(p.bench), c.log2 ? 1u : 0u);
    }
}

TEST(PartialArrayTest, PowerDownLosesNothing) {
  BenchOptions o = Partial::options(2, false);
  o.config.low_power = LowPower::kPowerDown;
  DdrBench b(o);
  std::fill_n(b.store().at(0), b.store().size(), std::uint8_t{1});
  Request r = read(kA, 0);
  b.submit_at(r, kPsPerMs);
  b.drain();
  EXPECT_EQ(*b.store().at(at(0, 3, 0, 4)), 1);
}

}  // namespace
}  // namespace fovea::dram
