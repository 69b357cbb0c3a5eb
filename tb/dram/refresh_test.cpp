// When refresh comes between requests: the cycle of PREA and REF, and the levels of urgency, as TI's
// manuals of the same controller have them (SPRU986B 2.4.2 and 2.9).
#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "tb/dram/bench.h"
#include "tb/dram/path.h"

namespace fovea::dram {
namespace {

using mem::Cmd;

struct Board {
  Frequency ddr, scr;
  mem::DdrConfig config;
};

/// As boot loaders program the SDRAM at 243 MHz, and a -25E part's data sheet at 340 MHz.
std::vector<Board> boards() {
  Board fast{Frequency(340'000'000), Frequency(170'000'000), {}};
  auto& t = fast.config.timing;
  t.nRCD = t.nRP = 5;
  t.nRAS = 16, t.nRC = 21, t.nRRD = 4, t.nWR = 6, t.nWTR = 3, t.nRTP = 3, t.nRFC = 44;
  fast.config.refresh_interval = 2652;
  return {{Frequency(243'000'000), Frequency(121'500'000), {}}, fast};
}

struct Counts {
  std::uint64_t activates, refreshes, due;
};
constexpr unsigned kReads = 20'000, kBytes = 64;
constexpr std::uint64_t kRows = kReads * kBytes / 2048;

/// One master reads 64 bytes after the other, one each `period`, whatever became of those before.
Counts periodic_reads(const Board& board, Picoseconds period, bool crossbar) {
  std::uint64_t activates = 0, refreshes = 0, clocks = 0;
  if (crossbar) {
    Path path(board.ddr, board.scr);
    path.ddr.configure(board.config, 0);
    std::deque<PathRequest> all(kReads);
    std::array<std::uint8_t, kBytes> data{};
    Picoseconds last = 0;
    for (unsigned i = 0; i < kReads; ++i) {
      Picoseconds at = (i + 1) * period;
      // No more than eight under way, where the bus needs longer than the period.
      while (i >= 8 && all[i - 8].responses == 0) last = path.next_decision(), path.step();
      at = std::max(at, last + 1);
      path.run_before(at);
      all[i].address = i * kBytes;
      all[i].bytes = kBytes;
      all[i].data = data.data();
      path.submit(all[i], at);
    }
    path.drain();
    activates = path.ddr.stats.activates.count(), refreshes = path.ddr.stats.refreshes.count();
    clocks = path.ddr.ddr_clock().edge_after(std::max(kReads * period, last));
  } else {
    BenchOptions o;
    o.ddr = board.ddr, o.scr = board.scr, o.config = board.config;
    o.params = {{"request_latency", "0 cycles"}, {"return_latency", "0 cycles"}};
    DdrBench b(o);
    b.keep_log = false;
    std::deque<Request> all(kReads);
    for (unsigned i = 0; i < kReads; ++i) {
      all[i].address = i * kBytes;
      all[i].bytes = kBytes;
      while (b.input_taken()) b.step();
      b.submit_at(all[i], std::max<Picoseconds>((i + 1) * period, b.now()));
    }
    b.drain();
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
    activates = b.ddr.stats.activates.count(), refreshes = b.ddr.stats.refreshes.count();
    clocks = b.ddr.ddr_clock().edge_after(b.now());
  }
  return {activates, refreshes, (clocks - 1) / board.config.refresh_interval};
}

// A row is opened once for its bytes, and once more for each refresh that closed it. A refresh whose
// PREA is given and whose REF is not would cost a row each time and stay owed.
TEST(RefreshCycleTest, PeriodicReaderPaysForNoRowTwice) {
  for (const Board& board : boards())
    for (const bool crossbar : {true, false})
      for (Picoseconds period = 60'000; period <= 200'000; period += 5'000) {
        const Counts c = periodic_reads(board, period, crossbar);
        const std::string where = std::to_string(board.ddr.num) + " Hz, " +
                                  std::to_string(period) + " ps, " +
                                  (crossbar ? "through the crossbar" : "memory only");
        EXPECT_LE(c.activates, kRows + c.refreshes) << where;
        EXPECT_GE(c.activates, kRows) << where;
        EXPECT_LE(c.refreshes, c.due) << where;
        EXPECT_LE(c.due, c.refreshes + 12) << where << ": at most refresh.must + 1 are owed";
        // There is time for a PREA after each read: none waits for longer than an interval.
        if (period >= 100'000) {
          EXPECT_LE(c.due, c.refreshes + 1) << where;
        }
      }
}

/// The read at clock 9 opens a row; the interval ends at 101, in idle time.
std::vector<Logged> refreshed_at_101(std::uint64_t second_read) {
  BenchOptions o;
  o.config.refresh_interval = 100;
  DdrBench b(o);
  Request first, second;
  second.address = 16;
  b.submit(first, 9);
  b.drain();
  b.log.clear();
  b.submit(second, second_read - 1);  // the controller sees it a clock later
  b.drain();
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  return b.log;
}

// tRP = 5, and 8 banks take a clock more: PREA at 101, REF at 107, ACT tRFC = 31 later.
TEST(RefreshCycleTest, RequestThatComesAfterThePreaWaitsForTheRef) {
  const std::vector<Logged> cycle = {
      {Cmd::kPreAll, 0, 0, 101}, {Cmd::kRef, 0, 0, 107}, {Cmd::kAct, 0, 0, 138},
      {Cmd::kRd, 0, 0, 143}};
  for (const std::uint64_t arrival : {102u, 103u, 106u, 107u, 108u})
    EXPECT_TRUE(refreshed_at_101(arrival) == cycle) << arrival;
  EXPECT_EQ(refreshed_at_101(138).at(2).clock, 138u + 8u) << "its own time in the pipeline";
  // At the clock of the PREA it comes first: its row stays open.
  const auto before = refreshed_at_101(101);
  EXPECT_EQ(before.at(0).cmd, Cmd::kRd);
  EXPECT_EQ(before.at(0).clock, 101u + 8u);
}

// Software switches refresh off between the two: what the PREA began is finished, and no more.
TEST(RefreshCycleTest, CycleIsFinishedWhenRefreshIsSwitchedOff) {
  BenchOptions o;
  o.config.refresh_interval = 100;
  DdrBench b(o);
  Request first, second;
  b.submit(first, 9);
  b.drain();
  b.ddr.catch_up(101 * kTck);
  ASSERT_EQ(b.log.back().cmd, Cmd::kPreAll);
  mem::DdrConfig off = o.config;
  off.refresh_interval = 0;
  b.ddr.configure(off, 102 * kTck);
  b.ddr.catch_up(500 * kTck);
  EXPECT_EQ(b.count(Cmd::kRef), 1u);
  EXPECT_EQ(b.clock_of(Cmd::kRef), 107u);
  b.submit(second, 600);
  b.drain();
  EXPECT_EQ(b.count(Cmd::kRef), 1u);
}

/// How many REF follow each other, in the order of the series, while reads never end.
std::vector<unsigned> series(const char* release, const char* must, const char* gap) {
  BenchOptions o;
  o.config.refresh_interval = 600;
  o.params = {{"refresh.release", release},
              {"refresh.need", "32"},
              {"refresh.must", must},
              {"refresh.gap", gap}};
  DdrBench b(o);
  std::deque<Request> all(1500);
  for (unsigned i = 0; i < all.size(); ++i) {
    all[i].address = i % 32 * 64;
    all[i].bytes = 64;
    while (b.input_taken()) b.step();
    b.submit_at(all[i], std::max<Picoseconds>(b.now(), kTck));
  }
  std::vector<unsigned> lengths;
  bool in_series = false;
  for (const Logged& l : b.log) {
    if (l.cmd == Cmd::kRef) {
      if (!in_series) lengths.push_back(0);
      ++lengths.back();
    }
    in_series = l.cmd == Cmd::kRef;
  }
  return lengths;
}

// Above `must` refreshes follow each other until the backlog is no longer above `release`. 1500 reads
// of 16 clocks are 40 intervals of 600.
TEST(RefreshLevelTest, AfterMustRequestsWaitForTheReleaseLevel) {
  const auto all_are = [](const std::vector<unsigned>& lengths, unsigned n) {
    EXPECT_GT(lengths.size(), 4u);
    for (const unsigned l : lengths) EXPECT_EQ(l, n);
  };
  all_are(series("3", "4", "64"), 2);   // 5 owed, then 3
  all_are(series("2", "4", "64"), 3);
  all_are(series("0", "4", "64"), 5);
  all_are(series("4", "4", "64"), 1);   // no longer above `must`
  all_are(series("64", "4", "64"), 1);
  all_are(series("5", "7", "64"), 3);
  // By default the ninth interval without a REF brings four, 12 owed bring 9: 8 - 4 = 4, 4 + 8 - 9 = 3,
  // 3 + 8 - 4 = 7, 7 + 5 - 9 = 3, ...
  const auto by_default = series("3", "11", "7");
  ASSERT_GE(by_default.size(), 4u);
  EXPECT_EQ(by_default[0], 4u);
  EXPECT_EQ(by_default[1], 9u);
  EXPECT_EQ(by_default[2], 4u);
  EXPECT_EQ(by_default[3], 9u);
}

// The last column of the third of eight writes is at 358. An interval that ends at the next clock, 359,
// is counted there: one refresh owed is above 0 and not above 1.
TEST(RefreshLevelTest, NeedCountsTheIntervalThatEndsAtTheDecision) {
  const auto columns_before_refresh = [](unsigned interval, const char* need) {
    BenchOptions o;
    o.config.refresh_interval = interval;
    o.params = {{"command_fifo", "16"}, {"write_fifo", "512B"}, {"refresh.need", need},
                {"refresh.must", "64"}, {"refresh.gap", "64"}};
    DdrBench b(o);
    std::vector<Request> all(8);
    for (unsigned i = 0; i < all.size(); ++i) {
      all[i].write = true;
      all[i].bytes = 64;
      all[i].address = i * 64;
      EXPECT_TRUE(b.submit(all[i], 300));
    }
    b.drain();
    unsigned n = 0;
    for (const Logged& l : b.log) {
      if (l.cmd == Cmd::kRef) break;
      n += l.cmd == Cmd::kWr;
    }
    return n;
  };
  EXPECT_EQ(columns_before_refresh(358, "0"), 12u);
  EXPECT_EQ(columns_before_refresh(358, "1"), 32u);
  EXPECT_EQ(columns_before_refresh(359, "0"), 16u) << "a clock later: after the next request";
  EXPECT_EQ(columns_before_refresh(359, "1"), 32u);
}

/// Reads without end on a part whose sheet wants one refresh in 1950 clocks, until nothing changes any more.
struct Postponed {
  std::uint64_t warned, most, on_the_bus, worst;
};
Postponed postponed(const char* must) {
  BenchOptions o;
  o.config.refresh_interval = 1950;  // 7.8 us at 250 MHz
  o.params = {{"refresh.release", "3"}, {"refresh.need", must}, {"refresh.must", must},
              {"refresh.gap", "64"}};
  DdrBench b(o);
  std::deque<Request> all(5'000);
  for (unsigned i = 0; i < all.size(); ++i) {
    all[i].address = i % 32 * 64;
    all[i].bytes = 64;
    while (b.input_taken()) b.step();
    b.submit_at(all[i], std::max<Picoseconds>(b.now(), kTck));
  }
  PartChecker sheet(find_part("mt47h64m16", "25e"), kDdr, o.config.timing.CL);
  for (const Logged& l : b.log) sheet.command(translate(l.cmd), l.bank, l.row, l.clock);
  Postponed p{0, std::get<std::uint64_t>(b.ddr.stats.refresh_backlog.value()), 0, 0};
  for (const auto& [what, n] : b.diagnostics.counts())
    if (what.second.find("JESD79-2 allows") != std::string::npos) p.warned += n;
  const auto found = sheet.warnings().find("postponed REF");
  if (found != sheet.warnings().end())
    p.on_the_bus = found->second.count, p.worst = found->second.worst_clocks;
  return p;
}

// 5000 reads of 16 clocks are 41 intervals: from 0 to must + 1 owed, then again and again from 3.
TEST(PostponedRefreshTest, MoreThanEightAreAWarningWithTheirNumber) {
  const Postponed eight = postponed("7"), nine = postponed("8"), twelve = postponed("11");
  EXPECT_EQ(eight.most, 8u);
  EXPECT_EQ(eight.warned, 0u);
  EXPECT_EQ(eight.on_the_bus, 0u);
  EXPECT_EQ(nine.most, 9u);
  EXPECT_GE(nine.warned, 5u) << "in each round one";
  EXPECT_EQ(nine.on_the_bus, nine.warned) << "the REF that comes then is one too late";
  EXPECT_EQ(nine.worst, 1u);
  EXPECT_EQ(twelve.most, 12u);
  EXPECT_GE(twelve.warned, 4u * 4u) << "at the end of the 9th, 10th, 11th and 12th interval";
  EXPECT_EQ(twelve.worst, 4u);
}

}  // namespace
}  // namespace fovea::dram
