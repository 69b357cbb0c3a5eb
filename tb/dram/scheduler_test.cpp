// The scheduling rules of SPRUH82C 14.2.5 to 14.2.7, one smallest scenario each, always with its
// counterpart: the same requests where the rule does not apply come out the other way round.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

using mem::Cmd;
constexpr Master kA = Master::kRemapEngine, kB = Master::kLoad, kC = Master::kVpfe;

Request make(Master m, bool write, std::uint32_t address, unsigned priority = 3,
             unsigned bytes = 16) {
  Request r;
  r.master = m;
  r.write = write;
  r.address = address;
  r.priority = priority;
  r.bytes = bytes;
  return r;
}
Request read(Master m, std::uint32_t address, unsigned priority = 3, unsigned bytes = 16) {
  return make(m, false, address, priority, bytes);
}
Request write(Master m, std::uint32_t address, unsigned priority = 3, unsigned bytes = 16) {
  return make(m, true, address, priority, bytes);
}

BenchOptions options() {
  BenchOptions o;
  o.config.refresh_interval = 0;
  o.params = {{"command_fifo", "16"}, {"write_fifo", "512B"}};
  return o;
}

/// Hands all requests over at one clock, oldest first, and serves them.
class Scenario {
 public:
  explicit Scenario(std::vector<Request> requests, BenchOptions o = options(),
                    std::vector<Request> before = {})
      : requests_(std::move(requests)), before_(std::move(before)), bench(o) {
    for (Request& r : before_) EXPECT_TRUE(bench.submit(r, 9));
    if (!before_.empty()) bench.drain();
    bench.log.clear();
    for (Request& r : requests_) EXPECT_TRUE(bench.submit(r, 300));
    bench.drain();
    EXPECT_EQ(bench.checker.total(), 0u) << bench.checker.text();
  }

 private:
  std::vector<Request> requests_, before_;

 public:
  DdrBench bench;
  /// Column commands as text: R or W and the bank.
  std::string columns() const {
    std::string s;
    for (const Logged& l : bench.log) {
      const bool read = l.cmd == Cmd::kRd || l.cmd == Cmd::kRda;
      if (read || l.cmd == Cmd::kWr || l.cmd == Cmd::kWra)
        s += std::string(s.empty() ? "" : " ") + (read ? "R" : "W") + std::to_string(l.bank);
    }
    return s;
  }
};

TEST(SchedulerTest, OpenRowGoesBeforeOlderAndMoreUrgent) {
  const std::vector<Request> two = {read(kA, at(1, 1), 0), read(kB, at(1, 0), 7)};
  EXPECT_EQ(Scenario(two, options(), {read(kC, at(1, 0))}).columns(), "R0 R1");
  EXPECT_EQ(Scenario(two).columns(), "R1 R0") << "no row open";
  EXPECT_EQ(Scenario(two, options(), {read(kC, at(2, 0))}).columns(), "R1 R0") << "another row";
}

TEST(SchedulerTest, OpenRowGoesFirstAmongWritesToo) {
  const std::vector<Request> two = {write(kA, at(1, 1), 0), write(kB, at(1, 0), 7)};
  EXPECT_EQ(Scenario(two, options(), {read(kC, at(1, 0))}).columns(), "W0 W1");
  EXPECT_EQ(Scenario(two).columns(), "W1 W0");
}

TEST(SchedulerTest, PriorityDecidesBetweenEqualRows) {
  EXPECT_EQ(Scenario({read(kA, at(1, 0), 2), read(kB, at(1, 1), 1)}).columns(), "R1 R0");
  EXPECT_EQ(Scenario({read(kA, at(1, 0), 1), read(kB, at(1, 1), 2)}).columns(), "R0 R1");
  EXPECT_EQ(Scenario({write(kA, at(1, 0), 2), write(kB, at(1, 1), 1)}).columns(), "W1 W0");
}

TEST(SchedulerTest, AgeDecidesAtEqualPriority) {
  EXPECT_EQ(Scenario({read(kA, at(1, 0)), read(kB, at(1, 1)), read(kC, at(1, 2))}).columns(),
            "R0 R1 R2");
  EXPECT_EQ(Scenario({read(kC, at(1, 2)), read(kB, at(1, 1)), read(kA, at(1, 0))}).columns(),
            "R2 R1 R0");
}

TEST(SchedulerTest, ReadGoesBeforeWrite) {
  EXPECT_EQ(Scenario({write(kA, at(1, 0), 0), read(kB, at(1, 1), 7)}).columns(), "R1 W0");
}

TEST(SchedulerTest, ReadsOfOneMasterStayInOrder) {
  const std::vector<Request> opened = {read(kC, at(1, 0))};
  EXPECT_EQ(Scenario({read(kA, at(1, 1)), read(kA, at(1, 0))}, options(), opened).columns(),
            "R1 R0")
      << "although the younger one's row is open";
  EXPECT_EQ(Scenario({read(kA, at(1, 1)), read(kB, at(1, 0))}, options(), opened).columns(),
            "R0 R1");
}

TEST(SchedulerTest, WritesOfOneMasterStayInOrder) {
  const std::vector<Request> opened = {read(kC, at(1, 0))};
  EXPECT_EQ(Scenario({write(kA, at(1, 1)), write(kA, at(1, 0))}, options(), opened).columns(),
            "W1 W0");
}

TEST(SchedulerTest, WriteNeverPassesOlderReadOfItsMaster) {
  EXPECT_EQ(Scenario({read(kA, at(1, 1)), write(kA, at(1, 0), 0)}, options(), {read(kC, at(1, 0))})
                .columns(),
            "R1 W0");
}

TEST(SchedulerTest, ReadPassesOlderWriteOutsideTwoKiBOnly) {
  EXPECT_EQ(Scenario({write(kA, at(1, 0)), read(kA, at(1, 1))}).columns(), "R1 W0");
  EXPECT_EQ(Scenario({write(kA, at(1, 0, 0)), read(kA, at(1, 0, 1984))}).columns(), "W0 R0")
      << "first and last line of a 2048-byte block";
  EXPECT_EQ(Scenario({write(kA, at(1, 0, 1984)), read(kA, at(1, 0, 2048))}).columns(), "R1 W0")
      << "neighbours across the boundary";
}

// To one address too: the reader gets the old bytes although the writer has its acknowledgement. A listener to
// commands learns in which order the data moved.
TEST(SchedulerTest, AReadPassesAnotherMastersWriteToTheSameAddress) {
  DdrBench b(options());
  std::string moved;
  struct Listener {
    DdrBench& bench;
    std::string& text;
  } listener{b, moved};
  const Subscription listening = b.ddr.observe_commands(
      [](void* self, mem::Cmd c, unsigned, std::uint32_t, std::uint64_t) {
        auto& l = *static_cast<Listener*>(self);
        if (c != mem::Cmd::kRd && c != mem::Cmd::kWr) return;
        if (const auto* e = l.bench.ddr.beginning())
          l.text += std::string(e->request.write ? "W" : "R") + std::to_string(e->request.bytes) + " ";
      },
      &listener);
  std::fill_n(b.store().at(0x1000), 64, std::uint8_t{1});
  Request w = write(kA, 0x1000, 3, 64), r = read(kB, 0x1020, 3, 32), later = read(kB, 0x1020, 3, 32);
  w.data.fill(2);
  ASSERT_TRUE(b.submit(w, 10));
  ASSERT_TRUE(b.submit(r, 11));
  ASSERT_TRUE(w.accepted);
  b.drain();
  EXPECT_EQ(moved, "R32 W64 ");
  EXPECT_EQ(r.data[0], 1);
  ASSERT_TRUE(b.submit(later, 1000));
  b.drain();
  EXPECT_EQ(later.data[0], 2);
  EXPECT_EQ(moved, "R32 W64 R32 ");
}

TEST(SchedulerTest, ReadDoesNotPassOlderWriteOfHigherPriority) {
  EXPECT_EQ(Scenario({write(kA, at(1, 0), 2), read(kA, at(1, 1), 3)}).columns(), "W0 R1");
  EXPECT_EQ(Scenario({write(kA, at(1, 0), 3), read(kA, at(1, 1), 3)}).columns(), "R1 W0");
  EXPECT_EQ(Scenario({write(kA, at(1, 0), 3), read(kA, at(1, 1), 2)}).columns(), "R1 W0");
}

// A write waits behind a queue of reads. PR_OLD_COUNT = n: after n + 1 transfers it goes first.
TEST(SchedulerTest, OldCountPromotesTheOldestCommand) {
  const auto reads_before_write = [](unsigned old_count, unsigned bytes) {
    BenchOptions o = options();
    o.config.old_count = old_count;
    std::vector<Request> all = {write(kA, at(1, 0))};
    for (unsigned i = 0; i < 12; ++i) all.push_back(read(kB, at(1, 1, i * 64), 3, bytes));
    const std::string s = Scenario(all, o).columns();
    return static_cast<unsigned>(s.find('W') / 3);  // "R1 " is one command
  };
  EXPECT_EQ(reads_before_write(0xFF, 16), 12u) << "off";
  EXPECT_EQ(reads_before_write(0xFE, 16), 12u);
  EXPECT_EQ(reads_before_write(0, 16), 1u);
  EXPECT_EQ(reads_before_write(4, 16), 5u);
  EXPECT_EQ(reads_before_write(5, 16), 6u);
  EXPECT_EQ(reads_before_write(4, 64), 8u) << "64 bytes are four transfers, never cut short";
  EXPECT_EQ(reads_before_write(7, 64), 8u);
  EXPECT_EQ(reads_before_write(8, 64), 12u);
}

// The read FIFO is 17 words; a return channel of 8 clocks a word empties it slower than the DDR fills it.
TEST(SchedulerTest, WriteGoesFirstWhileTheReadFifoIsFull) {
  const auto reads_before_write = [](Frequency scr) {
    BenchOptions o = options();
    o.scr = scr;
    std::vector<Request> all = {write(kA, at(1, 0))};
    for (unsigned i = 0; i < 5; ++i) all.push_back(read(kB, at(1, 1, i * 64), 3, 64));
    return static_cast<unsigned>(Scenario(all, o).columns().find('W') / 3);
  };
  EXPECT_EQ(reads_before_write(Frequency(250'000'000)), 20u) << "as fast as the bus: never full";
  EXPECT_EQ(reads_before_write(Frequency(125'000'000)), 20u);
  // The first two reads' 16 words fit; the third must wait for the channel.
  EXPECT_EQ(reads_before_write(Frequency(31'250'000)), 8u);
}

// Latency on the way is not occupancy: a fast return channel never lets the FIFO fill.
TEST(SchedulerTest, ReturnLatencyDoesNotThrottleReads) {
  for (const char* latency : {"0 cycles", "16 cycles"}) {
    BenchOptions o = options();
    o.scr = Frequency(125'000'000);
    o.params.emplace_back("return_latency", latency);
    std::vector<Request> all;
    for (unsigned i = 0; i < 16; ++i) all.push_back(read(kB, at(1, 1, i * 64), 3, 64));
    Scenario s(all, o);
    EXPECT_EQ(s.bench.clock_of(Cmd::kRd, 1, 63) - s.bench.clock_of(Cmd::kRd, 1, 0), 63u * 4u);
  }
}

// Refresh against requests. Thresholds of 0 make one owed refresh urgent; 64 is out of reach here.
class RefreshTest : public testing::Test {
 protected:
  static BenchOptions with(const char* need, const char* must, const char* gap) {
    BenchOptions o = options();
    o.config.refresh_interval = 350;  // due once, while the requests of clock 300 are served
    o.params.insert(o.params.end(),
                    {{"refresh.need", need}, {"refresh.must", must}, {"refresh.gap", gap}});
    return o;
  }
  /// Commands RD/WR before the first REF; all if there is none.
  static unsigned columns_before_refresh(const Scenario& s) {
    unsigned n = 0;
    for (const Logged& l : s.bench.log) {
      if (l.cmd == Cmd::kRef) break;
      n += l.cmd == Cmd::kRd || l.cmd == Cmd::kWr;
    }
    return n;
  }
  static std::vector<Request> eight(bool write) {
    std::vector<Request> all;
    for (unsigned i = 0; i < 8; ++i) all.push_back(make(kA, write, at(1, 0, i * 64), 3, 64));
    return all;
  }
  // From clock 309 + tRCD a column every 4 clocks: 314, ... The interval ends at 351, in the third
  // request (column clocks 346, 350, 354, 358): that is finished, then comes the refresh.
  static constexpr unsigned kUntilDue = 12;
};

TEST_F(RefreshTest, NeededRefreshGoesBeforeWrites) {
  EXPECT_EQ(columns_before_refresh(Scenario(eight(true), with("0", "64", "64"))), kUntilDue);
  EXPECT_EQ(columns_before_refresh(Scenario(eight(true), with("1", "64", "64"))), 32u)
      << "one owed is not above 1";
}

TEST_F(RefreshTest, NeededRefreshWaitsForReads) {
  EXPECT_EQ(columns_before_refresh(Scenario(eight(false), with("0", "64", "64"))), 32u);
}

TEST_F(RefreshTest, NeededRefreshGoesBeforeReadsThatHaveAMoreUrgentWrite) {
  for (const unsigned priority : {2u, 3u}) {
    auto all = eight(false);
    all.push_back(write(kB, at(1, 1), priority));
    EXPECT_EQ(columns_before_refresh(Scenario(all, with("0", "64", "64"))),
              priority < 3 ? kUntilDue : 32u);
  }
}

TEST_F(RefreshTest, MustGoesBeforeReads) {
  EXPECT_EQ(columns_before_refresh(Scenario(eight(false), with("0", "0", "64"))), kUntilDue);
  EXPECT_EQ(columns_before_refresh(Scenario(eight(false), with("0", "1", "64"))), 32u);
}

TEST_F(RefreshTest, FourRefreshesInARowAfterTooManyIntervalsWithout) {
  const auto refreshes = [](const char* gap) {
    BenchOptions o = with("32", "64", gap);
    o.config.refresh_interval = 100;  // due at 301, 401, 501, ...; served from 314 to 566
    std::vector<Request> all;
    for (unsigned i = 0; i < 16; ++i) all.push_back(read(kA, at(1, 0, i * 64), 3, 64));
    Scenario s(all, o);
    unsigned run = 0, longest = 0;
    for (const Logged& l : s.bench.log) {
      if (l.clock < 309) continue;
      run = l.cmd == Cmd::kRef ? run + 1 : 0;
      longest = std::max(longest, run);
    }
    return longest;
  };
  EXPECT_EQ(refreshes("2"), 4u);
  EXPECT_EQ(refreshes("64"), 0u);
}

// The last two ranks of rule 5: a refresh at "may" waits for the writes, self-refresh for the refresh.
TEST_F(RefreshTest, SelfRefreshEntryComesAfterRefreshAndRefreshAfterWrites) {
  BenchOptions o = with("32", "64", "64");
  o.config.low_power = mem::LowPower::kSelfRefresh;
  o.config.timing.nXSNR = o.config.timing.nXSRD = 1;  // nothing in front of the first write
  o.config.refresh_interval = 60;
  Scenario s(eight(true), o);
  s.bench.ddr.catch_up(600 * kTck);  // shorter than what is owed takes
  std::string order;
  for (const Logged& l : s.bench.log) {
    const char c = l.cmd == Cmd::kWr ? 'W' : l.cmd == Cmd::kRef ? 'R' : l.cmd == Cmd::kSre ? 'S' : 0;
    if (c && (order.empty() || order.back() != c)) order += c;
  }
  EXPECT_EQ(order, "SWRS") << "asleep, awake for the writes, refreshed, asleep";
}

BenchOptions with(const char* scheduler) {
  BenchOptions o = options();
  o.params.emplace_back("scheduler", scheduler);
  return o;
}
/// Handed over at clock 300, so seen at 301 and scheduled from here on.
constexpr std::uint64_t kFrom = 301 + 8;

// tRCD = 5, tRRD = 3, WR to RD takes WL + 4 + tWTR = 4 + 4 + 3.
TEST(OtherSchedulersTest, FcfsGivesColumnsByAgeAndOpensRowsAhead) {
  const std::vector<Request> two = {write(kA, at(1, 0), 7), read(kB, at(1, 1), 0)};
  EXPECT_EQ(Scenario(two, with("ti")).columns(), "R1 W0");
  Scenario s(two, with("fcfs"));
  EXPECT_EQ(s.columns(), "W0 R1");
  EXPECT_EQ(s.bench.clock_of(Cmd::kAct, 0), kFrom);
  EXPECT_EQ(s.bench.clock_of(Cmd::kAct, 1), kFrom + 3) << "tRRD later, while the write waits";
  EXPECT_EQ(s.bench.clock_of(Cmd::kWr), kFrom + 5);
  EXPECT_EQ(s.bench.clock_of(Cmd::kRd), kFrom + 5 + 11);
  // An open row does not help the younger one.
  const std::vector<Request> hit = {read(kA, at(1, 1)), read(kB, at(1, 0))};
  EXPECT_EQ(Scenario(hit, with("fcfs"), {read(kC, at(1, 0))}).columns(), "R1 R0");
  EXPECT_EQ(Scenario(hit, with("ti"), {read(kC, at(1, 0))}).columns(), "R0 R1");
}

// One master's requests open rows ahead as well, where TI's rules offer only its oldest.
TEST(OtherSchedulersTest, FcfsOpensRowsAheadForOneMasterToo) {
  const std::vector<Request> two = {read(kA, at(1, 0)), read(kA, at(1, 1))};
  Scenario s(two, with("fcfs")), ti(two, with("ti"));
  EXPECT_EQ(s.bench.clock_of(Cmd::kAct, 1), kFrom + 3);
  EXPECT_EQ(s.bench.clock_of(Cmd::kRd, 1), kFrom + 5 + 4);
  EXPECT_EQ(ti.bench.clock_of(Cmd::kAct, 1), kFrom + 5 + 1);
}

// Of a bank only the oldest request decides: its open row stays for it, another one's is closed.
TEST(OtherSchedulersTest, FcfsOpensAheadOnlyWhatTheOldestOfABankNeeds) {
  const std::vector<Request> opened = {read(kC, at(1, 1))};
  // Bank 1 has row 1 open. The older of its two requests wants it, the younger one row 2.
  Scenario keeps({read(kA, at(1, 0), 3, 64), read(kB, at(1, 1)), read(kA, at(2, 1))}, with("fcfs"),
                 opened);
  EXPECT_EQ(keeps.columns(), "R0 R0 R0 R0 R1 R1");
  const std::uint64_t hit = kFrom + 5 + 16;
  EXPECT_EQ(keeps.bench.clock_of(Cmd::kRd, 1), hit);
  EXPECT_EQ(keeps.bench.clock_of(Cmd::kPre, 1), hit + 4);
  // The other way round the row is closed at once, though the younger one would find it open.
  Scenario closes({read(kA, at(1, 0), 3, 64), read(kB, at(2, 1)), read(kA, at(1, 1))}, with("fcfs"),
                  opened);
  EXPECT_EQ(closes.columns(), "R0 R0 R0 R0 R1 R1");
  EXPECT_EQ(closes.bench.clock_of(Cmd::kPre, 1), kFrom + 1);
  // The burst of the first, with columns from + 5 to + 17, is not interrupted.
  EXPECT_EQ(closes.bench.clock_of(Cmd::kAct, 1), kFrom + 5 + 13);
  EXPECT_EQ(closes.bench.clock_of(Cmd::kRd, 1), kFrom + 5 + 13 + 5);
}

// The read FIFO has room again long before the row of the oldest request may be closed (tRAS). A
// request that the crossbar has announced opens its row when it is there, not when there is room.
TEST(OtherSchedulersTest, FcfsOpensNoRowForARequestThatIsYetToCome) {
  constexpr unsigned kLater = 120;
  for (const std::uint64_t scr : {250'000'000, 31'250'000}) {
    BenchOptions o = with("fcfs");
    o.scr = Frequency(scr);
    o.config.timing.nRAS = 150;
    o.config.timing.nRC = 150 + o.config.timing.nRP;
    DdrBench b(o);
    std::vector<Request> four = {read(kA, at(1, 0), 3, 64), read(kA, at(1, 0, 64), 3, 64),
                                 read(kA, at(2, 0)), read(kB, at(1, 1))};
    for (unsigned i = 0; i < 3; ++i) ASSERT_TRUE(b.submit(four[i], 300));
    ASSERT_TRUE(b.hand_over(four[3], (300 + kLater) * kTck));
    b.drain();
    EXPECT_EQ(b.clock_of(Cmd::kAct, 1), kFrom + kLater) << scr;
    EXPECT_EQ(b.clock_of(Cmd::kPre, 0), kFrom + 150) << scr;
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  }
}

// At kFrom bank 0's row is open and serves B; at kFrom + 1 A's row opens, from kFrom + 6 on it can be
// read. C's column in the open row can go at kFrom + 4.
TEST(OtherSchedulersTest, FirstReadyTakesTheColumnThatCanGoFirst) {
  const std::vector<Request> three = {read(kA, at(1, 1)), read(kB, at(1, 0)),
                                      read(kC, at(1, 0, 64))};
  const auto served = [&](const char* scheduler, const char* open_row) {
    BenchOptions o = with(scheduler);
    o.params.emplace_back("ti_open_row", open_row);
    Scenario s(three, o, {read(Master::kVpbe, at(1, 0))});
    std::string out = s.columns();
    for (const Logged& l : s.bench.log)
      if (l.cmd == Cmd::kRd || l.cmd == Cmd::kRda) out += " " + std::to_string(l.clock - kFrom);
    return out;
  };
  EXPECT_EQ(served("frfcfs", "activated"), "R0 R0 R1 0 4 8");
  EXPECT_EQ(served("ti", "ready"), "R0 R0 R1 0 4 8");
  EXPECT_EQ(served("ti", "activated"), "R0 R1 R0 0 6 10") << "its row counts as open from its ACT on";
  EXPECT_EQ(served("fcfs", "ready"), "R1 R0 R0 5 9 13");
}

// After a write a read waits for WL + 4 + tWTR = 11 clocks, the next write for 4. With TI's rules the
// read goes first all the same.
TEST(OtherSchedulersTest, FrfcfsDoesNotWaitForTheTurnaroundWhileWritesAreReady) {
  const std::vector<Request> opened = {read(Master::kVpbe, at(1, 0))};
  const std::vector<Request> three = {write(kA, at(1, 0)), read(kB, at(1, 0, 64)),
                                      write(kC, at(1, 0, 128))};
  Scenario s(three, with("frfcfs"), opened);
  EXPECT_EQ(s.columns(), "W0 W0 R0");
  EXPECT_EQ(s.bench.clock_of(Cmd::kWr, 0, 1), kFrom + 4);
  EXPECT_EQ(s.bench.clock_of(Cmd::kRd), kFrom + 4 + 11);
  BenchOptions ready = with("ti");
  ready.params.emplace_back("ti_open_row", "ready");
  EXPECT_EQ(Scenario(three, ready, opened).columns(), "R0 W0 W0");
}

TEST(OtherSchedulersTest, FrfcfsTakesOpenRowsFirstWhateverKindAndPriority) {
  const std::vector<Request> two = {read(kA, at(1, 1), 0), write(kB, at(1, 0), 7)};
  EXPECT_EQ(Scenario(two, with("ti"), {read(kC, at(1, 0))}).columns(), "R1 W0");
  Scenario s(two, with("frfcfs"), {read(kC, at(1, 0))});
  EXPECT_EQ(s.columns(), "W0 R1");
  EXPECT_EQ(s.bench.clock_of(Cmd::kWr), kFrom);
  EXPECT_EQ(s.bench.clock_of(Cmd::kAct, 1), kFrom + 1) << "the other bank is prepared";
  EXPECT_EQ(s.bench.clock_of(Cmd::kRd), kFrom + 11);
  EXPECT_EQ(Scenario(two, with("frfcfs")).columns(), "R1 W0") << "no row open: by age";
  const std::vector<Request> turned = {write(kB, at(1, 0), 7), read(kA, at(1, 1), 0)};
  EXPECT_EQ(Scenario(turned, with("frfcfs")).columns(), "W0 R1");
}

TEST(OtherSchedulersTest, FrfcfsSortsTheRequestsOfOneMasterToo) {
  const std::vector<Request> opened = {read(kC, at(1, 0))};
  for (const bool first : {false, true})
    for (const bool second : {false, true}) {
      const std::vector<Request> two = {make(kA, first, at(1, 1), 0),
                                        make(kA, second, at(1, 0), 7)};
      const std::string a = first ? "W1" : "R1", b = second ? "W0" : "R0";
      EXPECT_EQ(Scenario(two, with("frfcfs"), opened).columns(), b + " " + a);
      EXPECT_EQ(Scenario(two, with("frfcfs")).columns(), a + " " + b) << "no row open: by age";
      const bool passes = first && !second;  // with TI's rules: a read an older write
      EXPECT_EQ(
          Scenario({make(kA, first, at(1, 1)), make(kA, second, at(1, 0))}, with("ti"), opened)
              .columns(),
          passes ? b + " " + a : a + " " + b);
    }
}

// Requests to one block have one row, so their age alone keeps them in order, but while the read
// FIFO is full: then a younger write would go before a read.
TEST(OtherSchedulersTest, FrfcfsWriteStaysBehindAnOlderReadOfItsBlock) {
  const auto last_two = [](Master writer, std::uint32_t to, std::uint32_t from) {
    BenchOptions o = with("frfcfs");
    o.scr = Frequency(31'250'000);
    std::vector<Request> all;  // the first two fill the FIFO
    for (unsigned i = 0; i < 2; ++i) all.push_back(read(kB, at(1, 1, i * 64), 3, 64));
    all.push_back(read(kA, from));
    all.push_back(write(writer, to));
    const std::string s = Scenario(all, o).columns();
    EXPECT_EQ(s.size(), 10u * 3 - 1);
    return s.substr(8 * 3);
  };
  const std::uint32_t block = at(1, 1, 512);
  EXPECT_EQ(last_two(kA, block, block), "R1 W1");
  EXPECT_EQ(last_two(kA, block + 48, block), "R1 W1") << "other bytes of the block";
  EXPECT_EQ(last_two(kA, block, block + 48), "R1 W1");
  EXPECT_EQ(last_two(kA, block + 64, block), "W1 R1") << "the neighbours";
  EXPECT_EQ(last_two(kA, block - 16, block), "W1 R1");
  EXPECT_EQ(last_two(kC, block, block), "W1 R1") << "between masters there is no order";
}

TEST(OtherSchedulersTest, FrfcfsTellsTheReadsOfOneMasterInOrder) {
  DdrBench b(with("frfcfs"));
  Request before = read(kC, at(1, 0));
  // The first one needs another row of the bank; 16 bytes are 2 words, 64 are 8.
  std::vector<Request> all = {read(kA, at(2, 0)), read(kA, at(1, 0, 64), 3, 64), read(kB, at(1, 0)),
                              read(kA, at(1, 0, 16))};
  b.submit(before, 9);
  b.drain();
  b.read_order.clear();
  for (Request& r : all) b.submit(r, 300);
  using Items = std::vector<std::string>;
  const auto state = [&] {
    Items items;
    for (const auto& i : b.ddr.view().items)
      items.push_back(std::to_string(static_cast<const Request*>(i.request->owner) - all.data()) +
                      (i.moving ? "moves"
                       : i.out_of_order ? "held"
                                : ""));
    return items;
  };
  const auto after = [&](std::uint64_t clock) {
    b.run_before(clock * kTck + 1);
    return state();
  };
  EXPECT_EQ(b.ddr.newest_read(kA), &all[3].path);
  // Columns of 1 at 309, 313, 317, 321, of 2 at 325, of 3 at 329; PRE at 333, ACT at 338, 0 at 343.
  EXPECT_EQ(after(kFrom), (Items{"0", "1moves", "2", "3"}));
  EXPECT_EQ(b.ddr.newest_read(kA), &all[3].path);
  EXPECT_EQ(after(kFrom + 12), (Items{"0", "2", "3", "1held"}));
  EXPECT_EQ(after(kFrom + 20), (Items{"0", "1held", "3held"}));
  EXPECT_EQ(b.ddr.newest_read(kA), &all[3].path);
  EXPECT_EQ(b.read_order, (std::vector<Request*>{&all[2]})) << "only of another master";
  EXPECT_EQ(after(kFrom + 34), Items{});
  EXPECT_EQ(b.ddr.newest_read(kA), nullptr);
  EXPECT_EQ(b.read_order, (std::vector<Request*>{&all[2], &all[0], &all[1], &all[3]}));
  // Data come CL + 2 after the RD and are on the return channel an edge after their fourth beat.
  EXPECT_EQ(all[2].first, (kFrom + 16 + 5 + 2 + 2 + 1) * kTck) << "at once";
  EXPECT_EQ(all[0].first, (kFrom + 34 + 5 + 2 + 2 + 1) * kTck);
  EXPECT_EQ(all[1].first, all[0].last + kTck);
  EXPECT_GE(all[1].last, all[1].first + 7 * kTck) << "a word an edge";
  EXPECT_EQ(all[3].first, all[1].last + kTck);
  EXPECT_FALSE(b.went_back);
}

// A read served in its turn comes behind those that were held, though its data do not.
TEST(OtherSchedulersTest, FrfcfsReadBehindHeldOnesWaitsForThem) {
  DdrBench b(with("frfcfs"));
  Request before = read(kC, at(1, 0));
  std::vector<Request> all = {read(kA, at(1, 1)), read(kA, at(1, 0), 3, 64),
                              read(kA, at(1, 1, 64))};
  b.submit(before, 9);
  b.drain();
  for (Request& r : all) b.submit(r, 300);
  b.drain();
  EXPECT_EQ(b.clock_of(Cmd::kRd, 1, 1), b.clock_of(Cmd::kRd, 1, 0) + 4);
  EXPECT_EQ(all[1].first, all[0].last + kTck);
  EXPECT_EQ(all[2].first, all[1].last + kTck);
}

TEST(OtherSchedulersTest, ClosedPageSavesTrpOnAnotherRowAndCostsTrcdOnTheSame) {
  const auto column = [](const char* scheduler, std::uint32_t row) {
    Scenario s({read(kA, at(row, 0))}, with(scheduler), {read(kC, at(1, 0))});
    return std::min(s.bench.clock_of(Cmd::kRd), s.bench.clock_of(Cmd::kRda));
  };
  EXPECT_EQ(column("ti", 2), kFrom + 5 + 5) << "tRP + tRCD";
  EXPECT_EQ(column("closed_page", 2), kFrom + 5) << "tRCD";
  EXPECT_EQ(column("ti", 1), kFrom);
  EXPECT_EQ(column("closed_page", 1), kFrom + 5);
}

TEST(OtherSchedulersTest, ClosedPageKeepsARowThatAnotherRequestWaitsFor) {
  Scenario s({read(kA, at(1, 0)), read(kB, at(1, 0), 3, 64)}, with("closed_page"));
  EXPECT_EQ(s.bench.count(Cmd::kAct), 1u);
  EXPECT_EQ(s.bench.count(Cmd::kRd), 4u);
  EXPECT_EQ(s.bench.count(Cmd::kRda), 1u);
  EXPECT_EQ(s.bench.clock_of(Cmd::kRda), kFrom + 5 + 4 * 4);
}

// The part precharges by itself when tRAS allows: ACT, RD at 5, so at tRAS = 11, not at 5 + 4.
TEST(OtherSchedulersTest, AutoPrechargeWaitsForTras) {
  Scenario s({read(kA, at(1, 0)), read(kB, at(2, 0))}, with("closed_page"));
  EXPECT_EQ(s.bench.clock_of(Cmd::kAct, 0, 1), kFrom + 11 + 5);
  EXPECT_EQ(s.bench.count(Cmd::kPre), 0u);
}

// With all rows closed the most urgent read ranks before the write, so no refresh; the raised
// oldest then opens its row, and now its own read ranks first, behind the write: refresh closes the
// rows. A refresh that gives way after its PREA would go round like this for ever.
TEST(RefreshRateTest, UrgentRefreshIsCarriedOutOnceItHasClosedTheRows) {
  for (std::uint64_t start = 100; start < 300; start += 5) {  // against the expiry at clock 201
    BenchOptions o = options();
    o.config.old_count = 0;
    o.config.refresh_interval = 200;
    o.params.insert(o.params.end(),
                    {{"refresh.need", "0"}, {"refresh.must", "64"}, {"refresh.gap", "64"}});
    DdrBench b(o);
    std::vector<Request> all = {read(kA, at(0, 0), 5), read(kB, at(3, 0), 0),
                                write(kC, at(1, 0), 1), read(Master::kVpbe, at(2, 0), 0)};
    for (Request& r : all) ASSERT_TRUE(b.submit(r, start));
    for (unsigned i = 0; i < 40 && b.ddr.next_decision() != kNever; ++i) b.step();
    EXPECT_EQ(b.ddr.next_decision(), kNever) << "start " << start << ": served in few commands";
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  }
}

// The family's thresholds under a stream of reads that never ends: refresh is late, but two are
// never further apart than the nine intervals of the standard, and none is lost.
TEST(RefreshRateTest, SaturatingReadsDelayRefreshWithinTheStandard) {
  BenchOptions o;
  o.config.refresh_interval = 300;
  DdrBench b(o);
  std::vector<std::unique_ptr<Request>> all;
  for (unsigned i = 0; i < 5000; ++i) {
    all.push_back(std::make_unique<Request>(read(kA, (i % 32) * 64, 3, 64)));
    while (b.input_taken()) b.step();
    b.submit_at(*all.back(), std::max<Picoseconds>(b.now(), kTck));
  }
  const std::uint64_t clock = b.now() / kTck;
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  EXPECT_GT(b.checker.largest_refresh_gap(), 8u * 300u) << "reads do go first";
  const std::uint64_t due = (clock - 1) / 300;
  EXPECT_GE(b.count(Cmd::kRef) + 12u, due) << "never more than must + 1 owed";
  EXPECT_LE(b.count(Cmd::kRef), due);
}

}  // namespace
}  // namespace fovea::dram
