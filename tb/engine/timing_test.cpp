// The model of the remap engine beside the verilated RTL, on the same memory: requests, counters, and times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tb/engine/model_bench.h"
#include "tb/rtl/engine_bench.h"
#include "tb/rtl/random_jobs.h"

namespace fovea::engine {
namespace {

using rtl::Dice;
using rtl::EngineBench;
using rtl::MappedJob;
using rtl::Mode;

constexpr std::uint32_t kWord = ModelBench::kBase / 4;
constexpr std::uint32_t kMap = 0x20'0000, kTarget = 0x40'0000, kSize = 0x60'0000;
constexpr std::uint32_t kBorder = 0x10801080;

/// What one of both has done.
struct Trace {
  /// Identifier, address, and bytes of each, in order; of a read the clock too, from the first one on.
  std::vector<std::uint32_t> reads, writes;
  std::uint32_t clocks = 0, lines = 0, bursts = 0, bad = 0;
};

/// What differs; empty: nothing.
std::string difference(const Trace& model, const Trace& rtl) {
  const auto first = [](const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    std::size_t n = 0;
    while (n < a.size() && n < b.size() && a[n] == b[n]) ++n;
    return n;
  };
  if (model.reads != rtl.reads) return "read " + std::to_string(first(model.reads, rtl.reads) / 4) + " differs";
  if (model.writes != rtl.writes) return "write " + std::to_string(first(model.writes, rtl.writes) / 3) + " differs";
  if (model.lines != rtl.lines || model.bursts != rtl.bursts || model.bad != rtl.bad) return "a counter differs";
  if (model.clocks != rtl.clocks)
    return "clocks: " + std::to_string(model.clocks) + " and " + std::to_string(rtl.clocks);
  return "";
}

struct Pair {
  ModelBench model{kSize};
  EngineBench rtl{kSize};

  void fill(MappedJob& m, Dice& dice) {
    m.job.src_base = kWord;
    m.job.dst_base = kWord + kTarget / 4;
    const auto both = [&](std::uint32_t at, std::uint32_t value) { model.word(at) = rtl.word(at) = value; };
    for (std::uint32_t n = 0; n < m.job.src_pitch * m.job.src_height; ++n) both(kWord + n, dice.word());
    for (std::uint32_t n = 0; n < m.map.size(); ++n) both(kWord + kMap / 4 + n, m.map[n]);
  }
  Trace run_model(const MappedJob& m, unsigned latency) {
    EXPECT_EQ(model.run(m.job, ModelBench::kBase + kMap, kBorder, {.latency = latency}), kDone);
    Trace t;
    std::optional<Picoseconds> first;
    for (const auto& a : model.asked) {
      auto& list = a.write ? t.writes : t.reads;
      for (const std::uint32_t v : {std::uint32_t{a.id}, a.address, std::uint32_t{a.bytes}}) list.push_back(v);
      if (a.write) continue;
      if (!first) first = a.at;
      list.push_back(static_cast<std::uint32_t>((a.at - *first) / ModelBench::kPeriod));
    }
    t.clocks = model.get(model.regs.clocks);
    t.lines = model.get(model.regs.lines);
    t.bursts = model.get(model.regs.writes);
    t.bad = model.get(model.regs.bad);
    return t;
  }
  Trace run_rtl(const MappedJob& m, unsigned latency) {
    const rtl::Result r = rtl.run(m.job, EngineBench::kBase + kMap, kBorder, {.latency = latency});
    Trace t;
    for (std::size_t n = 0; n < rtl.reads_asked.size(); ++n) {
      const auto& a = rtl.reads_asked[n];
      const auto clock = static_cast<std::uint32_t>(rtl.read_clocks[n] - rtl.read_clocks[0]);
      for (const std::uint32_t v : {std::uint32_t{a.id}, a.address, 8 * (a.length + 1), clock}) t.reads.push_back(v);
    }
    for (const auto& a : rtl.writes_asked)
      for (const std::uint32_t v : {0u, a.address, 8 * (a.length + 1)}) t.writes.push_back(v);
    t.clocks = r.clocks;
    t.lines = r.lines;
    t.bursts = r.writes;
    t.bad = r.bad;
    return t;
  }
  bool same_picture(const MappedJob& m) {
    for (std::uint32_t n = 0; n < m.job.rows * m.job.dst_pitch; ++n)
      if (model.word(m.job.dst_base + n) != rtl.word(m.job.dst_base + n)) return false;
    return true;
  }
};

/// Widths are even and rows do not share 64 bytes unless they touch: so each burst is one request of whole beats.
TEST(TimingTest, RandomJobsAskForTheSameInTheSameClocks) {
  Dice dice(rtl::seed() + 3);
  Pair pair;
  for (unsigned n = 0; n < 80; ++n) {
    MappedJob m = rtl::random_job(dice, static_cast<Mode>(n % 4));
    if (m.job.pairs % 2) continue;
    m.job.dst_pitch = m.job.pairs + (dice.to(1) ? 0 : 16 + 2 * dice.to(10));
    pair.fill(m, dice);
    const unsigned latency = 1 + dice.to(60);
    const Trace rtl = pair.run_rtl(m, latency), model = pair.run_model(m, latency);
    EXPECT_EQ(difference(model, rtl), "") << "job " << n << ", mode " << n % 4;
    EXPECT_TRUE(pair.same_picture(m));
  }
}

/// The firmware's lens in three modes, on quick and slow memories.
TEST(TimingTest, LensesTakeTheSameTime) {
  Dice dice(rtl::seed());
  Pair pair;
  lens_view_t view;
  lens_view_default(&view);
  lens_t lens;
  ASSERT_EQ(lens_init(&lens, &view, 192, 96), LENS_OK);
  for (MappedJob m : {rtl::table_job(lens), rtl::grid_job(lens, 4), rtl::radial_job(lens)})
    for (const unsigned latency : {2u, 24u, 60u})
      for (const bool bilinear : {false, true}) {
        m.job.bilinear = bilinear;
        pair.fill(m, dice);
        const Trace rtl = pair.run_rtl(m, latency), model = pair.run_model(m, latency);
        EXPECT_EQ(difference(model, rtl), "");
        EXPECT_TRUE(pair.same_picture(m));
      }
}

/// One job of the lens each, for instructions.sh.
struct CostTest : testing::Test {
  Pair pair;
  MappedJob job;
  CostTest() {
    Dice dice(1);
    lens_view_t view;
    lens_view_default(&view);
    lens_t lens;
    lens_init(&lens, &view, 192, 96);
    job = rtl::table_job(lens);
    pair.fill(job, dice);
  }
};
TEST_F(CostTest, Model) { EXPECT_GT(pair.run_model(job, 24).clocks, 0u); }
TEST_F(CostTest, Rtl) { EXPECT_GT(pair.run_rtl(job, 24).clocks, 0u); }

TEST(TimingTest, TheComparisonComplains) {
  const Trace t{{1, 64, 32, 0, 0, 128, 64, 7}, {0, 256, 64}, 1000, 1, 1, 0};
  EXPECT_EQ(difference(t, t), "");
  Trace other = t;
  other.reads[5] += 64;
  EXPECT_EQ(difference(other, t), "read 1 differs");
  other = t;
  ++other.reads[7];  // a clock later
  EXPECT_EQ(difference(other, t), "read 1 differs");
  other = t;
  other.reads.resize(4);
  EXPECT_EQ(difference(other, t), "read 1 differs");
  other = t;
  other.writes[2] = 32;
  EXPECT_EQ(difference(other, t), "write 0 differs");
  other = t;
  ++other.bad;
  EXPECT_EQ(difference(other, t), "a counter differs");
  other = t;
  ++other.clocks;
  EXPECT_EQ(difference(other, t), "clocks: 1001 and 1000");
}

}  // namespace
}  // namespace fovea::engine
