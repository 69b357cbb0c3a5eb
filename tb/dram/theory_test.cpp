// Throughput against closed formulas, within 1 %. Formulas from the command distances of
// JESD79-2.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

using mem::Cmd;

/// Keeps the controller saturated with requests; clocks per request in the steady state.
double clocks_per_request(BenchOptions o, unsigned count,
                          const std::function<void(Request&, unsigned)>& describe) {
  DdrBench b(o);
  b.keep_log = false;
  std::vector<Request> all(count);
  std::uint64_t begin = 0;
  const unsigned warm = count / 10;
  for (unsigned i = 0; i < count; ++i) {
    describe(all[i], i);
    while (b.input_taken()) b.step();
    b.submit_at(all[i], std::max<Picoseconds>(b.now(), kTck));
    if (i == warm) begin = b.now();
  }
  const std::uint64_t end = b.now();
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  return static_cast<double>(end - begin) / kTck / (count - 1 - warm);
}

void expect_within_one_percent(double measured, double theory) {
  EXPECT_NEAR(measured, theory, theory * 0.01);
}

BenchOptions no_refresh() {
  BenchOptions o;
  o.config.refresh_interval = 0;
  return o;
}

// A series of refreshes: the last read's bank may be precharged 4 clocks after its RD, as the next read
// might have come; then PREA, tRP + 1, REF, tRFC for each, ACT, tRCD. Reads without end leave two series
// in 13 intervals: after eight without a REF four of the 11 owed, and after five more all above 3 of 12.
double refresh_loss(const mem::DdrConfig& c) {
  const auto& t = c.timing;
  return t.nRFC + 2.0 / 13 * (t.nRP + 1.0 + t.nRCD);
}

TEST(TheoryTest, SequentialReadsReachThePeakLessRowChangesAndRefresh) {
  BenchOptions o;
  const auto& t = o.config.timing;
  // 128 bursts of 4 clocks a row. At its end the next bank is activated one clock after the last
  // RD; it was closed by a refresh, since eight rows take longer than an interval.
  const double row = 128 * 4 + (1 + t.nRCD - 4);
  const double share = 1 - refresh_loss(o.config) / o.config.refresh_interval;
  const double measured = clocks_per_request(o, 60'000, [](Request& r, unsigned i) {
    r.bytes = 64;
    r.address = i * 64;
  });
  const double theory = row / 32 / share;
  expect_within_one_percent(measured, theory);
  EXPECT_LT(16 / measured, 0.98)
      << "97.9 % of peak before row changes: each tREFI loses tRP + 1 + tRFC + tRCD";
  EXPECT_GT(16 / measured, 0.96);
}

TEST(TheoryTest, SequentialReadsWithoutRefreshPayThePrechargeOfEachRow) {
  const BenchOptions o = no_refresh();
  const auto& t = o.config.timing;
  const double measured = clocks_per_request(o, 40'000, [](Request& r, unsigned i) {
    r.bytes = 64;
    r.address = i * 64;
  });
  // Nothing closes the rows: each row change is PRE, ACT, RD.
  expect_within_one_percent(measured, (128 * 4 + (1.0 + t.nRP + t.nRCD - 4)) / 32);
}

TEST(TheoryTest, RandomRowsOfOneBankAreBoundByTrc) {
  for (const unsigned nRC : {16u, 30u}) {
    BenchOptions o = no_refresh();
    o.config.timing.nRC = nRC;  // tRAS + tRP = 16
    expect_within_one_percent(
        clocks_per_request(o, 5'000,
                           [](Request& r, unsigned i) { r.address = at(i * 7919 % 8192, 3); }),
        nRC);
  }
}

TEST(TheoryTest, RefreshTakesItsShare) {
  for (const unsigned interval : {400u, 1000u, 1895u}) {
    BenchOptions o;
    o.config.refresh_interval = interval;
    const double measured =
        clocks_per_request(o, 60'000, [](Request& r, unsigned i) { r.address = i % 128 * 16; });
    expect_within_one_percent(measured, 4 / (1 - refresh_loss(o.config) / interval));
  }
}

TEST(TheoryTest, AlternatingReadAndWritePayBothTurnarounds) {
  for (const unsigned nWTR : {3u, 8u}) {
    BenchOptions o = no_refresh();
    o.config.timing.nWTR = nWTR;
    const auto& t = o.config.timing;
    // One master, one 2 KiB block: order is kept.
    const double measured = clocks_per_request(o, 5'000, [](Request& r, unsigned i) {
      r.write = i % 2 != 0;
      r.address = i % 128 * 16;
    });
    const double theory = (t.CL + 4 + 1 - (t.CL - 1)) + (t.CL - 1 + 4 + nWTR);
    expect_within_one_percent(measured, theory / 2);
  }
}

/// Eight masters, each always in another row of a bank of its own.
double eight_banks(unsigned nRRD, const char* scheduler = "ti") {
  BenchOptions o = no_refresh();
  o.params = {{"scheduler", scheduler}};
  o.config.timing.nRRD = nRRD;
  o.tFAW = 4 * nRRD;  // the checker holds it against the stream
  return clocks_per_request(o, 8'000, [](Request& r, unsigned i) {
    r.master = static_cast<Master>(i % 8);
    r.address = at(i / 8 % 8192, i % 8);
  });
}

// max(BL/2, tRRD): up to four clocks the data bus binds. Where tRCD is a multiple of tRRD each RD wants
// the clock of a later ACT, which then comes a clock after it.
TEST(TheoryTest, EightMastersWithABankEachAreBoundByTrrd) {
  constexpr unsigned nRCD = 5;
  for (const unsigned nRRD : {1u, 3u, 4u, 5u, 6u, 8u, 10u, 12u, 16u}) {
    const unsigned collides = nRRD > 4 && nRCD % nRRD == 0;
    expect_within_one_percent(eight_banks(nRRD), std::max(4u, nRRD + collides));
  }
}

// `fcfs` keeps the order of the data, not of the rows: these are opened ahead.
TEST(TheoryTest, FcfsOpensTheRowsOfEightBanksAhead) {
  for (const unsigned nRRD : {1u, 3u, 4u, 6u, 8u})
    expect_within_one_percent(eight_banks(nRRD, "fcfs"), std::max(4u, nRRD));
}

// Random rows of all banks, eight masters, 16 bytes: while one row opens, others are read. The longer
// tRCD is, the further ahead it is opened, and the data bus stays as busy, as long as the rows of
// what is queued cover it: tRCD + 4 clocks are a few of the 16 entries' bursts.
TEST(TheoryTest, FirstReadyThroughputDoesNotDependOnTrcd) {
  const auto random_rows = [](unsigned nRCD, const char* scheduler, const char* open_row) {
    BenchOptions o = no_refresh();
    o.config.timing.nRCD = nRCD;
    o.params = {{"scheduler", scheduler},      {"ti_open_row", open_row}, {"command_fifo", "16"},
                {"request_latency", "0 cycles"}, {"return_latency", "0 cycles"}};
    Rng rng(7);
    return clocks_per_request(o, 20'000, [&](Request& r, unsigned i) {
      r.master = static_cast<Master>(i % 8);
      r.address = at(static_cast<std::uint32_t>(rng.below(4096)), static_cast<unsigned>(rng.below(8)));
    });
  };
  const double shortest = random_rows(1, "frfcfs", "activated");
  EXPECT_LT(shortest, 4.1) << "the data bus binds";
  for (const unsigned nRCD : {2u, 4u, 6u, 8u})
    EXPECT_NEAR(random_rows(nRCD, "frfcfs", "activated"), shortest, shortest * 0.01) << nRCD;
  // TI's rules, with an open row that counts from its ACT on, pay for it.
  EXPECT_GT(random_rows(8, "ti", "activated"), 1.1 * random_rows(1, "ti", "activated"));
  EXPECT_LT(random_rows(8, "ti", "ready"), 0.95 * random_rows(8, "ti", "activated"));
}

// TI folds tFAW into T_RRD: at least a quarter of it, rounded up. So a part with tFAW of 45 clocks is
// used at 12 clocks a row, not at 11.25.
TEST(TheoryTest, FourActivatesInTfawAreFoldedIntoTrrd) {
  for (const unsigned tFAW : {13u, 16u, 24u, 40u, 45u}) {
    const unsigned nRRD = (tFAW + 3) / 4;
    const double measured = eight_banks(nRRD);
    expect_within_one_percent(measured, std::max(4u, nRRD));
    EXPECT_GE(measured * 4, tFAW);
  }
}

// One master's reads stay in order: each pays its row. From ACT to the next ACT of the bank that is
// max(tRC, tRAS + tRP, tRCD + 4 (n - 1) + BL/2 + max(tRTP, 2) - 2 + tRP) for n columns.
TEST(TheoryTest, PingPongOfOneMasterIsAtTheInOrderBound) {
  const auto ping_pong = [](unsigned bytes, unsigned masters, unsigned nRC = 16) {
    BenchOptions o = no_refresh();
    o.config.timing.nRC = nRC;
    return clocks_per_request(o, 8'000, [=](Request& r, unsigned i) {
      r.master = static_cast<Master>(i % masters);
      r.bytes = bytes;
      r.address = at(i % 2, 0, i / 2 * bytes % 2048);
    });
  };
  const mem::DdrTiming t;
  for (const unsigned bytes : {16u, 32u, 64u})
    for (const unsigned nRC : {16u, 17u, 31u}) {
      const unsigned columns = bytes / 16;
      const unsigned by_columns =
          t.nRCD + 4 * (columns - 1) + 4 + std::max(t.nRTP, 2u) - 2 + t.nRP;
      expect_within_one_percent(ping_pong(bytes, 1, nRC),
                                std::max({nRC, t.nRAS + t.nRP, by_columns}));
    }
  // The same requests of two masters may be put in order of their rows: twice as many are served.
  const double in_order = ping_pong(32, 1), by_rows = ping_pong(32, 2);
  EXPECT_GT(in_order / by_rows, 1.8);
  EXPECT_LT(in_order / by_rows, 2.3);
}

// `frfcfs` sorts the same reads of one master. Of n entries, filled in turn with both rows, p are
// still in the pipeline when a row has no more of those that are seen: n - p wait for the other
// row. For it is every second one that comes while these and those are served, so N = n - p +
// floor(N / 2) reads share a change of rows: 2 (n - p) - 1.
TEST(TheoryTest, PingPongOfOneMasterIsSortedByRowsWithFrfcfs) {
  const mem::DdrTiming t;
  const unsigned precharge = 4 + std::max(t.nRTP, 2u) - 2, latency = 8 + 1;
  for (const unsigned bytes : {16u, 32u, 64u})
    for (const unsigned entries : {6u, 7u, 12u}) {
      const auto ping_pong = [=](const char* scheduler) {
        BenchOptions o = no_refresh();
        o.params = {{"scheduler", scheduler}, {"command_fifo", std::to_string(entries)}};
        return clocks_per_request(o, 8'000, [=](Request& r, unsigned i) {
          r.bytes = bytes;
          r.address = at(i % 2, 0, i / 2 * bytes % 2048);
        });
      };
      const unsigned columns = bytes / 16, reads = 4 * columns;
      const double in_order = ping_pong("ti"), sorted = ping_pong("frfcfs");
      expect_within_one_percent(
          in_order, std::max<double>(t.nRC, t.nRCD + 4 * (columns - 1) + precharge + t.nRP));
      // The newest came with the last column, those before it a read each earlier.
      const unsigned pipeline = (latency - precharge + reads - 1) / reads;
      const double change = precharge + t.nRP + t.nRCD - 4;
      expect_within_one_percent(sorted, reads + change / (2 * (entries - pipeline) - 1));
      EXPECT_GT(in_order / sorted, bytes == 64 ? 1.5 : 1.9) << bytes << " bytes, " << entries;
    }
}

// An entry is held from acceptance to its column command: request_latency + 1 clocks at least, so n
// entries serve n requests in that time, until the data bus binds.
TEST(TheoryTest, CommandFifoBoundsTheRate) {
  for (const unsigned n : {1u, 2u, 3u, 7u}) {
    BenchOptions o = no_refresh();
    o.params.emplace_back("command_fifo", std::to_string(n));
    o.params.emplace_back("request_latency", "8 cycles");
    const double measured =
        clocks_per_request(o, 5'000, [](Request& r, unsigned i) { r.address = i % 128 * 16; });
    expect_within_one_percent(measured, std::max(4.0, 9.0 / n));
  }
}

TEST(FifoTest, SevenCommandsFitAndTheEighthWaitsForAColumnCommand) {
  DdrBench b(no_refresh());
  std::vector<Request> all(8);
  for (unsigned i = 0; i < 8; ++i) {
    all[i].address = i * 16;
    EXPECT_EQ(b.submit(all[i], 9), i < 7) << i;
  }
  EXPECT_FALSE(all[7].accepted);
  b.drain();
  // ACT at 18, RD at 23 frees the first entry.
  EXPECT_EQ(all[7].accepted_at, 23 * kTck);
  EXPECT_EQ(all[7].done, 1u);
}

// The one that waited takes the entry that the first one leaves.
TEST(FifoTest, RoomIsMadeByTheMasterWhoseRequestLeaves) {
  for (const unsigned entries : {1u, 7u}) {
    BenchOptions o = no_refresh();
    o.params.emplace_back("command_fifo", std::to_string(entries));
    DdrBench b(o);
    std::vector<Request> all(entries + 1);
    for (unsigned i = 0; i < all.size(); ++i) {
      all[i].address = i * 16;
      all[i].master = i < entries ? Master::kVpbe : Master::kArmD;
      b.submit(all[i], 9);
    }
    b.drain();
    for (unsigned i = 0; i < entries; ++i) EXPECT_FALSE(all[i].unblocked_by) << entries << ", " << i;
    EXPECT_EQ(all.back().unblocked_by, Master::kVpbe) << entries << " entries";
  }
}

TEST(FifoTest, WriteDataFifoHoldsElevenWords) {
  struct Write {
    unsigned bytes, offset;
  };
  // The last one waits in the input register.
  const std::vector<Write> cases[] = {
      {{64, 0}, {16, 0}, {8, 0}, {4, 0}},         // 8 + 2 + 1 words
      {{64, 0}, {4, 0}, {1, 7}, {2, 2}, {4, 4}},  // 8 + 1 + 1 + 1: few bytes take a word as well
      {{64, 0}, {4, 6}, {1, 0}, {1, 0}},          // 8 + 2 + 1: four bytes across two words
      {{64, 0}, {16, 4}, {1, 0}},                 // 8 + 3
      {{64, 0}, {8, 0}, {8, 0}, {4, 6}},          // 8 + 1 + 1, and one word is too few
  };
  for (const std::vector<Write>& writes : cases) {
    DdrBench b(no_refresh());
    std::vector<Request> all(writes.size());
    for (unsigned i = 0; i < all.size(); ++i) {
      all[i].write = true;
      all[i].bytes = writes[i].bytes;
      all[i].address = i * 64 + writes[i].offset;
      EXPECT_EQ(b.submit(all[i], 9), i + 1 < all.size()) << &writes - cases << ", write " << i;
    }
    b.drain();
    // WR at 23, 27, 31, 35: the last burst of the first write makes room.
    EXPECT_EQ(all.back().accepted_at, 35 * kTck) << &writes - cases;
  }
}

// The crossbar hands a request over when it grants it, its last beat still on the way. If the FIFO
// is full then and has room before the beat is there, the request counts from its own arrival.
TEST(FifoTest, RequestInTheInputRegisterIsNotSeenBeforeItsArrival) {
  BenchOptions o = no_refresh();
  o.params.emplace_back("command_fifo", "1");
  DdrBench b(o);
  Request one, two;
  two.address = 64;
  b.submit(one, 9);
  EXPECT_FALSE(b.hand_over(two, 40 * kTck)) << "the first is served at 23 only";
  b.drain();
  EXPECT_EQ(two.accepted_at, 23 * kTck);
  EXPECT_EQ(b.clock_of(Cmd::kRd, 0, 1), 40u + 1u + 8u);
}

// Of n words, 8 are kept for the read that comes: its first beats are in when at most n - 8 others still
// wait for the return channel, which takes the 16 of the two reads before it one an edge.
TEST(FifoTest, ReadDataFifoHoldsSeventeenWords) {
  const auto third_read = [](unsigned words) {  // edges after the first word on the channel
    BenchOptions o = no_refresh();
    o.scr = Frequency(31'250'000);
    if (words) o.params.emplace_back("read_fifo", std::to_string(8 * words) + " B");
    DdrBench b(o);
    std::vector<Request> all(3);
    for (unsigned i = 0; i < 3; ++i) {
      all[i].bytes = 64;
      all[i].address = i * 64;
      b.submit(all[i], 9);
    }
    b.drain();
    const std::uint64_t beats = b.clock_of(Cmd::kRd, 0, 8) + o.config.read_latency + 2 + 2;
    const std::uint64_t first = all[0].first / kTck;
    return (static_cast<double>(beats) - static_cast<double>(first)) / 8;
  };
  EXPECT_EQ(third_read(0), 16 - (17 - 8)) << "the default";
  for (const unsigned words : {13u, 16u, 17u, 18u}) EXPECT_EQ(third_read(words), 16.0 - (words - 8));
}

// Two reads share the return channel: one word an edge, the second after the first.
TEST(FifoTest, ReturnChannelCarriesOneWordAnEdge) {
  BenchOptions o = no_refresh();
  o.scr = Frequency(31'250'000);  // an edge every 8 DDR clocks: the channel is the bottleneck
  const Picoseconds edge = 8 * kTck;
  DdrBench b(o);
  Request one, two;
  one.bytes = two.bytes = 64;
  two.address = 64;
  b.submit(one, 9);
  b.submit(two, 9);
  b.drain();
  EXPECT_EQ(one.last - one.first, 7 * edge);
  EXPECT_EQ(two.first - one.last, edge);
  EXPECT_EQ(two.last - two.first, 7 * edge);
}

}  // namespace
}  // namespace fovea::dram
