// Cause and effect: each timing moves the time it should by exactly the clocks it should. All times
// are computed by hand from the relations of JESD79-2; the bench's DDR and crossbar clocks are
// one.
#include <gtest/gtest.h>

#include <functional>
#include <ostream>

#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

using mem::Cmd;

// Handed over at clock 9: seen at 10, scheduled from 10 + request_latency (8).
constexpr std::uint64_t kSubmit = 9;
constexpr std::uint64_t kStart = 18;

Request read(Master m, std::uint32_t address, unsigned bytes = 16) {
  Request r;
  r.master = m;
  r.address = address;
  r.bytes = bytes;
  return r;
}
Request write(Master m, std::uint32_t address, unsigned bytes = 16) {
  Request r = read(m, address, bytes);
  r.write = true;
  return r;
}
constexpr Master kA = Master::kRemapEngine, kB = Master::kLoad;

/// A scenario gives the clock of its last act.
struct Effect {
  const char* name;
  std::function<void(BenchOptions&, unsigned)> enlarge;  // by n clocks
  std::function<std::uint64_t(DdrBench&)> run;
  std::uint64_t expected;  // with the base configuration
};
std::ostream& operator<<(std::ostream& os, const Effect& e) { return os << e.name; }

BenchOptions base() {
  BenchOptions o;
  auto& t = o.config.timing;
  t.CL = 5;
  t.nRCD = 6;
  t.nRP = 7;
  t.nRAS = 20;
  t.nRC = 20;  // below tRAS + tRP: enlarged where it shall bind
  t.nRRD = 5;
  t.nWR = 9;
  t.nWTR = 4;
  t.nRTP = 3;
  t.nRFC = 40;
  t.banks = 8;
  o.config.read_latency = 7;
  o.config.refresh_interval = 100'000;
  return o;
}

std::uint64_t read_first_beat(DdrBench& b) {
  Request r = read(kA, at(1, 0));
  b.submit(r, kSubmit);
  b.drain();
  return r.first / kTck;
}
std::uint64_t read_last_beat(DdrBench& b) {
  Request r = read(kA, at(1, 0), 32);
  b.submit(r, kSubmit);
  b.drain();
  return r.last / kTck;
}
/// One access, then a row conflict in its bank: clock of the PRE.
std::uint64_t conflict_precharge(DdrBench& b, bool first_write) {
  Request first = first_write ? write(kA, at(1, 0)) : read(kA, at(1, 0));
  Request second = first_write ? write(kA, at(2, 0)) : read(kA, at(2, 0));
  b.submit(first, kSubmit);
  b.submit(second, kSubmit);
  b.drain();
  return b.clock_of(Cmd::kPre);
}
std::uint64_t column_after(DdrBench& b, Cmd first, Cmd second) {
  Request one = first == Cmd::kWr ? write(kA, at(1, 0)) : read(kA, at(1, 0));
  Request two = second == Cmd::kWr ? write(kB, at(1, 0, 64)) : read(kB, at(1, 0, 64));
  b.submit(one, kSubmit);
  // After the first has its column command, so that read-before-write does not turn them around.
  b.submit(two, kStart + 7);
  b.drain();
  return b.clock_of(second, -1, first == second ? 1 : 0);
}

class EffectTest : public testing::TestWithParam<Effect> {};

TEST_P(EffectTest, MovesTheTimeByExactlyItsClocks) {
  for (const unsigned n : {0u, 1u, 2u, 7u}) {
    BenchOptions o = base();
    GetParam().enlarge(o, n);
    DdrBench b(o);
    EXPECT_EQ(GetParam().run(b), GetParam().expected + n) << "enlarged by " << n;
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  }
}

// A lone read: ACT at 18, RD at 18 + tRCD = 24, first 8 bytes at the pins after max(RL, CL) = 7 and
// 2 clocks of beats, 2 clocks of return path; on the crossbar at the next edge: 24 + 7 + 2 + 2 + 1.
constexpr std::uint64_t kFirstBeat = kStart + 6 + 7 + 2 + 2 + 1;

INSTANTIATE_TEST_SUITE_P(
    Timings, EffectTest,
    testing::Values(
        Effect{"request_latency",
               [](BenchOptions& o, unsigned n) {
                 o.params.emplace_back("request_latency", std::to_string(8 + n) + " cycles");
               },
               read_first_beat, kFirstBeat},
        Effect{"return_latency",
               [](BenchOptions& o, unsigned n) {
                 o.params.emplace_back("return_latency", std::to_string(2 + n) + " cycles");
               },
               read_first_beat, kFirstBeat},
        Effect{"RL", [](BenchOptions& o, unsigned n) { o.config.read_latency += n; },
               read_first_beat, kFirstBeat},
        // CL is the floor of RL: with RL = 0 it is what counts.
        Effect{"CL",
               [](BenchOptions& o, unsigned n) {
                 o.config.read_latency = 0;
                 o.config.timing.CL += n;
               },
               read_first_beat, kFirstBeat - 2},
        // 32 bytes: the last beat of the second burst is at RD + 4 + latency + 4.
        Effect{"RL, last beat", [](BenchOptions& o, unsigned n) { o.config.read_latency += n; },
               read_last_beat, kStart + 6 + 4 + 7 + 2 + 4 + 1},
        Effect{"CL, as write latency + 1",
               [](BenchOptions& o, unsigned n) { o.config.timing.CL += n; },
               // WR at 24; WL + 4 + tWTR = 4 + 4 + 4
               [](DdrBench& b) { return column_after(b, Cmd::kWr, Cmd::kRd); }, 24 + 12},
        Effect{"tRCD before RD", [](BenchOptions& o, unsigned n) { o.config.timing.nRCD += n; },
               [](DdrBench& b) {
                 read_first_beat(b);
                 return b.clock_of(Cmd::kRd);
               },
               kStart + 6},
        Effect{"tRCD before WR", [](BenchOptions& o, unsigned n) { o.config.timing.nRCD += n; },
               [](DdrBench& b) {
                 Request w = write(kA, at(1, 0));
                 b.submit(w, kSubmit);
                 b.drain();
                 return b.clock_of(Cmd::kWr);
               },
               kStart + 6},
        // RD at 24; PRE when tRAS is over: 18 + 20 = 38, after RD + 5.
        Effect{"tRAS", [](BenchOptions& o, unsigned n) { o.config.timing.nRAS += n; },
               [](DdrBench& b) { return conflict_precharge(b, false); }, kStart + 20},
        Effect{"tRP", [](BenchOptions& o, unsigned n) { o.config.timing.nRP += n; },
               [](DdrBench& b) {
                 conflict_precharge(b, false);
                 return b.clock_of(Cmd::kAct, 0, 1);
               },
               kStart + 20 + 7},
        // Enlarged to tRAS + tRP = 27 and beyond it binds.
        Effect{"tRC", [](BenchOptions& o, unsigned n) { o.config.timing.nRC = 27 + n; },
               [](DdrBench& b) {
                 conflict_precharge(b, false);
                 return b.clock_of(Cmd::kAct, 0, 1);
               },
               kStart + 27},
        Effect{"tRRD",
               [](BenchOptions& o, unsigned n) {
                 o.config.timing.nRCD = 30;  // keeps the first RD off the command bus
                 o.config.timing.nRRD += n;
               },
               [](DdrBench& b) {
                 Request one = read(kA, at(1, 0)), two = read(kB, at(1, 1));
                 b.submit(one, kSubmit);
                 b.submit(two, kSubmit);
                 b.drain();
                 return b.clock_of(Cmd::kAct, 1);
               },
               kStart + 5},
        // WR at 24; PRE at WR + WL + 4 + tWR = 24 + 4 + 4 + 9.
        Effect{"tWR", [](BenchOptions& o, unsigned n) { o.config.timing.nWR += n; },
               [](DdrBench& b) { return conflict_precharge(b, true); }, 24 + 17},
        Effect{"tWTR", [](BenchOptions& o, unsigned n) { o.config.timing.nWTR += n; },
               [](DdrBench& b) { return column_after(b, Cmd::kWr, Cmd::kRd); }, 24 + 12},
        // With tRAS out of the way: PRE at RD + 4 + max(tRTP, 2) - 2 = 24 + 5.
        Effect{"tRTP",
               [](BenchOptions& o, unsigned n) {
                 o.config.timing.nRAS = 1;
                 o.config.timing.nRTP += n;
               },
               [](DdrBench& b) { return conflict_precharge(b, false); }, 24 + 5},
        // The refresh due at clock 100 is under way when the read of clock 101 comes: ACT waits.
        Effect{"tRFC",
               [](BenchOptions& o, unsigned n) {
                 o.config.refresh_interval = 99;
                 o.config.timing.nRFC += n;
               },
               [](DdrBench& b) {
                 Request r = read(kA, at(1, 0));
                 b.submit(r, 101);
                 b.drain();
                 EXPECT_EQ(b.clock_of(Cmd::kRef), 100u);
                 return b.clock_of(Cmd::kAct);
               },
               100 + 40},
        // The interval counts from clock 1, the first after the registers were written.
        Effect{"RR", [](BenchOptions& o, unsigned n) { o.config.refresh_interval = 99 + n; },
               [](DdrBench& b) {
                 Request r = read(kA, at(1, 0));
                 b.submit(r, 110);
                 b.drain();
                 return b.clock_of(Cmd::kAct);
               },
               100 + 40}));

BenchOptions asleep(mem::LowPower mode) {
  BenchOptions o = base();
  o.config.low_power = mode;
  o.params.emplace_back("request_latency", "0 cycles");
  return o;
}
/// Handed over at 100: seen, and CKE raised, at 101.
std::uint64_t wakes_at(const mem::DdrConfig& c, Cmd cmd) {
  BenchOptions o = asleep(c.low_power);
  o.config = c;
  DdrBench b(o);
  Request r = read(kA, at(1, 0));
  b.submit(r, 100);
  b.drain();
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  return b.clock_of(cmd);
}

TEST(LowPowerTest, ExitCostsTxpOrTxsnrAndTxsrd) {
  for (const unsigned n : {0u, 1u, 7u}) {
    mem::DdrConfig c = asleep(mem::LowPower::kOff).config;
    EXPECT_EQ(wakes_at(c, Cmd::kAct), 101u);
    c.low_power = mem::LowPower::kPowerDown;
    c.timing.nXP = 3 + n;
    EXPECT_EQ(wakes_at(c, Cmd::kPdx), 101u);
    EXPECT_EQ(wakes_at(c, Cmd::kAct), 101u + 3 + n);
    c.low_power = mem::LowPower::kSelfRefresh;
    c.timing.nXSNR = 34 + n;
    EXPECT_EQ(wakes_at(c, Cmd::kSrx), 101u);
    EXPECT_EQ(wakes_at(c, Cmd::kAct), 101u + 34 + n);
    EXPECT_EQ(wakes_at(c, Cmd::kRd), 101u + 200) << "tXSRD, not tXSNR + tRCD";
    c.timing.nXSRD = 200 + n;
    EXPECT_EQ(wakes_at(c, Cmd::kRd), 101u + 200 + n);
  }
}

// The controller's own pipeline hides a short exit: it knows of the request before it can serve it.
TEST(LowPowerTest, PowerDownExitHidesBehindTheRequestLatency) {
  for (const unsigned latency : {0u, 2u, 3u, 8u}) {
    BenchOptions o = asleep(mem::LowPower::kPowerDown);
    o.params.back().second = std::to_string(latency) + " cycles";
    DdrBench b(o);
    Request r = read(kA, at(1, 0));
    b.submit(r, 100);
    b.drain();
    EXPECT_EQ(b.clock_of(Cmd::kAct), 101u + std::max(latency, 3u));
  }
}

// RD at 101 + 3 + 6 = 110, its data over at 110 + CL + 4 + 1 = 120: there CKE falls. The next
// request is seen at 121; CKE stays low for tCKE. Power-down kept the row.
TEST(LowPowerTest, CkeStaysLowForTckeAndTheRowStaysOpen) {
  for (const unsigned n : {0u, 1u, 7u}) {
    BenchOptions o = asleep(mem::LowPower::kPowerDown);
    o.config.timing.nCKE += n;
    DdrBench b(o);
    Request one = read(kA, at(1, 0)), two = read(kB, at(1, 0, 64));
    b.submit(one, 100);
    b.drain();
    b.submit(two, 120);
    b.drain();
    EXPECT_EQ(b.clock_of(Cmd::kPde, -1, 1), 120u);
    EXPECT_EQ(b.clock_of(Cmd::kRd, -1, 1), 120u + 3 + n + 3);
    EXPECT_EQ(b.count(Cmd::kAct), 1u);
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
    EXPECT_EQ(b.ddr.stats.power_downs.count(), 2u);
  }
}

// A refresh that falls due at 301 wakes the part; REF follows tXP = 3 later, and CKE falls again after
// it, but not before it has been high for tCKE.
TEST(LowPowerTest, CkeStaysHighForTckeToo) {
  for (const unsigned nCKE : {3u, 4u, 5u, 20u}) {
    BenchOptions o = asleep(mem::LowPower::kPowerDown);
    o.config.refresh_interval = 300;
    o.config.timing.nCKE = nCKE;
    DdrBench b(o);
    b.ddr.catch_up(500 * kTck);
    EXPECT_EQ(b.clock_of(Cmd::kPdx), 301u);
    EXPECT_EQ(b.clock_of(Cmd::kRef), 304u);
    EXPECT_EQ(b.clock_of(Cmd::kPde, -1, 1), 301u + std::max(4u, nCKE)) << "tCKE " << nCKE;
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  }
}

TEST(LowPowerTest, SelfRefreshClosesTheRowsAndNeedsNoRefresh) {
  BenchOptions o = asleep(mem::LowPower::kSelfRefresh);
  o.config.refresh_interval = 300;
  DdrBench b(o);
  Request r = read(kA, at(1, 0));
  b.submit(r, 100);
  b.drain();
  const std::uint64_t rd = b.clock_of(Cmd::kRd);
  b.ddr.catch_up(20'000 * kTck);
  // PRE is legal at RD + 5; CKE falls tRP + 1 later.
  EXPECT_EQ(b.clock_of(Cmd::kPreAll), rd + 5);
  EXPECT_EQ(b.clock_of(Cmd::kSre, -1, 1), rd + 5 + 8);
  EXPECT_EQ(b.count(Cmd::kRef), 0u);
  EXPECT_EQ(b.ddr.stats.self_refreshes.count(), 2u);
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
}

// Power-down is left for each refresh: 3 for tXP, and CKE falls with the next clock after REF.
TEST(LowPowerTest, PowerDownIsLeftForRefresh) {
  BenchOptions o = asleep(mem::LowPower::kPowerDown);
  o.config.refresh_interval = 99;
  DdrBench b(o);
  b.ddr.catch_up(1'000 * kTck);
  EXPECT_EQ(b.clock_of(Cmd::kPdx), 100u);
  EXPECT_EQ(b.clock_of(Cmd::kRef), 103u);
  EXPECT_EQ(b.clock_of(Cmd::kPde, -1, 1), 104u);
  EXPECT_EQ(b.count(Cmd::kRef), 10u);
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
}

TEST(LowPowerTest, ClearingTheBitWakesThePart) {
  BenchOptions o = asleep(mem::LowPower::kSelfRefresh);
  DdrBench b(o);
  b.ddr.catch_up(50 * kTck);
  EXPECT_EQ(b.count(Cmd::kSre), 1u);
  o.config.low_power = mem::LowPower::kOff;
  b.ddr.configure(o.config, 50 * kTck);
  EXPECT_EQ(b.clock_of(Cmd::kSrx), 51u);
  Request r = read(kA, at(1, 0));
  b.submit(r, 100);
  b.drain();
  EXPECT_EQ(b.clock_of(Cmd::kAct), 101u) << "51 + 34 is past";
  EXPECT_EQ(b.clock_of(Cmd::kRd), 251u) << "tXSRD is not";
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
}

// What does not bind does not move anything.
TEST(TimingTest, ShortTrtpIsTwoClocks) {
  for (const unsigned nRTP : {1u, 2u}) {
    BenchOptions o = base();
    o.config.timing.nRAS = 1;
    o.config.timing.nRTP = nRTP;
    DdrBench b(o);
    EXPECT_EQ(conflict_precharge(b, false), 24u + 4u);
  }
}

TEST(TimingTest, TrcBelowTrasPlusTrpDoesNotBind) {
  for (const unsigned nRC : {1u, 26u, 27u}) {
    BenchOptions o = base();
    o.config.timing.nRC = nRC;
    DdrBench b(o);
    conflict_precharge(b, false);
    EXPECT_EQ(b.clock_of(Cmd::kAct, 0, 1), kStart + 27);
  }
}

TEST(TimingTest, ReadLatencyBelowClChangesNothing) {
  for (const unsigned rl : {0u, 4u, 5u}) {
    BenchOptions o = base();
    o.config.read_latency = rl;
    DdrBench b(o);
    EXPECT_EQ(read_first_beat(b), kFirstBeat - 2);
  }
}

// Bursts of one direction follow each other every 4 clocks; RD to WR takes CL + 4 + 1 - WL = 6.
TEST(TimingTest, DataBusTurnaround) {
  Request a = read(kA, at(1, 0), 64);
  BenchOptions o = base();
  DdrBench b(o);
  b.submit(a, kSubmit);
  b.drain();
  for (unsigned i = 0; i < 4; ++i) EXPECT_EQ(b.clock_of(Cmd::kRd, 0, i), 24u + 4u * i);
  Request w = write(kA, at(1, 0), 64);
  DdrBench c(o);
  c.submit(w, kSubmit);
  c.drain();
  for (unsigned i = 0; i < 4; ++i) EXPECT_EQ(c.clock_of(Cmd::kWr, 0, i), 24u + 4u * i);
  Request r = read(kA, at(1, 0)), then = write(kB, at(1, 0, 64));
  DdrBench d(o);
  d.submit(r, kSubmit);
  d.submit(then, kSubmit);
  d.drain();
  EXPECT_EQ(d.clock_of(Cmd::kWr), 24u + 6u);
}

// Precharging all of eight banks takes tRP + 1 before REF, of four tRP.
TEST(TimingTest, PrechargeAllBeforeRefresh) {
  for (const unsigned banks : {4u, 8u}) {
    BenchOptions o = base();
    o.config.timing.banks = banks;
    o.config.refresh_interval = 99;
    DdrBench b(o);
    Request open = read(kA, 0), later = read(kA, 0);
    b.submit(open, kSubmit);
    b.submit(later, 150);
    b.drain();
    EXPECT_EQ(b.clock_of(Cmd::kPreAll), 100u);
    EXPECT_EQ(b.clock_of(Cmd::kRef), 100u + 7u + (banks == 8 ? 1u : 0u));
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  }
}

// Mobile DDR: WL = 1; RD to WR takes CL + BL/2, RD to PRE BL/2 whatever tRTP.
TEST(TimingTest, MobilePartsHaveTheirOwnRelations) {
  const auto run = [](bool mobile, auto scenario) {
    BenchOptions o = base();
    o.config.timing.banks = 4;
    o.config.timing.nRAS = 1;
    o.config.timing.nRTP = 5;
    o.config.timing.mobile = mobile;
    DdrBench b(o);
    const std::uint64_t clock = scenario(b);
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
    return clock;
  };
  const auto read_write = [](DdrBench& b) {
    Request one = read(kA, at(1, 0)), two = write(kB, at(1, 0, 64));
    b.submit(one, kSubmit);
    b.submit(two, kSubmit);
    b.drain();
    return b.clock_of(Cmd::kWr);
  };
  const auto write_read = [](DdrBench& b) {
    Request one = write(kA, at(1, 0)), two = read(kB, at(1, 0, 64));
    b.submit(one, kSubmit);
    b.submit(two, kSubmit + 7);  // ready at 25, when the write has its column
    b.drain();
    return b.clock_of(Cmd::kRd);
  };
  const auto read_close = [](DdrBench& b) { return conflict_precharge(b, false); };
  const auto write_close = [](DdrBench& b) { return conflict_precharge(b, true); };
  EXPECT_EQ(run(false, read_write), 24u + 5 + 4 + 1 - 4);
  EXPECT_EQ(run(true, read_write), 24u + 5 + 4);
  EXPECT_EQ(run(false, write_read), 24u + 4 + 4 + 4);
  EXPECT_EQ(run(true, write_read), 24u + 1 + 4 + 4);
  EXPECT_EQ(run(false, read_close), 24u + 4 + 5 - 2);
  EXPECT_EQ(run(true, read_close), 24u + 4);
  EXPECT_EQ(run(false, write_close), 24u + 4 + 4 + 9);
  EXPECT_EQ(run(true, write_close), 24u + 1 + 4 + 9);
}

// A read is announced before its first beat, whatever the latencies: the outcome is never reported too late.
TEST(TimingTest, ReadsAreAnnouncedBeforeTheirFirstBeat) {
  BenchOptions o = base();
  o.config.timing.CL = 2;
  o.config.read_latency = 0;
  o.params.emplace_back("return_latency", "0 cycles");
  DdrBench b(o);
  Request r = read(kA, at(1, 0), 64);
  b.submit(r, kSubmit);
  while (b.read_order.empty()) b.step();
  EXPECT_EQ(b.now() / kTck, 24u) << "with the first column command";
  EXPECT_EQ(r.first / kTck, 24u + 2u + 2u + 1u);
  EXPECT_EQ(r.last / kTck, 24u + 2u + 16u + 1u);
}

// Address maps: a run of addresses goes to the next bank after 2 KiB, or stays in its bank.
TEST(AddressMapTest, BankFollowsThePageOrLiesOnTop) {
  BenchOptions o = base();
  DdrBench low(o);
  Request a = read(kA, 2048 * 3 + 100 * 16), b = read(kB, 2048 * 8);
  low.submit(a, kSubmit);
  low.submit(b, kSubmit);
  low.drain();
  EXPECT_EQ(low.log[0], (Logged{Cmd::kAct, 3, 0, kStart}));
  EXPECT_EQ(low.clock_of(Cmd::kAct, 0), low.log[0].clock + 5) << "next row, bank 0, after tRRD";
  o.config.bank_on_top = true;
  DdrBench top(o);
  const std::uint32_t eighth = 16u << 20;  // 128 MiB / 8 banks
  Request c = read(kA, 2048 * 3), d = read(kB, eighth * 5 + 2048 * 2);
  top.submit(c, kSubmit);
  top.submit(d, kSubmit);
  top.drain();
  EXPECT_EQ(top.log[0], (Logged{Cmd::kAct, 0, 3, kStart}));
  EXPECT_EQ(top.log[1], (Logged{Cmd::kAct, 5, 2, kStart + 5}));
}

// All page sizes, one to eight banks, both maps: bank and row of the ACT against plain division.
TEST(AddressMapTest, BanksAndRowsOfEveryGeometry) {
  Rng rng(11);
  constexpr std::uint64_t kSize = 128u << 20;
  for (unsigned page_log2 = 9; page_log2 <= 12; ++page_log2)
    for (unsigned banks = 1; banks <= 8; banks *= 2)
      for (const bool top : {false, true}) {
        BenchOptions o = base();
        o.config.page_log2 = page_log2;
        o.config.timing.banks = banks;
        o.config.bank_on_top = top;
        const std::uint64_t page = std::uint64_t{1} << page_log2, part = kSize / banks;
        for (unsigned i = 0; i < 6; ++i) {
          const std::uint32_t a =
              i == 0 ? 0 : i == 1 ? kSize - 16 : static_cast<std::uint32_t>(rng.below(kSize / 16)) * 16;
          DdrBench b(o);
          Request r = read(kA, a);
          b.submit(r, kSubmit);
          b.drain();
          const auto bank = static_cast<unsigned>(top ? a / part : a / page % banks);
          const auto row = static_cast<std::uint32_t>(top ? a % part / page : a / page / banks);
          EXPECT_EQ(b.log[0], (Logged{Cmd::kAct, bank, row, kStart}))
              << page << " bytes, " << banks << " banks, top " << top << ", address " << a;
          EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
        }
      }
}

// The clock stops and comes back while a request waits: it is served then, not lost.
TEST(ClockTest, RequestSurvivesAStoppedClock) {
  DdrBench b(base());
  Request r = read(kA, at(1, 0));
  b.submit(r, kSubmit);
  b.ddr.set_clocks(Frequency{}, kDdr, 12 * kTck);
  EXPECT_EQ(b.ddr.next_decision(), kNever);
  b.ddr.set_clocks(kDdr, kDdr, 1000 * kTck);
  b.drain();
  EXPECT_EQ(r.done, 1u);
  // Edge 12 would have come next when it stopped and comes at clock time 1000: ACT at edge 18.
  EXPECT_EQ(r.first, (1000 + kFirstBeat - 12) * kTck);
}

// New timing takes effect after its write; refreshes that were due before it were done before it.
TEST(ClockTest, ReconfigurationDoesNotUndoThePast) {
  BenchOptions o = base();
  o.config.refresh_interval = 99;
  DdrBench b(o);
  o.config.refresh_interval = 1000;
  b.ddr.configure(o.config, 500 * kTck);
  EXPECT_EQ(b.count(Cmd::kRef), 5u) << "at 100, 199, 298, 397, 496";
  b.ddr.catch_up(1500 * kTck);
  EXPECT_EQ(b.count(Cmd::kRef), 5u);
  b.ddr.catch_up(1501 * kTck);
  EXPECT_EQ(b.clock_of(Cmd::kRef, -1, 5), 1501u) << "the new interval counts from edge 501";
}

}  // namespace
}  // namespace fovea::dram
