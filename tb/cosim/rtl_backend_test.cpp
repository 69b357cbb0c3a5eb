// The verilated RTL as a backend, on a memory of which all times are known: pictures, errors, clocking, start values,
// waveforms; and beside its transaction-level model, in both roles.
#include "model/engine/rtl/rtl_backend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "model/engine/rtl/pair_backend.h"
#include "model/common/check.h"
#include "tb/engine/model_bench.h"
#include "tb/rtl/engine_bench.h"
#include "tb/rtl/random_jobs.h"

namespace fovea::rtl {
namespace {

using engine::EngineBackend;
using engine::ModelBench;

constexpr std::uint32_t kWord = ModelBench::kBase / 4;
constexpr std::uint32_t kMap = 0x20'0000, kTarget = 0x40'0000, kSize = 0x60'0000, kBorder = 0x10801080;
constexpr std::uint32_t kUntouched = 0x5A5A5A5A;

/// A bench with the RTL, or with a pair.
struct Bench : ModelBench {
  using Memory = ModelBench::Memory;
  explicit Bench(const RtlBackend::Options& options = {})
      : ModelBench(kSize, [&](const Clock& c, EngineBackend::Host& h) {
          return std::make_unique<RtlBackend>(h, c, options);
        }) {}
  explicit Bench(bool rtl_owns)
      : ModelBench(kSize, [&](const Clock& c, EngineBackend::Host& h) {
          const PairBackend::Maker as_rtl = [&c](EngineBackend::Host& x) { return std::make_unique<RtlBackend>(x, c); };
          const PairBackend::Maker as_tlm = [&c](EngineBackend::Host& x) { return ModelBench::tlm(c, x); };
          return std::make_unique<PairBackend>(h, c, rtl_owns ? as_rtl : as_tlm, rtl_owns ? as_tlm : as_rtl,
                                               [this](const std::string& text, Picoseconds) {
                                                 differences.push_back(text);
                                               });
        }) {}
  void fill(MappedJob& m, Dice& dice) {
    m.job.src_base = kWord;
    m.job.dst_base = kWord + kTarget / 4;
    for (std::uint32_t n = kTarget / 4; n < kSize / 4; ++n) word(kWord + n) = kUntouched;
    for (std::uint32_t n = 0; n < m.job.src_pitch * m.job.src_height; ++n) word(kWord + n) = dice.word();
    for (std::size_t n = 0; n < m.map.size(); ++n) word(kWord + kMap / 4 + static_cast<std::uint32_t>(n)) = m.map[n];
  }
  std::uint32_t make(const MappedJob& m, Memory how, std::optional<unsigned> abort_after = {}) {
    return run(m.job, kBase + kMap, kBorder, how, abort_after);
  }
  /// Whether the result is the golden picture, and nothing beside it was written.
  bool right(const MappedJob& m) {
    const auto want = picture(m.job, m.map, kBorder, [&](std::uint32_t at) { return word(at); });
    for (unsigned j = 0; j < m.job.rows; ++j)
      for (unsigned i = 0; i < m.job.pairs; ++i) {
        std::uint32_t& got = word(m.job.dst_base + j * m.job.dst_pitch + i);
        if (got != want[std::size_t{j} * m.job.pairs + i]) return false;
        got = kUntouched;
      }
    for (std::uint32_t n = kTarget / 4; n < kSize / 4; ++n)
      if (word(kWord + n) != kUntouched) return false;
    return true;
  }
  RtlBackend* const rtl = dynamic_cast<RtlBackend*>(&backend);
  PairBackend* const pair = dynamic_cast<PairBackend*>(&backend);
  std::vector<std::string> differences;
};

MappedJob some_job(Dice& dice, unsigned n) {
  MappedJob m = random_job(dice, static_cast<Mode>(n % 4));
  m.job.dst_pitch = m.job.pairs + dice.to(20);
  return m;
}

/// A job of 40 by 20 pairs by a table.
MappedJob table_of(Dice& dice) {
  MappedJob m;
  m.job.pairs = m.job.dst_pitch = 40;
  m.job.rows = 20;
  m.job.src_pitch = 40;
  m.job.src_width = 80;
  m.job.src_height = 20;
  m.map.resize(800);
  for (auto& entry : m.map) entry = 4 * dice.to(799);
  return m;
}

TEST(RtlBackendTest, RandomJobsMakeTheGoldenPictureAndWithOtherStartValuesTheSameRequestsAtTheSameTimes) {
  Dice dice(seed());
  Bench bench, other(RtlBackend::Options{.random_start = 5});
  for (unsigned n = 0; n < 24; ++n) {
    MappedJob m = some_job(dice, n);
    const std::uint32_t fill = dice.word();
    const ModelBench::Memory how{.latency = 1 + dice.to(60)};
    for (Bench* b : {&bench, &other}) {
      Dice same(fill);
      b->fill(m, same);
      ASSERT_EQ(b->make(m, how), engine::kDone) << n;
      ASSERT_TRUE(b->right(m)) << n;
    }
    ASSERT_EQ(bench.asked, other.asked) << n;
    for (std::size_t k = 0; k < bench.asked.size(); ++k) ASSERT_EQ(bench.asked[k].at, other.asked[k].at);
  }
}

TEST(RtlBackendTest, IsClockedOnlyWhileThereIsSomethingToDo) {
  Dice dice(3);
  Bench bench;
  MappedJob m = table_of(dice);
  bench.fill(m, dice);
  bench.make(m, {});
  const std::uint64_t before = bench.rtl->clocks();
  bench.advance(1'000'000);
  EXPECT_LE(bench.rtl->clocks(), before + 2);  // the end of the last read
  EXPECT_FALSE(bench.rtl->busy());
  // A write and its answer, and a read, whose data are taken at the edge after.
  const std::uint64_t quiet = bench.rtl->clocks();
  bench.set(bench.regs.border, 7);
  bench.advance(100);
  EXPECT_EQ(bench.rtl->clocks() - quiet, 2u);
  EXPECT_EQ(bench.get(bench.regs.border), 7u);
  EXPECT_EQ(bench.rtl->clocks() - quiet, 3u);
  bench.advance(100);
  EXPECT_EQ(bench.rtl->clocks() - quiet, 4u);
}

TEST(RtlBackendTest, ErrorsAbortsAndAResetInMidFrameRecover) {
  Dice dice(seed() + 1);
  Bench bench;
  for (unsigned n = 0; n < 12; ++n) {
    MappedJob m = table_of(dice);
    bench.fill(m, dice);
    ModelBench::Memory how{.latency = 1 + dice.to(30)};
    std::optional<unsigned> abort_after;
    std::uint32_t expected = 0;
    switch (n % 3) {
      case 0:
        how.read_fault = ModelBench::kBase + (n % 2 ? kMap + 64 * dice.to(49) : m.map[dice.to(799)]);
        expected = engine::kReadError;
        break;
      case 1:
        how.write_fault = ModelBench::kBase + kTarget + 160 * dice.to(19);
        expected = engine::kWriteError;
        break;
      case 2:
        abort_after = 20 + dice.to(600);
        expected = engine::kAborted;
        break;
    }
    EXPECT_EQ(bench.make(m, how, abort_after), expected) << n;
    bench.fill(m, dice);
    ASSERT_EQ(bench.make(m, {}), engine::kDone) << n;
    ASSERT_TRUE(bench.right(m)) << n;
  }
}

TEST(RtlBackendTest, AResetInMidFrameForgetsTheJobAndEverythingElse) {
  Dice dice(seed() + 2);
  struct Deaf : EngineBackend::Host {
    void issue(const engine::Burst& b, Picoseconds) override { tags.push_back(b.tag); }
    void interrupt(bool level) override { line = level; }
    std::vector<std::uint64_t> tags;
    bool line = false;
  } host;
  const Clock clock{Frequency(1'000'000'000)};
  RtlBackend rtl(host, clock);
  const auto set = [&](std::uint32_t offset, std::uint32_t word, Picoseconds t) {
    rtl.run(t);
    rtl.write(offset, word, 15, t);
    rtl.run(t);
  };
  set(0x44, 40 | 20 << 16, 10'000);  // an impossible job: the source has no size
  set(0x10, 2, 20'000);
  set(0x04, 1, 30'000);
  set(0x14, 9, 40'000);
  rtl.run(60'000);
  EXPECT_TRUE(host.line);
  EXPECT_EQ(rtl.read(0x18, 61'000), 0x0001'0209u);
  rtl.reset();
  EXPECT_FALSE(host.line);
  for (const std::uint32_t offset : {0x04u, 0x0Cu, 0x10u, 0x18u, 0x44u})
    EXPECT_EQ(rtl.read(offset, 90'000), 0u) << offset;
  EXPECT_EQ(rtl.read(0, 95'000), engine::kIdentity);
  // And with reads under way.
  set(0x50, 80 | 20 << 16, 100'000);
  set(0x44, 40 | 20 << 16, 100'000);
  set(0x4C, 160, 100'000);
  set(0x60, 800, 100'000);
  set(0x04, 1, 100'000);
  set(0x14, 1, 200'000);
  rtl.run(260'000);
  ASSERT_FALSE(host.tags.empty());
  rtl.reset();
  EXPECT_FALSE(rtl.busy());
  EXPECT_EQ(rtl.read(0x08, 300'000), 0u);
}

/// Times and length of an FST file: bytes 9 to 24 of its header, big-endian (GTKWave, fstapi.c).
std::pair<std::uint64_t, std::uint64_t> times_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<unsigned char, 25> head{};
  in.read(reinterpret_cast<char*>(head.data()), head.size());
  std::uint64_t t[2] = {};
  for (unsigned n = 0; n < 16; ++n) t[n / 8] = t[n / 8] << 8 | head[9 + n];
  return {t[0], t[1]};
}

TEST(RtlBackendTest, WaveformsBeginAtTheirTriggerAndHaveTheirLength) {
  const auto file = std::filesystem::temp_directory_path() / ("fovea_waves_" + std::to_string(::getpid()) + ".fst");
  Dice dice(4);
  MappedJob m = table_of(dice);
  Waves waves{.file = file, .trigger = Waves::Trigger::kJob, .skip = 1, .length = 50'500};
  Picoseconds second = 0;
  {
    Bench bench(RtlBackend::Options{.waves = waves});
    bench.fill(m, dice);
    bench.make(m, {});
    second = bench.asked.back().at;
    bench.make(m, {});
    bench.rtl->finish();
    second = bench.asked.front().at;  // the first read is asked for 3 edges behind the one that takes SUBMIT
  }
  const auto [from, to] = times_of(file);
  EXPECT_LT(from, second);
  EXPECT_GT(from + 10'000, second);
  EXPECT_EQ(to, from + 50'500);  // the falling edge
  waves.trigger = Waves::Trigger::kError;
  waves.skip = 0;
  {
    Bench bench(RtlBackend::Options{.waves = waves});
    bench.fill(m, dice);
    bench.make(m, {});
    bench.rtl->finish();
  }
  EXPECT_EQ(times_of(file).first, times_of(file).second);  // nothing recorded
  // From the edge of the job's own begin on, and from a picosecond later.
  waves.trigger = Waves::Trigger::kJob;
  const auto first_from = [&](Picoseconds at) {
    waves.from = at;
    {
      Bench bench(RtlBackend::Options{.waves = waves});
      bench.fill(m, dice);
      bench.make(m, {});
      bench.rtl->finish();
    }
    return times_of(file);
  };
  const Picoseconds begin = first_from(0).first;
  EXPECT_EQ(first_from(begin).first, begin);
  const auto [late, over] = first_from(begin + 1);
  EXPECT_EQ(late, over);  // nothing recorded
  waves.from = 0;
  std::ofstream(file) << "something else";
  waves.file = file;
  EXPECT_THROW(Bench(RtlBackend::Options{.waves = waves}), UserError);
  std::filesystem::remove(file);
  waves.file = "/nowhere/waves.fst";
  EXPECT_THROW(Bench(RtlBackend::Options{.waves = waves}), UserError);
}

TEST(RtlBackendTest, TheModelBesideItAsksForTheSameInBothRoles) {
  Dice dice(seed() + 4);
  for (const bool rtl_owns : {true, false}) {
    Bench bench(rtl_owns);
    for (unsigned n = 0; n < 24; ++n) {
      MappedJob m = some_job(dice, n);
      bench.fill(m, dice);
      ASSERT_EQ(bench.make(m, {.latency = 1 + dice.to(60)}), engine::kDone) << n;
      ASSERT_TRUE(bench.right(m)) << n;
      ASSERT_TRUE(bench.differences.empty()) << bench.differences[0] << ", job " << n;
    }
    std::uint64_t all = 0, same = 0;
    for (const auto& [lag, count] : bench.pair->summary().lag) {
      all += count;
      if (lag == 0) same += count;
    }
    EXPECT_EQ(all, bench.pair->summary().requests);
    std::printf("%s owns the port: %llu requests, %.1f %% in the same clock\n", rtl_owns ? "RTL" : "model",
                static_cast<unsigned long long>(all), 100.0 * static_cast<double>(same) / static_cast<double>(all));
    // Errors and aborts are no difference, and behind them the comparison goes on.
    for (unsigned n = 0; n < 6; ++n) {
      MappedJob m = table_of(dice);
      bench.fill(m, dice);
      if (n % 2) bench.make(m, {}, 100 + dice.to(500));
      else bench.make(m, {.read_fault = ModelBench::kBase + m.map[dice.to(799)]});
      bench.fill(m, dice);
      const std::uint64_t before = bench.pair->summary().requests;
      ASSERT_EQ(bench.make(m, {}), engine::kDone) << n;
      ASSERT_TRUE(bench.right(m)) << n;
      EXPECT_GT(bench.pair->summary().requests, before);
      ASSERT_TRUE(bench.differences.empty()) << bench.differences[0] << ", job " << n;
    }
  }
}

/// Reads with their times, of three jobs: one is submitted and then enabled, one is submitted behind it while it is at
/// work, and one later to the idle engine. The bench's memory answers the RTL and the model after the same times.
std::vector<std::pair<std::uint32_t, Picoseconds>> reads_of_three_jobs(ModelBench& b, const MappedJob& m) {
  b.asked.clear();
  b.window(m.job, ModelBench::kBase + kMap, static_cast<std::uint32_t>(map_words(m.job)), kBorder);
  b.advance(200);  // a write of the RTL's registers takes more than a clock
  b.set(b.regs.submit, 1);
  b.advance(30);
  b.set(b.regs.ctrl, 1);
  b.advance(40);
  b.set(b.regs.submit, 2);
  b.finish();
  b.advance(5);
  b.set(b.regs.submit, 3);
  b.finish();
  b.advance(1);
  EXPECT_EQ(b.get(b.regs.ended) >> 16, 3u);
  b.set(b.regs.ctrl, 0);
  std::vector<std::pair<std::uint32_t, Picoseconds>> out;
  for (const auto& a : b.asked)
    if (!a.write) out.emplace_back(a.address, a.at);
  return out;
}

TEST(RtlBackendTest, TheModelBeginsEachJobInTheSameClock) {
  for (const unsigned latency : {1u, 8u, 40u}) {
    Dice dice(seed() + latency);
    Bench rtl;
    ModelBench model(kSize);
    MappedJob m = table_of(dice);
    rtl.fill(m, dice);
    for (std::uint32_t n = 0; n < kSize / 4; ++n) model.word(kWord + n) = rtl.word(kWord + n);
    rtl.memory.latency = model.memory.latency = latency;
    const auto asked = reads_of_three_jobs(rtl, m);
    EXPECT_GT(asked.size(), 3u * 50);  // 800 entries in bursts of 64 bytes
    EXPECT_EQ(reads_of_three_jobs(model, m), asked) << "latency " << latency;
  }
}

/// What adapters and checkers cost: the same job on the bench of tb/rtl and as a backend.
struct CostTest : testing::Test {
  Bench backend;
  EngineBench plain{kSize};
  MappedJob m;
  CostTest() {
    Dice dice(6);
    m.job.pairs = m.job.dst_pitch = m.job.src_pitch = 360;
    m.job.rows = m.job.src_height = 100;
    m.job.src_width = 720;
    for (unsigned n = 0; n < 36'000; ++n) m.map.push_back(4 * n);
    backend.fill(m, dice);
    for (std::uint32_t n = 0; n < kSize / 4; ++n) plain.word(kWord + n) = backend.word(kWord + n);
  }
  unsigned on_bench() { return plain.run(m.job, EngineBench::kBase + kMap, kBorder, {.latency = 24}).clocks; }
  unsigned as_backend() {
    EXPECT_EQ(backend.make(m, {.latency = 24}), engine::kDone);
    return backend.get(backend.regs.clocks);
  }
};

TEST_F(CostTest, PrintsItsSpeedBesideThatOfABenchWithoutAdapters) {
  const auto rate = [](auto&& work) {
    const auto begin = std::chrono::steady_clock::now();
    const unsigned clocks = work();
    return clocks / std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  const double bench = rate([&] { return on_bench(); }), adapted = rate([&] { return as_backend(); });
  std::printf("%.0f clocks/s on the bench of tb/rtl, %.0f as a backend\n", bench, adapted);
  EXPECT_TRUE(backend.right(m));
}
// For instructions.sh.
TEST_F(CostTest, Bench) { std::printf("clocks: %u\n", on_bench()); }
TEST_F(CostTest, Backend) { std::printf("clocks: %u\n", as_backend()); }

}  // namespace
}  // namespace fovea::rtl
