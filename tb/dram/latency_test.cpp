// Latencies of SDRAM requests to the first and the last beat: computed by hand at the crossbar, and
// against lists of all requests under load.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <vector>

#include "model/bus/core/latency_stats.h"
#include "tb/dram/bench.h"
#include "tb/dram/path.h"
#include "tb/dram/xbar_bench.h"

namespace fovea::dram {
namespace {

using bus::LatencyHistogram;
constexpr Master kA = Master::kVpfe, kB = Master::kVpbe;

void expect_only(const LatencyHistogram& h, std::vector<Picoseconds> latencies) {
  std::sort(latencies.begin(), latencies.end());
  ASSERT_EQ(h.count(), latencies.size());
  if (latencies.empty()) return;
  EXPECT_EQ(h.min(), latencies.front());
  EXPECT_EQ(h.max(), latencies.back());
  double sum = 0;
  for (const Picoseconds t : latencies) sum += static_cast<double>(t);
  EXPECT_EQ(h.mean(), sum / static_cast<double>(latencies.size()));
  for (const double q : {0.01, 0.5, 0.95, 0.99, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(latencies.size())));
    const Picoseconds exact = latencies[rank - 1];
    EXPECT_GE(h.quantile(q), exact) << q;
    EXPECT_LE(static_cast<double>(h.quantile(q)), static_cast<double>(exact) * (1 + 1.0 / 256)) << q;
  }
  std::uint64_t in_bins = 0;
  Picoseconds end = 0;
  h.each_bin([&](Picoseconds low, Picoseconds high, std::uint64_t count) {
    EXPECT_LE(end, low);
    EXPECT_LT(low, high);
    end = high;
    in_bins += count;
    EXPECT_EQ(count, static_cast<std::uint64_t>(
                         std::lower_bound(latencies.begin(), latencies.end(), high) -
                         std::lower_bound(latencies.begin(), latencies.end(), low)))
        << low;
  });
  EXPECT_EQ(in_bins, latencies.size());
}

// Two ports of one master have one histogram: either may hold the least and the greatest, or nothing.
TEST(LatencyTest, HistogramsAddUp) {
  const std::vector<std::vector<Picoseconds>> parts[] = {
      {{}, {}}, {{}, {70}}, {{70}, {}}, {{100, 900'000}, {50, 300}}, {{50, 300}, {100, 900'000}}};
  for (const auto& p : parts) {
    LatencyHistogram a, b;
    for (const Picoseconds t : p[0]) a.add(t);
    for (const Picoseconds t : p[1]) b.add(t);
    a.add(b);
    std::vector<Picoseconds> all = p[0];
    all.insert(all.end(), p[1].begin(), p[1].end());
    expect_only(a, all);
  }
}

// Bridges of 2 edges each way, 64-bit ports. A's and B's writes of 8 words lie on their ports at edge 5
// and are through the bridges at 8. A is more urgent: its words are taken at 8 to 15, it is acknowledged
// at 16 + 2; B's are taken from 16 on and acknowledged at 26.
TEST(LatencyTest, WriteIsFromTheRequestToTheFirstWordTakenAndToTheAcknowledgement) {
  XbarBench b;
  b.xbar.set_priority(kA, 0);
  b.submit(kA, 5, true, 64);
  b.submit(kB, 5, true, 64);
  b.run();
  expect_only(b.xbar.latencies[index(kA)].write.first, {3 * kEdge});
  expect_only(b.xbar.latencies[index(kA)].write.last, {13 * kEdge});
  expect_only(b.xbar.latencies[index(kB)].write.first, {11 * kEdge});
  expect_only(b.xbar.latencies[index(kB)].write.last, {21 * kEdge});
  expect_only(b.xbar.latencies[index(kA)].read.first, {});
}

// The same write, whose slave has room for it only at edge 30: acknowledged at 31 + 2.
TEST(LatencyTest, WriteThatWaitsForRoomHasItsFirstBeatAtTheGrant) {
  XbarBench b;
  b.ddr_accepts = false;
  b.submit(kA, 5, true, 64);
  b.run();
  b.xbar.slave_accepted(b, *b.sent.at(0), 30 * kEdge, kB);
  expect_only(b.xbar.latencies[index(kA)].write.first, {3 * kEdge});
  expect_only(b.xbar.latencies[index(kA)].write.last, {28 * kEdge});
}

// Data on the crossbar from edge 30 to 37, on the port 2 later. Register accesses do not count.
TEST(LatencyTest, ReadIsFromTheRequestToTheFirstAndTheLastBeatAtThePort) {
  XbarBench b;
  b.submit(kA, 5, false, 64);
  b.submit(kB, 5, false, 8, Slave::kConfig);
  b.run();
  for (MemRequest* r : b.sent) b.xbar.slave_done(b, *r, {30 * kEdge, 37 * kEdge});
  expect_only(b.xbar.latencies[index(kA)].read.first, {27 * kEdge});
  expect_only(b.xbar.latencies[index(kA)].read.last, {34 * kEdge});
  expect_only(b.xbar.latencies[index(kA)].write.last, {});
  expect_only(b.xbar.latencies[index(kB)].read.first, {});
}

// An unloaded read of 32 bytes, as PathTest.UnloadedReadLatency has it: 18 and 21 edges of 8 ns.
TEST(LatencyTest, ReadAloneTakesItsUnloadedTime) {
  Path path;
  std::array<std::uint8_t, 32> data;
  PathRequest r;
  r.master = Master::kRemapEngine;
  r.bytes = 32;
  r.data = data.data();
  path.submit(r, 0);
  path.drain();
  const bus::PortLatencies& l = path.xbar.latencies[index(r.master)];
  expect_only(l.read.first, {144'000});
  expect_only(l.read.last, {168'000});
}

// The whole path under load, against the list of all requests.
TEST(LatencyTest, HistogramsHoldEveryRequest) {
  Rng rng(11);
  Path path;
  struct Sent {
    PathRequest request;
    std::array<std::uint8_t, 64> data;
  };
  std::deque<Sent> sent;
  Picoseconds at = 1'000;
  constexpr Master kMasters[] = {kA, kB, Master::kArmD, Master::kLoad};
  for (int n = 0; n < 4000; ++n) {
    at += rng.below(120'000);
    Sent& s = sent.emplace_back();
    s.request.data = s.data.data();
    s.request.master = kMasters[rng.below(4)];
    s.request.write = rng.below(2);
    s.request.bytes = static_cast<std::uint8_t>(8u << rng.below(4));
    s.request.address = static_cast<std::uint32_t>(rng.below(1u << 19) * 64);
    path.run_before(at);
    path.submit(s.request, at);
  }
  path.drain();
  for (const Master m : kMasters) {
    std::vector<Picoseconds> first, last, acknowledged;
    for (const Sent& s : sent) {
      if (s.request.master != m) continue;
      const Picoseconds to_end = s.request.last - s.request.issued;
      if (!s.request.write) first.push_back(s.request.first - s.request.issued);
      (s.request.write ? acknowledged : last).push_back(to_end);
    }
    ASSERT_GT(first.size(), 300u);
    const bus::PortLatencies& l = path.xbar.latencies[index(m)];
    expect_only(l.read.first, first);
    expect_only(l.read.last, last);
    expect_only(l.write.last, acknowledged);
    EXPECT_EQ(l.write.first.count(), acknowledged.size());
    EXPECT_LT(l.write.first.max(), l.write.last.max());
  }
}

TEST(LatencyHistogramTest, BinsBeginAndEndWhereTheySay) {
  std::vector<Picoseconds> edges;
  for (const Picoseconds t : {15u, 16u, 511u, 512u, 513u, 543u, 544u, 1023u, 1024u, 65'535u, 65'536u})
    edges.push_back(t);
  LatencyHistogram h, other;
  for (std::size_t i = 0; i < edges.size(); ++i) (i % 2 ? h : other).add(edges[i]);
  h.add(other);
  expect_only(h, edges);
  std::vector<Picoseconds> lows;
  h.each_bin([&](Picoseconds low, Picoseconds, std::uint64_t) { lows.push_back(low); });
  EXPECT_EQ(lows, (std::vector<Picoseconds>{0, 16, 496, 512, 544, 992, 1024, 63'488, 65'536}));
  h.reset();
  expect_only(h, {});
  EXPECT_EQ(h.max(), 0u);
  EXPECT_EQ(h.quantile(0.5), 0u);
}

TEST(LatencyStatsTest, NamesSayDirectionAndBeatAndPortsAddUp) {
  bus::PortLatencies read_side, write_side;
  read_side.read.first.add(100'000);
  read_side.read.last.add(170'000);
  write_side.write.first.add(30'000);
  write_side.write.first.add(50'000);
  bus::LatencyStats stats("edma_tc0", {&read_side, &write_side});
  std::map<std::string, double> value;
  for (const StatBase* s : stats.stats()) value[s->name()] = std::get<double>(s->value());
  EXPECT_EQ(value.size(), 20u);
  EXPECT_DOUBLE_EQ(value.at("ddr.edma_tc0.latency.mean"), 100e-9);
  EXPECT_DOUBLE_EQ(value.at("ddr.edma_tc0.latency.read_last.max"), 170e-9);
  EXPECT_DOUBLE_EQ(value.at("ddr.edma_tc0.latency.write_first.mean"), 40e-9);
  EXPECT_TRUE(std::isnan(value.at("ddr.edma_tc0.latency.write_last.p99")));
  stats.reset();
  EXPECT_TRUE(std::isnan(std::get<double>(stats.stats().front()->value())));
}

}  // namespace
}  // namespace fovea::dram
