// Waiting requests and watchpoints of masters, on the crossbar and controller of the SoC.
#include <gtest/gtest.h>

#include <deque>
#include <random>

#include "sw/fovea/debug/gdb_masters.h"
#include "tb/dram/path.h"

namespace fovea::app {
namespace {

using dram::Path;
using dram::PathRequest;
using Kind = GdbMasters::Kind;

constexpr std::uint32_t kRow = 0x4000;  // 8 banks of 2048 bytes

struct Bench {
  explicit Bench(const char* scheduler = "ti")
      : path(Frequency(250'000'000), Frequency(125'000'000), scheduler) {}
  Path path;
  GdbMasters masters{path.xbar, path.ddr, 0};
  std::deque<PathRequest> requests;
  std::deque<std::array<std::uint8_t, 64>> data;
  PathRequest& submit(Master m, bool write, std::uint32_t address, Picoseconds at) {
    PathRequest& r = requests.emplace_back();
    r.master = m;
    r.write = write;
    r.address = address;
    r.bytes = 64;
    r.data = data.emplace_back().data();
    path.submit(r, at);
    return r;
  }
  /// As of a time, with all decisions before it taken.
  std::string at(Picoseconds t) {
    path.run_before(t + 1);
    return masters.where(t);
  }
  /// The first time from the last one on at which `text` is said.
  Picoseconds when(const std::string& text) {
    std::string said, all;
    for (const Picoseconds from = now; now < from + kPsPerUs; now += 500) {
      const std::string next = at(now);
      if (next.find(text) != std::string::npos) return now;
      if (next != said) all += said = next;
    }
    ADD_FAILURE() << "never: " << text << " in\n" << all;
    return kNever;
  }
  Picoseconds now = 0;
};

TEST(GdbMastersTest, ARequestIsSeenOnItsWholeWay) {
  Bench b;
  EXPECT_EQ(b.at(0), "no master has a request under way\n");
  const auto& r = b.submit(Master::kVpbe, false, 0x1000, 10'000);
  EXPECT_EQ(b.at(9'999), "no master has a request under way\n") << "it is issued later";
  EXPECT_NE(b.at(10'000).find("read of 64 bytes at 0x00001000 since 10.000 ns (0.000 ns): on its "
                              "bridge"),
            std::string::npos);
  b.when("in the controller's pipeline until");
  b.when("in the SDRAM queue: row 0x0 of bank 2 is open; RD at");
  const Picoseconds served = b.when("served; its data are on their way");
  EXPECT_LT(served, r.first);
  const Picoseconds arriving = b.when("its data arrive, until");
  EXPECT_GE(arriving, r.first);
  EXPECT_LT(arriving, r.last);
  EXPECT_EQ(b.at(r.last), "no master has a request under way\n");
}

TEST(GdbMastersTest, TheOtherMasterIsNamed) {
  Bench b;
  b.path.xbar.set_priority(Master::kVpbe, 0);
  b.path.xbar.set_priority(Master::kLoad, 7);
  b.submit(Master::kLoad, false, 0x1000, 1'000);
  b.submit(Master::kVpbe, false, 0x1000 + kRow, 1'000);
  b.path.xbar.set_priority(Master::kVpfe, 1);
  b.submit(Master::kVpfe, false, 0x80'0000, 1'000);
  b.when("load (priority 7):\n    read of 64 bytes at 0x00001000 since 1.000 ns");
  b.when("in the crossbar, for the SDRAM: waits for vpbe, until");
  b.when("ns, then for vpfe (priority 1)");
  b.when("in the SDRAM queue: waits for vpbe, which is served");
  b.when("row conflict in bank 2: row 0x0 wanted, 0x1 open");
  b.when("row 0x0 of bank 2 is open; RD at");
}

TEST(GdbMastersTest, WhatTheMemoryDoesForItselfIsNamed) {
  bool turnaround = false;
  for (Picoseconds at = 8'000; at < 400'000 && !turnaround; at += 8'000) {
    Bench b;
    b.submit(Master::kVpfe, true, 0x1000, 1'000);
    b.submit(Master::kVpbe, false, 0x1040, at);
    for (Picoseconds t = at; t < at + 300'000 && !turnaround; t += 4'000)
      turnaround = b.at(t).find("ns, behind the WR of vpfe") != std::string::npos;
  }
  EXPECT_TRUE(turnaround);
  Bench b;
  // Refreshes come in the pauses; now and then a request comes within one.
  bool refresh = false;
  Picoseconds t = kPsPerUs;
  for (unsigned k = 0; k < 2'000 && !refresh; ++k) {
    t += 300'000 + k * 1'000;
    b.submit(Master::kVpbe, false, (k % 64) * kRow, t);
    for (unsigned step = 0; step < 60 && !refresh; ++step)
      refresh = b.at(t + step * 4'000).find("ns, behind a refresh") != std::string::npos;
  }
  EXPECT_TRUE(refresh);
}

TEST(GdbMastersTest, AFullQueueIsSeenAtTheInputRegister) {
  Bench b;
  for (unsigned k = 0; k < 30; ++k)
    b.submit(Master::kVpfe, true, k % 2 ? 0x1000 + 64 * k : 0x1000 + kRow + 64 * k, 1'000);
  b.submit(Master::kVpbe, false, 0x80'0000, 1'000);
  b.when("in the SDRAM controller's input register: waits for room for its data behind vpfe");
  b.when("on its port, behind the same master's earlier request");
  b.when(" more\n");
  b.when("waits for vpfe, whose request is in the slave's input register");
  b.path.drain();
  EXPECT_EQ(b.masters.where(b.requests.front().last + kPsPerMs),
            "no master has a request under way\n");
}

/// Whatever happens, each request that is issued and not over is somewhere, and no other one is
/// shown.
void every_request_is_somewhere(const char* scheduler, unsigned rows, bool held) {
  std::mt19937 rng(5);
  Bench b(scheduler);
  Picoseconds t = 0;
  unsigned seen = 0, seen_held = 0;
  for (unsigned k = 0; k < 3'000; ++k) {
    t += rng() % 60'000;
    const std::string text = b.at(t);
    EXPECT_EQ(text.find("between crossbar"), std::string::npos) << text;
    std::size_t open = 0, shown = 0;
    for (const auto& r : b.requests) open += r.issued <= t && (!r.responses || r.last > t);
    for (std::size_t p = 0; (p = text.find(" bytes at 0x", p)) != std::string::npos; ++p)
      shown += text.substr(p, 60).find(" since ") != std::string::npos;
    EXPECT_EQ(shown, open) << text;
    seen += shown;
    seen_held +=
        text.find("its data wait for those of its master's older reads") != std::string::npos;
    while (b.requests.size() > 24 && b.requests.front().responses && b.requests.front().last < t) {
      b.requests.pop_front();
      b.data.pop_front();
    }
    constexpr Master kMasters[] = {Master::kArmD, Master::kVpfe, Master::kVpbe, Master::kLoad};
    std::size_t own[4] = {};
    const unsigned m = rng() % 4;
    for (const auto& r : b.requests)
      own[m] += r.master == kMasters[m] && (!r.responses || r.last > t);
    if (own[m] < 6) b.submit(kMasters[m], rng() % 2, (rng() % rows) * kRow + (rng() % 64) * 64, t);
  }
  EXPECT_GT(seen, 1'000u);
  EXPECT_EQ(seen_held > 10, held);
}

TEST(GdbMastersTest, EveryRequestIsSomewhere) {
  every_request_is_somewhere("ti", 64, false);
  every_request_is_somewhere("frfcfs", 4, true);
}

TEST(GdbMastersTest, WatchesNameMasterTimeAndPlace) {
  Bench b;
  std::vector<GdbMasters::Hit> hits;
  b.masters.on_hit = [&](const GdbMasters::Hit& h) { hits.push_back(h); };
  b.masters.watches.push_back({0x1010, 4, 0xC000'0010, Kind::kWrite, std::nullopt, true});
  const auto& first = b.submit(Master::kVpfe, true, 0x1000, 1'000);
  b.submit(Master::kVpfe, true, 0x1040, 2'000);   // beside
  b.submit(Master::kVpbe, false, 0x1000, 3'000);  // another kind
  b.submit(Master::kArmD, true, 0x1000, 4'000);   // the core is not another master
  b.path.drain();
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_EQ(hits[0].at, first.last);
  EXPECT_EQ(hits[0].master, Master::kVpfe);
  EXPECT_TRUE(hits[0].write);
  EXPECT_EQ(hits[0].pa, 0x1010u);
  EXPECT_EQ(hits[0].va, 0xC000'0010u);

  b.masters.watches = {{0x1000, 0x100, 0x1000, Kind::kAccess, Master::kArmD, false},
                       {0x103F, 1, 0x103F, Kind::kRead, std::nullopt, false}};
  hits.clear();
  const Picoseconds later = 10 * kPsPerUs;
  b.submit(Master::kVpbe, false, 0x1000, later);
  b.submit(Master::kArmD, false, 0x1080, later);
  b.submit(Master::kVpfe, true, 0x1000, later);
  b.path.drain();
  ASSERT_EQ(hits.size(), 2u);
  std::sort(hits.begin(), hits.end(), [](auto& x, auto& y) { return x.pa < y.pa; });
  EXPECT_EQ(hits[0].master, Master::kVpbe);
  EXPECT_EQ(hits[0].pa, 0x103Fu);
  EXPECT_EQ(hits[0].bytes, 1u);
  EXPECT_EQ(hits[1].master, Master::kArmD);
  EXPECT_EQ(hits[1].pa, 0x1080u);
  EXPECT_EQ(hits[1].va, 0x1080u) << "as far into the range as the access";
}

struct Counter : MemObserver {
  unsigned in = 0, out = 0;
  void submitted(const MemRequest&, bool) override { ++in; }
  void responded(const MemRequest&) override { ++out; }
};

/// Looking changes nothing, and who looked on before still does, meanwhile and afterwards.
TEST(GdbMastersTest, NothingChangesByLooking) {
  const auto play = [](bool look) {
    Path path;
    Counter counter;
    const Subscription counting = path.xbar.observe(counter);
    std::optional<GdbMasters> masters;
    if (look) masters.emplace(path.xbar, path.ddr, 0);
    std::deque<PathRequest> requests;
    std::array<std::uint8_t, 64> data{};
    std::mt19937 rng(3);
    std::string out;
    for (unsigned k = 0; k < 500; ++k) {
      PathRequest& r = requests.emplace_back();
      r.master = k % 3 ? Master::kVpbe : Master::kVpfe;
      r.write = k % 3 == 0;
      r.address = (rng() % 32) * kRow + (rng() % 8) * 0x800;
      r.bytes = 64;
      r.data = data.data();
      path.submit(r, k * 200'000);
      path.run_before((k + 1) * 200'000);
      if (look) masters->where((k + 1) * 200'000);
    }
    path.drain();
    for (const auto& r : requests) out += std::to_string(r.last) + " ";
    masters.reset();
    EXPECT_EQ(counter.in, 500u);
    EXPECT_EQ(counter.out, 500u);
    PathRequest& last = requests.emplace_back();
    last.master = Master::kVpbe;
    last.bytes = 64;
    last.data = data.data();
    path.submit(last, 1000 * 200'000);
    path.drain();
    EXPECT_EQ(counter.in, 501u);
    EXPECT_EQ(counter.out, 501u);
    return out;
  };
  EXPECT_EQ(play(true), play(false));
}

}  // namespace
}  // namespace fovea::app
