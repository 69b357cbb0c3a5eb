// The model of the remap engine against tb/rtl's golden model, on memories of different latency: pictures bit by bit,
// errors, ends before time; registers, queue and events.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tb/engine/model_bench.h"
#include "tb/rtl/lens_maps.h"
#include "tb/rtl/random_jobs.h"

namespace fovea::engine {
namespace {

using rtl::Dice;
using rtl::MappedJob;
using rtl::Mode;

constexpr std::uint32_t kWord = ModelBench::kBase / 4;
constexpr std::uint32_t kMap = 0x20'0000, kTarget = 0x40'0000, kSize = 0x60'0000;
constexpr std::uint32_t kUntouched = 0x5A5A5A5A, kBorder = 0x10801080;

void fill(ModelBench& bench, const MappedJob& m, Dice& dice) {
  for (std::uint32_t n = 0; n < kSize / 4; ++n) bench.word(kWord + n) = kUntouched;
  for (std::uint32_t n = 0; n < m.job.src_pitch * m.job.src_height; ++n) bench.word(kWord + n) = dice.word();
  for (std::size_t n = 0; n < m.map.size(); ++n)
    bench.word(kWord + kMap / 4 + static_cast<std::uint32_t>(n)) = m.map[n];
}

void place(MappedJob& m, std::uint32_t offset_words = 0) {
  m.job.src_base = kWord;
  m.job.dst_base = kWord + kTarget / 4 + offset_words;
}

std::vector<std::uint32_t> expected(ModelBench& bench, const MappedJob& m) {
  return picture(m.job, m.map, kBorder, [&](std::uint32_t at) { return bench.word(at); });
}

void expect_picture(ModelBench& bench, const MappedJob& m, const std::vector<std::uint32_t>& want) {
  for (unsigned j = 0; j < m.job.rows; ++j)
    for (unsigned i = 0; i < m.job.pairs; ++i) {
      std::uint32_t& got = bench.word(m.job.dst_base + j * m.job.dst_pitch + i);
      ASSERT_EQ(got, want[std::size_t{j} * m.job.pairs + i]) << "pair " << i << " of row " << j;
      got = kUntouched;
    }
  for (std::uint32_t n = kTarget / 4; n < kSize / 4; ++n) ASSERT_EQ(bench.word(kWord + n), kUntouched);
}

TEST(ModelTest, RandomJobsMakeTheGoldenPicture) {
  Dice dice(rtl::seed() + 7);
  ModelBench bench(kSize);
  for (unsigned n = 0; n < 80; ++n) {
    MappedJob m = rtl::random_job(dice, static_cast<Mode>(n % 4));
    place(m, dice.to(40));
    m.job.dst_pitch = m.job.pairs + dice.to(20);
    fill(bench, m, dice);
    const auto want = expected(bench, m);
    EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, {.latency = 1 + dice.to(60)}), kDone);
    expect_picture(bench, m, want);
    if (HasFatalFailure()) FAIL() << "job " << n;
    std::uint32_t bad = 0;
    for (const rtl::Beat& b : addresses(m.job, m.map)) bad += b.bad;
    EXPECT_EQ(bench.get(bench.regs.bad), bad);
  }
}

ModelBench::Maker model_with(Geometry geometry) {
  return [geometry](const Clock& clock, EngineBackend::Host& host) {
    return std::make_unique<TlmBackend>(clock, host, geometry);
  };
}

/// A lens through caches from one line to more than there are in its source.
TEST(ModelTest, EachCacheReadsTheLinesThatItMust) {
  Dice dice(rtl::seed() + 4);
  lens_view_t view;
  lens_view_default(&view);
  lens_t lens;
  ASSERT_EQ(lens_init(&lens, &view, 192, 96), LENS_OK);
  MappedJob m = rtl::grid_job(lens, 4);
  place(m);
  const auto beats = addresses(m.job, m.map);
  std::size_t before = ~std::size_t{0};
  for (const unsigned log_lines : {0u, 1u, 2u, 3u, 5u, 8u, 12u}) {
    ModelBench bench(kSize, model_with({.log_lines = log_lines}));
    fill(bench, m, dice);
    const auto want = expected(bench, m);
    EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, {}), kDone);
    expect_picture(bench, m, want);
    const std::size_t lines = bench.get(bench.regs.lines);
    EXPECT_EQ(lines, lines_read(beats, log_lines)) << log_lines;
    // Nothing is left of a job.
    EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, {}), kDone);
    EXPECT_EQ(bench.get(bench.regs.lines), lines) << log_lines;
    EXPECT_LE(lines, before);
    before = lines;
  }
  EXPECT_EQ(before, lines_needed(beats));
}

/// A line is asked for only while fewer are under way than `prefetch`.
TEST(ModelTest, PrefetchLimitsTheLinesUnderWay) {
  Dice dice(rtl::seed() + 5);
  constexpr unsigned kLatency = 40;
  MappedJob m = rtl::random_job(dice, Mode::kProject);
  m.job.src_width = m.job.src_height = 512;
  m.job.src_pitch = 256;
  m.job.bilinear = false;
  m.job.pairs = 128;
  m.job.rows = 2;
  for (auto* form : {m.job.a, m.job.b, m.job.c})
    for (unsigned n = 0; n < 3; ++n) form[n] = 0;
  m.job.a[1] = 2 << 8;  // row after row, from the first pixel on
  m.job.b[2] = 1 << 8;
  m.job.c[0] = 1 << 8;
  place(m);
  for (const unsigned prefetch : {1u, 3u, 8u}) {
    ModelBench bench(kSize, model_with({.prefetch = prefetch}));
    fill(bench, m, dice);
    EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, {.latency = kLatency}), kDone);
    std::vector<Picoseconds> reads;
    for (const auto& a : bench.asked)
      if (!a.write) reads.push_back(a.at / ModelBench::kPeriod);
    ASSERT_EQ(reads.size(), 2u * 128 / 8);
    // A request's last data come `latency` + 3 clocks after it, and its place is free then; the next `prefetch`
    // requests are no earlier. With eight the 32 accesses that wait bind before: they are those of four lines.
    const unsigned binds = std::min(prefetch, 4u);
    unsigned most = 0;
    for (std::size_t n = 0; n < reads.size(); ++n) {
      unsigned under_way = 1;
      while (under_way <= n && reads[n] - reads[n - under_way] <= kLatency + 3) ++under_way;
      most = std::max(most, under_way);
    }
    EXPECT_EQ(most, binds) << prefetch;
  }
}

/// A table of 40 x 20 pairs within the frame.
MappedJob small_job(Dice& dice) {
  MappedJob m = rtl::random_job(dice, Mode::kTable);
  m.job.pairs = 40;
  m.job.rows = 20;
  m.job.dst_pitch = 48;
  m.map.assign(800, 0);
  for (auto& entry : m.map) entry = dice.to(m.job.src_pitch * m.job.src_height - 1) * 4;
  place(m);
  return m;
}

TEST(ModelTest, ErrorsAndAnEarlyEndAreReportedAndTheNextJobIsRight) {
  Dice dice(rtl::seed() + 8);
  ModelBench bench(kSize);
  for (unsigned n = 0; n < 24; ++n) {
    const MappedJob m = small_job(dice);
    fill(bench, m, dice);
    ModelBench::Memory memory{.latency = 1 + dice.to(40)};
    std::optional<unsigned> abort_after;
    switch (n % 4) {
      case 0:
        memory.read_fault = ModelBench::kBase + kMap + 64 * dice.to(49);
        break;
      case 1:
        memory.read_fault = ModelBench::kBase + m.map[dice.to(799)];
        break;
      case 2:
        memory.write_fault = ModelBench::kBase + kTarget + 192 * dice.to(19);
        break;
      default:
        abort_after = dice.to(700);
    }
    static constexpr std::uint32_t kWanted[] = {kReadError, kReadError, kWriteError, kAborted};
    EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, memory, abort_after), kWanted[n % 4]) << n;
    fill(bench, m, dice);
    const auto want = expected(bench, m);
    EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, {}), kDone);
    expect_picture(bench, m, want);
    if (HasFatalFailure()) FAIL() << "job " << n;
  }
}

/// Behind an error nothing new is asked for, but for what the model had asked for ahead of it.
TEST(ModelTest, AnErrorEndsAJob) {
  Dice dice(rtl::seed() + 10);
  ModelBench bench(kSize);
  const MappedJob m = small_job(dice);
  fill(bench, m, dice);
  EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, {.read_fault = ModelBench::kBase + kMap}), kReadError);
  EXPECT_LE(bench.asked.size(), kSlots);
  EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, {.write_fault = ModelBench::kBase + kTarget}),
            kWriteError);
  EXPECT_LE(bench.asked.size(), 200u);
  EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, {}), kDone);
  EXPECT_GE(bench.asked.size(), 50u + 60u);
}

/// Rows whose results lie between each other's: what is between the words of a burst stays.
TEST(ModelTest, GapsWithin64BytesAreLeftAlone) {
  Dice dice(rtl::seed() + 9);
  ModelBench bench(kSize);
  for (const unsigned pairs : {1u, 3u, 5u}) {
    MappedJob m = small_job(dice);
    m.job.pairs = pairs;
    m.job.dst_pitch = pairs + 2;
    m.map.resize(std::size_t{pairs} * m.job.rows);
    fill(bench, m, dice);
    const auto want = expected(bench, m);
    EXPECT_EQ(bench.run(m.job, ModelBench::kBase + kMap, kBorder, {}), kDone);
    expect_picture(bench, m, want);
    EXPECT_LT(bench.get(bench.regs.writes), 20u);
  }
}

TEST(ModelTest, LimitsOfJobsAreThoseOfTheDefinition) {
  const auto events = [](auto change) {
    rtl::Job job;
    job.mode = Mode::kProject;
    job.src_width = 2;
    change(job);
    ModelBench bench(0x1'0000);
    job.src_base = job.dst_base = kWord;
    const bool possible = rtl::possible(job);
    bench.window(job, ModelBench::kBase, 0, 0);
    bench.set(bench.regs.ctrl, 1);
    bench.set(bench.regs.submit, 0);
    bench.advance(20);
    const bool refused = bench.get(bench.regs.ended) >> 8 & kRefused;
    EXPECT_NE(possible, refused);
    if (refused) {
      EXPECT_EQ(bench.get(bench.regs.clocks), 2u);
    }
    return refused;
  };
  EXPECT_FALSE(events([](auto&) {}));
  EXPECT_TRUE(events([](auto& j) { j.pairs = 0; }));
  EXPECT_FALSE(events([](auto& j) { j.pairs = 2048; }));
  EXPECT_TRUE(events([](auto& j) { j.pairs = 2049; }));
  EXPECT_TRUE(events([](auto& j) { j.rows = 0; }));
  EXPECT_FALSE(events([](auto& j) { j.rows = 4096; }));
  EXPECT_TRUE(events([](auto& j) { j.rows = 4097; }));
  EXPECT_TRUE(events([](auto& j) { j.src_width = 3; }));
  EXPECT_TRUE(events([](auto& j) { j.src_width = 0; }));
  EXPECT_FALSE(events([](auto& j) { j.src_width = 4096, j.src_pitch = 2048; }));
  EXPECT_TRUE(events([](auto& j) { j.src_width = 4096, j.src_pitch = 2047; }));
  EXPECT_TRUE(events([](auto& j) { j.src_width = 4098, j.src_pitch = 4000; }));
  EXPECT_TRUE(events([](auto& j) { j.src_height = 0; }));
  EXPECT_FALSE(events([](auto& j) { j.src_height = 4096; }));
  EXPECT_TRUE(events([](auto& j) { j.src_height = 4097; }));
  struct Grid {
    unsigned log2, pairs;
    bool refused;
  };
  const Grid grids[] = {{1, 1, true},    {2, 508, false},  {2, 510, false},
                        {2, 511, true}, {6, 2048, false}, {7, 1, true}};
  for (const Grid& g : grids)
    EXPECT_EQ(events([&](auto& j) { j.mode = Mode::kGrid, j.grid_log2 = g.log2, j.pairs = g.pairs; }), g.refused)
        << g.pairs;
  EXPECT_TRUE(events([](auto& j) { j.mode = Mode::kRadial, j.pieces = 0; }));
  EXPECT_FALSE(events([](auto& j) { j.mode = Mode::kRadial, j.pieces = 128, j.piece_log2 = 23; }));
  EXPECT_TRUE(events([](auto& j) { j.mode = Mode::kRadial, j.pieces = 129; }));
  EXPECT_TRUE(events([](auto& j) { j.mode = Mode::kRadial, j.piece_log2 = 24; }));
}

/// One pair, one pixel right of the centre: s is 1 square pixel, that is 256 in Q8 and 65536 in Q16.
TEST(ModelTest, LimitsOfTheRadialFunctionAreThoseOfTheDefinition) {
  const auto result = [](std::uint32_t radius_limit, unsigned pieces, unsigned piece_log2) {
    ModelBench bench(0x1'0000);
    rtl::Job job;
    job.mode = Mode::kRadial;
    job.src_width = 4;
    job.src_pitch = 2;
    job.src_base = kWord;
    job.dst_base = kWord + 0x100;
    job.a[0] = 1 << 16;
    job.pieces = pieces;
    job.piece_log2 = piece_log2;
    job.radius_limit = radius_limit;
    bench.word(kWord) = 0x1234'5678;
    for (unsigned n = 0; n < 3 * pieces; ++n) bench.word(kWord + 0x200 + n) = n % 3 == 0 ? 1 << 20 : 0;
    EXPECT_EQ(bench.run(job, ModelBench::kBase + 0x800, kBorder, {}), kDone);
    return bench.word(kWord + 0x100);
  };
  EXPECT_EQ(result(256, 1, 8), 0x1234'5678u);
  EXPECT_EQ(result(255, 1, 8), kBorder);
  EXPECT_EQ(result(~0u, 1, 1), 0x1234'5678u);
  EXPECT_EQ(result(~0u, 1, 0), kBorder);  // behind the first piece
  EXPECT_EQ(result(~0u, 2, 0), 0x1234'5678u);
}

/// Offsets, names, bits that can be written; of the contract between engine and firmware, typed in by hand.
TEST(RegistersTest, AreThoseOfTheTable) {
  struct Row {
    std::uint32_t offset;
    const char* name;
    std::uint32_t reset, kept;  // after a reset; of all ones
  };
  constexpr Row kRows[] = {
      {0x00, "ID", 0x52454D31, 0}, {0x04, "CTRL", 0, 1}, {0x08, "STATUS", 0, 0}, {0x0C, "EVENTS", 0, 0},
      {0x10, "ENABLES", 0, 0x7F}, {0x14, "SUBMIT", 0, 0}, {0x18, "ENDED", 0, 0}, {0x20, "CLOCKS", 0, 0},
      {0x24, "LINES", 0, 0}, {0x28, "WRITES", 0, 0}, {0x2C, "BAD", 0, 0}, {0x40, "MODE", 0, 0x1FFF'0707},
      {0x44, "SIZE", 0, 0x1FFF'0FFF}, {0x48, "SRC_BASE", 0, 0xFFFF'FFFC}, {0x4C, "SRC_PITCH", 0, 0x7FFC},
      {0x50, "SRC_SIZE", 0, 0x1FFF'1FFF}, {0x54, "DST_BASE", 0, 0xFFFF'FFFC}, {0x58, "DST_PITCH", 0, 0x7FFC},
      {0x5C, "MAP_BASE", 0, 0xFFFF'FFC0}, {0x60, "MAP_WORDS", 0, 0xFF'FFFF}, {0x64, "BORDER", 0, ~0u},
      {0x68, "RADIUS_LIMIT", 0, ~0u}, {0x6C, "CENTRE_X", 0, ~0u}, {0x70, "CENTRE_Y", 0, ~0u}, {0x74, "A0", 0, ~0u},
      {0x78, "A1", 0, ~0u}, {0x7C, "A2", 0, ~0u}, {0x80, "B0", 0, ~0u}, {0x84, "B1", 0, ~0u}, {0x88, "B2", 0, ~0u},
      {0x8C, "C0", 0, ~0u}, {0x90, "C1", 0, ~0u}, {0x94, "C2", 0, ~0u}};
  ModelBench bench(64);
  EngineRegs& regs = bench.regs;
  ASSERT_EQ(regs.regs().size(), std::size(kRows));
  for (const Row& row : kRows) {
    const Reg* const r = regs.register_at(row.offset);
    ASSERT_NE(r, nullptr) << row.name;
    EXPECT_EQ(r->name(), row.name);
    EXPECT_EQ(bench.get(*r), row.reset) << row.name;
    std::uint32_t value = 0;
    ASSERT_EQ(regs.read(row.offset, 4, value), fovea::Access::kOk);
    EXPECT_EQ(value, row.reset) << row.name;
    regs.write(row.offset, 4, ~0u);
    regs.read(row.offset, 4, value);
    EXPECT_EQ(value, row.kept | row.reset) << row.name;
    bench.set(*r, ~0u);
    bench.advance(2);
    // The others have said more since all ones were written to CTRL and SUBMIT.
    if (row.offset >= 0x40) EXPECT_EQ(bench.get(*r), row.kept | row.reset) << row.name;
  }
  for (const std::uint32_t hole : {0x1Cu, 0x30u, 0x3Cu, 0x98u, 0x3FCu}) EXPECT_EQ(regs.register_at(hole), nullptr);
}

struct Queue : testing::Test {
  ModelBench bench{kSize};
  MappedJob job;
  Queue() {
    Dice dice(5);
    job = small_job(dice);
    fill(bench, job, dice);
    bench.window(job.job, ModelBench::kBase + kMap, 800, kBorder);
  }
  std::uint32_t status() { return bench.get(bench.regs.status); }
  std::uint32_t events() { return bench.get(bench.regs.events); }
  void submit(std::uint32_t tag) { bench.set(bench.regs.submit, tag); }
  /// Tag, bits, number.
  std::array<std::uint32_t, 3> ended() {
    const std::uint32_t e = bench.get(bench.regs.ended);
    return {e & 255, e >> 8 & 255, e >> 16};
  }
};

TEST_F(Queue, HoldsFourJobsAndLosesTheFifth) {
  for (unsigned n = 1; n <= 4; ++n) {
    submit(n);
    EXPECT_EQ(status(), n << 4 | (n == 4 ? 0x100u : 0)) << n;
    EXPECT_EQ(events(), 0u);
  }
  submit(5);
  EXPECT_EQ(events(), kOverflow);
  EXPECT_EQ(status(), 0x140u);
  EXPECT_FALSE(bench.backend.busy());
  bench.advance(1000);
  EXPECT_TRUE(bench.asked.empty());  // not enabled
  bench.set(bench.regs.events, kOverflow);
  EXPECT_EQ(events(), 0u);
  bench.set(bench.regs.ctrl, 1);
  bench.advance(3);
  EXPECT_EQ(status(), 0x31u);  // one is under way: there is room again
  submit(6);
  EXPECT_EQ(status(), 0x141u);
  bench.finish();
  bench.advance(2);
  EXPECT_EQ(status(), 0u);
  EXPECT_EQ(events(), kDone);
  EXPECT_THAT(ended(), testing::ElementsAre(6, kDone, 5));
}

TEST_F(Queue, AJobIsTheWindowAsItWas) {
  submit(1);
  bench.set(bench.regs.size, 0);  // not possible
  submit(2);
  bench.set(bench.regs.ctrl, 1);
  bench.finish();
  bench.advance(2);
  EXPECT_EQ(events(), kDone | kRefused);
  EXPECT_THAT(ended(), testing::ElementsAre(2, kRefused, 2));
  EXPECT_EQ(bench.get(bench.regs.clocks), 2u);
  EXPECT_EQ(bench.get(bench.regs.lines), 0u);
}

TEST_F(Queue, AbortEndsTheJobAndDropsTheOthers) {
  bench.set(bench.regs.ctrl, 1);
  submit(7);
  submit(8);
  bench.advance(100);
  EXPECT_EQ(status(), 0x11u);
  bench.set(bench.regs.ctrl, 3);
  EXPECT_EQ(events(), kDropped);
  EXPECT_EQ(status() & 0xF0, 0u);
  bench.finish();
  bench.advance(2);
  EXPECT_EQ(events(), kDropped | kAborted);
  EXPECT_THAT(ended(), testing::ElementsAre(7, kAborted, 1));
  // Without a job it does nothing; ENABLE stays.
  bench.set(bench.regs.events, ~0u);
  bench.set(bench.regs.ctrl, 3);
  bench.advance(100);
  EXPECT_EQ(events(), 0u);
  EXPECT_EQ(bench.get(bench.regs.ctrl), 1u);
  submit(9);
  bench.finish();
  bench.advance(2);
  EXPECT_THAT(ended(), testing::ElementsAre(9, kDone, 2));
}

/// A job with fewer words of map than its mode reads waits for ever, as in the RTL.
TEST_F(Queue, AJobWithoutItsMapStandsStillUntilItIsAborted) {
  bench.set(bench.regs.map_words, 798);
  bench.set(bench.regs.ctrl, 1);
  submit(1);
  bench.advance(100'000);
  EXPECT_EQ(status(), 1u);
  bench.set(bench.regs.ctrl, 3);
  bench.finish();
  bench.advance(2);
  EXPECT_THAT(ended(), testing::ElementsAre(1, kAborted, 1));
}

TEST_F(Queue, DisablingLetsTheJobUnderWayEnd) {
  bench.set(bench.regs.ctrl, 1);
  submit(1);
  submit(2);
  bench.advance(50);
  bench.set(bench.regs.ctrl, 0);
  bench.finish();
  bench.advance(2);
  EXPECT_THAT(ended(), testing::ElementsAre(1, kDone, 1));
  EXPECT_EQ(status(), 0x10u);
}

TEST_F(Queue, TheLineIsHighWhileAnEnabledEventIsThere) {
  bench.set(bench.regs.enables, kDone);
  bench.set(bench.regs.ctrl, 1);
  submit(1);
  bench.finish();
  bench.advance(2);
  EXPECT_THAT(bench.interrupts, testing::ElementsAre(true));
  bench.set(bench.regs.events, kRefused);
  EXPECT_THAT(bench.interrupts, testing::ElementsAre(true));
  bench.set(bench.regs.events, kDone);
  EXPECT_THAT(bench.interrupts, testing::ElementsAre(true, false));
  bench.set(bench.regs.ctrl, 0);
  for (unsigned n = 0; n < 5; ++n) submit(n);
  EXPECT_THAT(bench.interrupts, testing::ElementsAre(true, false));  // OVERFLOW is not enabled
  bench.set(bench.regs.enables, kOverflow);
  EXPECT_THAT(bench.interrupts, testing::ElementsAre(true, false, true));
  bench.backend.reset();
  EXPECT_THAT(bench.interrupts, testing::ElementsAre(true, false, true, false));
  EXPECT_EQ(status(), 0u);
  EXPECT_EQ(events(), 0u);
}

}  // namespace
}  // namespace fovea::engine
