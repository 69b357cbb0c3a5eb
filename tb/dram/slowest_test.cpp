// The slowest request of a port and its steps: computed by hand, and under load against all requests and the
// sums that the attribution of waits keeps by another way.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <vector>

#include "tb/dram/bench.h"
#include "tb/dram/path.h"
#include "tb/dram/xbar_bench.h"

namespace fovea {
/// For the messages of tests.
void PrintTo(const RequestStep& s, std::ostream* out) {
  *out << "place " << static_cast<int>(s.place) << " culprit " << static_cast<int>(s.culprit) << " " << s.from << ".."
       << s.to;
}
bool operator==(const RequestStep& a, const RequestStep& b) {
  return a.place == b.place && a.culprit == b.culprit && a.from == b.from && a.to == b.to;
}
}  // namespace fovea

namespace fovea::dram {
namespace {

using Place = RequestPlace;
constexpr Master kCamera = Master::kVpfe, kDisplay = Master::kVpbe, kEngine = Master::kRemapEngine;

/// Steps from ends that count from `start`.
struct End {
  Place place;
  Culprit culprit;
  Picoseconds end;
};
std::vector<RequestStep> steps(Picoseconds start, const std::vector<End>& ends) {
  std::vector<RequestStep> out;
  Picoseconds from = start;
  for (const End& e : ends) {
    out.push_back({e.place, e.culprit, from, start + e.end});
    from = start + e.end;
  }
  return out;
}

// Edges of 10 ns. Both writes of 8 words are through their bridges at edge 8. The camera, more urgent, has the
// data bus at 8 to 15, the display's words cross at 16 to 23, and two edges on it is acknowledged.
TEST(SlowestTest, AWriteBehindAnotherMasters) {
  XbarBench b;
  b.xbar.set_priority(kCamera, 0);
  b.submit(kCamera, 5, true, 64);
  b.submit(kDisplay, 5, true, 64);
  b.run();
  const SlowRequest& s = b.xbar.latencies[index(kDisplay)].slowest_write;
  EXPECT_EQ(s.issued, 5 * kEdge);
  EXPECT_EQ(s.latency, 21 * kEdge);
  EXPECT_EQ(s.bytes, 64u);
  EXPECT_TRUE(s.write);
  EXPECT_EQ(s.steps, steps(5 * kEdge, {{Place::kPort, Culprit::kBridge, 3 * kEdge},
                                       {Place::kCrossbar, culprit(kCamera), 11 * kEdge},
                                       {Place::kCrossbar, Culprit::kService, 19 * kEdge},
                                       {Place::kReturn, Culprit::kBridge, 21 * kEdge}}));
  EXPECT_EQ(b.xbar.latencies[index(kDisplay)].slowest_read.latency, 0u);
}

// There is room at edge 30, in the input at 31, which the engine's request made.
TEST(SlowestTest, AWriteThatWaitsForRoomSaysWhoMadeIt) {
  XbarBench b;
  b.ddr_accepts = false;
  b.submit(kCamera, 5, true, 64);
  b.run();
  b.xbar.slave_accepted(b, *b.sent.at(0), 30 * kEdge, kEngine);
  EXPECT_EQ(b.xbar.latencies[index(kCamera)].slowest_write.steps,
            steps(5 * kEdge, {{Place::kPort, Culprit::kBridge, 3 * kEdge},
                              {Place::kCrossbar, Culprit::kService, 11 * kEdge},
                              {Place::kController, culprit(kEngine), 26 * kEdge},
                              {Place::kReturn, Culprit::kBridge, 28 * kEdge}}));
}

// The second of two words of one master shows itself when the first has gone: a clock behind it.
TEST(SlowestTest, AmongEqualsTheEarliestAndItsOwnQueueCountsAsItsOwn) {
  XbarBench b;
  b.submit(kCamera, 5, true, 8);
  b.submit(kCamera, 5, true, 8);
  b.submit(kCamera, 50, true, 8);
  b.submit(kCamera, 50, true, 8);
  b.run();
  const SlowRequest& s = b.xbar.latencies[index(kCamera)].slowest_write;
  EXPECT_EQ(s.issued, 5 * kEdge);
  EXPECT_EQ(s.steps, steps(5 * kEdge, {{Place::kPort, Culprit::kBridge, 3 * kEdge},
                                       {Place::kCrossbar, culprit(kCamera), 4 * kEdge},
                                       {Place::kCrossbar, Culprit::kService, 5 * kEdge},
                                       {Place::kReturn, Culprit::kBridge, 7 * kEdge}}));
}

// 100 words of others go first, of which the newest 63 are remembered beside its own.
TEST(SlowestTest, WhatIsForgottenIsNotKnown) {
  XbarBench b;
  for (const Master m : {kCamera, kEngine}) b.xbar.set_priority(m, 0);
  for (int n = 0; n < 50; ++n)
    for (const Master m : {kCamera, kEngine}) b.submit(m, 5, true, 8);
  b.submit(kDisplay, 5, true, 8);
  b.run();
  const SlowRequest& s = b.xbar.latencies[index(kDisplay)].slowest_write;
  ASSERT_EQ(s.latency, (3 + 100 + 1 + 2) * kEdge);
  ASSERT_EQ(s.steps.size(), 1u + 1 + 63 + 1 + 1);
  EXPECT_EQ(s.steps[1], (RequestStep{Place::kCrossbar, Culprit::kCount, 8 * kEdge, (8 + 37) * kEdge}));
  EXPECT_EQ(s.steps[2].to - s.steps[2].from, kEdge);
}

/// DDR 250 MHz (4 ns), crossbar 125 MHz (8 ns), without refresh; row and bank by address.
class SdramTest : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kRow = 1u << 14, kBank = 1u << 11;
  SdramTest() {
    config_.refresh_interval = 0;
    path_.ddr.configure(config_, 0);
  }
  PathRequest& read(Master m, Picoseconds at, std::uint32_t address) {
    requests_.emplace_back();
    PathRequest& r = requests_.back();
    r.master = m;
    r.bytes = 32;
    r.data = data_.data();
    r.address = address;
    path_.submit(r, at);
    return r;
  }
  const SlowRequest& slowest(Master m) { return path_.xbar.latencies[index(m)].slowest_read; }

  mem::DdrConfig config_;
  Path path_;
  std::deque<PathRequest> requests_;
  std::array<std::uint8_t, 64> data_{};
};

// At the port 0; through the bridge at edge 3 = 24 ns, at the controller at 32 ns; its clock 9 sees it, and 8
// more clocks on, at 68 ns, the scheduler does. ACT then, RD 5 clocks later at 88 ns; the first 8 bytes come 9
// clocks on, 124 ns, at crossbar edge 16 = 128 ns; 2 edges back.
TEST_F(SdramTest, AReadOfAClosedBank) {
  read(kEngine, 0, 3 * kRow + 5 * kBank + 64);
  path_.drain();
  const SlowRequest& s = slowest(kEngine);
  EXPECT_EQ(s.found, FoundRow::kClosed);
  EXPECT_EQ(s.row, 3u);
  EXPECT_EQ(s.bank, 5u);
  EXPECT_EQ(s.steps, steps(0, {{Place::kPort, Culprit::kBridge, 24'000},
                               {Place::kCrossbar, Culprit::kService, 32'000},
                               {Place::kController, Culprit::kService, 68'000},
                               {Place::kController, Culprit::kRowMiss, 88'000},
                               {Place::kReturn, Culprit::kService, 128'000},
                               {Place::kReturn, Culprit::kBridge, 144'000}}));
}

// The same behind another row of its bank: PRE at 68 ns, tRP of 5 clocks, ACT at 88 ns, tRCD of 5 clocks, RD at
// 108 ns; data at 144 ns, which the edge after it, 152 ns, takes. Each command has a step of its own. Two clocks
// more of tRP are 8 ns more of the first one, and of all.
TEST_F(SdramTest, ARowConflictTakesWhatTheTimingSays) {
  for (const unsigned more : {0u, 2u}) {
    const Picoseconds start = 10'000'000 + more * 10'000'000, t = more * 4'000;
    config_.timing.nRP = 5 + more;
    path_.ddr.configure(config_, start - 9'000'000);
    read(kDisplay, start - 8'000'000, 7 * kRow);
    path_.drain();
    read(kEngine, start, 9 * kRow);
    path_.drain();
    const SlowRequest& s = slowest(kEngine);
    EXPECT_EQ(s.found, FoundRow::kOther);
    EXPECT_EQ(s.latency, 168'000 + t);
    EXPECT_EQ(s.steps, steps(start, {{Place::kPort, Culprit::kBridge, 24'000},
                                     {Place::kCrossbar, Culprit::kService, 32'000},
                                     {Place::kController, Culprit::kService, 68'000},
                                     {Place::kController, Culprit::kRowConflict, 88'000 + t},
                                     {Place::kController, Culprit::kRowConflict, 108'000 + t},
                                     {Place::kReturn, Culprit::kService, 152'000 + t},
                                     {Place::kReturn, Culprit::kBridge, 168'000 + t}}));
  }
}

// The camera's read goes first through the crossbar, 24 to 32 ns, and its two column commands stand before the
// engine's: at 68 and 84 ns, so that the engine's is at 100 ns, and not at 76.
TEST_F(SdramTest, BehindAnotherMasterInCrossbarAndController) {
  read(kDisplay, 1'000'000, 0);
  path_.drain();
  path_.xbar.set_priority(kCamera, 0);
  const Picoseconds start = 5'000'000 / 8'000 * 8'000;
  read(kCamera, start, 64);
  read(kEngine, start, 128);
  path_.drain();
  const SlowRequest& s = slowest(kEngine);
  EXPECT_EQ(s.found, FoundRow::kOpen);
  EXPECT_EQ(s.steps, steps(start, {{Place::kPort, Culprit::kBridge, 24'000},
                                   {Place::kCrossbar, culprit(kCamera), 32'000},
                                   {Place::kCrossbar, Culprit::kService, 40'000},
                                   {Place::kController, Culprit::kService, 76'000},
                                   {Place::kController, culprit(kCamera), 100'000},
                                   {Place::kReturn, Culprit::kService, 144'000},
                                   {Place::kReturn, Culprit::kBridge, 160'000}}));
}

/// A request with its own sums, which the crossbar and the controller fill in as they go.
struct Summed {
  PathRequest request;
  RequestWaits parts;
  std::array<std::uint8_t, 64> data;
};

/// The slowest of a master and direction, found by looking at all.
const Summed* slowest_of(const std::deque<Summed>& sent, Master m, bool write) {
  const Summed* out = nullptr;
  const auto time = [](const Summed& s) {
    return (s.request.write ? s.request.last : s.request.first) - s.request.issued;
  };
  for (const Summed& s : sent)
    if (s.request.master == m && s.request.write == write && (!out || time(s) > time(*out))) out = &s;
  return out;
}

class LoadTest : public testing::TestWithParam<const char*> {};

std::ptrdiff_t outstanding(const std::deque<Summed>& sent, Master m) {
  return std::count_if(sent.begin(), sent.end(),
                       [m](const Summed& s) { return s.request.master == m && s.request.responses == 0; });
}

// Eight outstanding requests of each of five masters: most waits are remembered whole, of starved ports not all.
TEST_P(LoadTest, TheStepsAddUpToTheSumsOfTheSlowestRequest) {
  constexpr Master kMasters[] = {kCamera, kDisplay, Master::kArmD, Master::kEdmaTc1Write, Master::kLoad};
  constexpr std::ptrdiff_t kMostOutstanding = 8;
  unsigned compared = 0, conflicts = 0;
  Picoseconds not_known = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Rng rng(seed);
    Path path(Frequency(250'000'000), Frequency(125'000'000), GetParam());
    for (const Master m : kMasters) path.xbar.set_priority(m, static_cast<unsigned>(rng.below(8)));
    std::deque<Summed> sent;
    Picoseconds at = 1'000;
    const std::uint64_t pause = 30'000 + rng.below(120'000);
    for (int n = 0; n < 600; ++n) {
      at += rng.below(pause);
      const Master m = kMasters[rng.below(std::size(kMasters))];
      path.run_before(at);
      for (; outstanding(sent, m) == kMostOutstanding; path.step()) at = std::max(at, path.next_decision() + 1);
      Summed& s = sent.emplace_back();
      PathRequest& r = s.request;
      r.data = s.data.data();
      r.parts = &s.parts;
      r.master = m;
      r.write = rng.below(2);
      r.bytes = static_cast<std::uint8_t>(8u << rng.below(4));
      r.address = static_cast<std::uint32_t>(rng.below(1u << 19) * 64);
      path.submit(r, at);
    }
    path.drain();
    for (const Master m : kMasters)
      for (const bool write : {false, true}) {
        const Summed* expected = slowest_of(sent, m, write);
        const SlowRequest& s =
            write ? path.xbar.latencies[index(m)].slowest_write : path.xbar.latencies[index(m)].slowest_read;
        ASSERT_TRUE(expected);
        EXPECT_EQ(s.issued, expected->request.issued);
        EXPECT_EQ(s.address, expected->request.address);
        EXPECT_EQ(s.end(), write ? expected->request.last : expected->request.first);
        Waits sums;
        Picoseconds from = s.issued, forgotten = 0;
        for (const RequestStep& step : s.steps) {
          EXPECT_EQ(step.from, from);
          EXPECT_LT(step.from, step.to);
          from = step.to;
          step.culprit == Culprit::kCount ? forgotten += step.to - step.from
                                          : (sums.add(step.culprit, step.to - step.from), 0);
        }
        EXPECT_EQ(from, s.end());
        EXPECT_EQ(expected->parts.total(), s.latency);
        all += s.latency;
        not_known += forgotten;
        conflicts += s.found == FoundRow::kOther;
        if (forgotten) continue;
        ++compared;
        for (std::size_t c = 0; c < kCulprits; ++c)
          EXPECT_EQ(sums.ps[c], expected->parts.ps(static_cast<Culprit>(c)))
              << "seed " << seed << " " << master_info(m).name << (write ? " write " : " read ") << kCulpritNames[c];
      }
  }
  EXPECT_GE(compared, 90u) << "of 120";
  EXPECT_LT(not_known * 10, all);
  EXPECT_GT(conflicts, 5u);
}
INSTANTIATE_TEST_SUITE_P(Schedulers, LoadTest, testing::Values("ti", "frfcfs", "closed_page", "fcfs"));

}  // namespace
}  // namespace fovea::dram
