// The engine on a memory: pictures bit by bit, errors, ends before time, and what the protocol
// checker finds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "tb/oracle/frame_compare.h"
#include "tb/rtl/engine_bench.h"
#include "tb/rtl/wide_jobs.h"

namespace fovea::rtl {
namespace {

constexpr std::uint32_t kWord = EngineBench::kBase / 4;  // first word of the memory
constexpr std::uint32_t kMap = 0x20'0000, kTarget = 0x40'0000,
                        kSize = 0x60'0000;  // bytes from its beginning
constexpr std::uint32_t kUntouched = 0x5A5A5A5A, kBorder = 0x10801080;

/// A memory with a source of random pixels at its beginning, and everything else untouched.
void fill(EngineBench& bench, const MappedJob& m, Dice& dice) {
  for (std::uint32_t n = 0; n < kSize / 4; ++n) bench.word(kWord + n) = kUntouched;
  for (std::uint32_t n = 0; n < m.job.src_pitch * m.job.src_height; ++n)
    bench.word(kWord + n) = dice.word();
  for (std::size_t n = 0; n < m.map.size(); ++n)
    bench.word(kWord + kMap / 4 + static_cast<std::uint32_t>(n)) = m.map[n];
}

/// Where the job's bases are in that memory.
void place(MappedJob& m, std::uint32_t offset_words = 0) {
  m.job.src_base = kWord;
  m.job.dst_base = kWord + kTarget / 4 + offset_words;
}

std::vector<std::uint32_t> expected(EngineBench& bench, const MappedJob& m) {
  return picture(m.job, m.map, kBorder, [&](std::uint32_t at) { return bench.word(at); });
}

/// The words of the result, and whether nothing beside them was written.
void expect_picture(EngineBench& bench, const MappedJob& m,
                    const std::vector<std::uint32_t>& want) {
  for (unsigned j = 0; j < m.job.rows; ++j)
    for (unsigned i = 0; i < m.job.pairs; ++i) {
      const std::uint32_t at = m.job.dst_base + j * m.job.dst_pitch + i;
      ASSERT_EQ(bench.word(at), want[std::size_t{j} * m.job.pairs + i])
          << "pair " << i << " of row " << j;
      bench.word(at) = kUntouched;
    }
  for (std::uint32_t n = kTarget / 4; n < kSize / 4; ++n)
    ASSERT_EQ(bench.word(kWord + n), kUntouched);
}

TEST(EngineTest, RandomJobsOnRandomMemoriesMakeTheGoldenPicture) {
  Dice dice(seed());
  EngineBench bench(kSize, seed());
  for (unsigned n = 0; n < 60; ++n) {
    MappedJob m = random_job(dice, static_cast<Mode>(n % 4));
    place(m, dice.to(40));
    m.job.dst_pitch = m.job.pairs + dice.to(20);
    fill(bench, m, dice);
    const auto want = expected(bench, m);
    const Memory memory{.latency = dice.to(40),
                        .spread = dice.to(30),
                        .willing = 2 + dice.to(14),
                        .swaps = dice.to(1) == 1};
    const Result got = bench.run(m.job, EngineBench::kBase + kMap, kBorder, memory);
    EXPECT_FALSE(got.refused || got.read_error || got.write_error || got.aborted);
    expect_picture(bench, m, want);
    if (HasFatalFailure()) FAIL() << "job " << n;
    std::uint32_t bad = 0;
    for (const Beat& b : addresses(m.job, m.map)) bad += b.bad;
    EXPECT_EQ(got.bad, bad);
    EXPECT_EQ(got.written_bytes, 4u * m.job.pairs * m.job.rows);
  }
}

TEST(EngineTest, APalFrameIsTheFirmwaresPictureAndCostsWhatItMust) {
  Dice dice(seed());
  EngineBench bench(kSize);
  lens_view_t view;
  lens_view_default(&view);
  lens_t lens;
  ASSERT_EQ(lens_init(&lens, &view, 720, 576), LENS_OK);
  MappedJob table = table_job(lens), grid = grid_job(lens, 4), radial = radial_job(lens);
  for (MappedJob* m : {&table, &grid, &radial}) {
    place(*m);
    fill(bench, *m, dice);
    const auto want = expected(bench, *m);
    const Result got = bench.run(m->job, EngineBench::kBase + kMap, kBorder, {.latency = 24});
    expect_picture(bench, *m, want);
    const double pairs = 360.0 * 576;
    // The minimum: each source line that is needed once, the map once, the result once.
    const auto beats = addresses(m->job, m->map);
    EXPECT_EQ(got.lines, lines_read(beats, 8));
    const double least = static_cast<double>(lines_needed(beats)) * 32 +
                         static_cast<double>(m->map.size()) * 4 + pairs * 4;
    const double traffic = static_cast<double>(got.read_bytes + got.written_bytes);
    std::printf(
        "mode %u: %.3f clocks a pair, %.0f frames/s at 121.5 MHz, traffic %.2f times the minimum\n",
        static_cast<unsigned>(m->job.mode), got.clocks / pairs, 121.5e6 / got.clocks,
        traffic / least);
    EXPECT_LE(traffic, 1.3 * least);
    // What the engine is built for, on an idle memory: 250 frames a second with a table, 400
    // without.
    EXPECT_GE(121.5e6 / got.clocks, m == &table ? 250 : 400);
    // A pair a clock, and one clock more for each burst of 16 words written.
    EXPECT_GE(got.clocks, pairs * 17 / 16);
    if (m != &table) continue;
    // And by the oracle of the firmware's loop.
    oracle::Frame in{720, 576, {}};
    for (std::uint32_t n = 0; n < 720 * 576 / 2; ++n)
      for (unsigned byte = 0; byte < 4; ++byte)
        in.uyvy.push_back(static_cast<std::uint8_t>(bench.word(kWord + n) >> 8 * byte));
    const oracle::Frame out = oracle::remap(in, table.map, 1440);
    for (std::size_t n = 0; n < want.size(); ++n)
      for (unsigned byte = 0; byte < 4; ++byte)
        ASSERT_EQ(out.uyvy[4 * n + byte], want[n] >> 8 * byte & 255);
  }
}

/// A table that reads words of one row after another: entries by row and pair.
MappedJob table_of(unsigned pairs, unsigned rows, const std::function<std::uint32_t(unsigned, unsigned)>& entry) {
  MappedJob m;
  m.job.pairs = m.job.dst_pitch = pairs;
  m.job.rows = rows;
  m.job.src_pitch = 512;
  m.job.src_width = m.job.src_height = 1024;
  static_assert(512 * 4 * 1024 <= kMap);
  for (unsigned j = 0; j < rows; ++j)
    for (unsigned i = 0; i < pairs; ++i) m.map.push_back(entry(j, i));
  place(m);
  return m;
}

/// The n-th line of the set of line 0: bits 11 to 20 of its address, of which the lower six choose the set too.
std::uint32_t of_one_set(unsigned n) { return n << 11 | (n % 64) << 5; }

/// Words of two lines of a set whose numbers differ in one bit, in turn.
TEST(EngineTest, LinesOfOneSetAreToldApart) {
  Dice dice(seed() + 1);
  EngineBench bench(kSize);
  const MappedJob m =
      table_of(40, 10, [](unsigned bit, unsigned i) { return of_one_set(i % 2 << bit) + i / 2 % 8 * 4; });
  fill(bench, m, dice);
  const auto want = expected(bench, m);
  const Result got = bench.run(m.job, EngineBench::kBase + kMap, kBorder);
  EXPECT_EQ(got.bad, 0u);
  expect_picture(bench, m, want);
  // Line 0, and line 2^bit in each row: the fifth of them replaces line 0, which comes again in the next row.
  EXPECT_EQ(got.lines, lines_read(addresses(m.job, m.map), 8));
}

/// Four lines of a set stay; of five in turn each one replaces the one that is needed next.
TEST(EngineTest, ASetHasFourWays) {
  Dice dice(seed() + 1);
  EngineBench bench(kSize);
  for (const unsigned lines : {4u, 5u}) {
    const MappedJob m = table_of(40, 1, [&](unsigned, unsigned i) { return of_one_set(1 + i % lines); });
    fill(bench, m, dice);
    const auto want = expected(bench, m);
    EXPECT_EQ(bench.run(m.job, EngineBench::kBase + kMap, kBorder).lines, lines == 4 ? 4u : 40u);
    expect_picture(bench, m, want);
  }
}

TEST(EngineTest, ErrorsAndAnEarlyEndAreReportedAndTheNextJobIsRight) {
  Dice dice(seed() + 2);
  EngineBench bench(kSize, seed() + 2);
  for (unsigned n = 0; n < 48; ++n) {
    MappedJob m = random_job(dice, Mode::kTable);
    m.job.pairs = 40;
    m.job.rows = 20;
    m.job.dst_pitch = 48;
    m.map.assign(800, 0);
    for (auto& entry : m.map) entry = dice.to(m.job.src_pitch * m.job.src_height - 1) * 4;
    place(m);
    fill(bench, m, dice);
    Memory memory{
        .latency = dice.to(30), .spread = dice.to(20), .willing = 4 + dice.to(12), .swaps = true};
    std::optional<unsigned> abort_after;
    switch (n % 4) {
      case 0:
        memory.read_fault = EngineBench::kBase + kMap + 64 * dice.to(49);
        break;
      case 1:
        memory.read_fault = EngineBench::kBase + m.map[dice.to(799)];
        break;
      case 2:
        memory.write_fault = EngineBench::kBase + kTarget + 192 * dice.to(19);
        break;
      case 3:
        abort_after = dice.to(500);
        break;
    }
    const Result got = bench.run(m.job, EngineBench::kBase + kMap, kBorder, memory, abort_after);
    EXPECT_EQ(got.read_error, n % 4 < 2) << n;
    EXPECT_EQ(got.write_error, n % 4 == 2) << n;
    EXPECT_EQ(got.aborted, n % 4 == 3) << n;
    fill(bench, m, dice);
    const auto want = expected(bench, m);
    bench.run(m.job, EngineBench::kBase + kMap, kBorder);
    expect_picture(bench, m, want);
    if (HasFatalFailure()) FAIL() << "job " << n;
  }
  Job impossible;
  impossible.src_width = 3;
  EXPECT_TRUE(bench.run(impossible, EngineBench::kBase, kBorder).refused);
}

/// The memory appears at every 8 MiB of the address space; source, map and result are anywhere in it, each in a quarter
/// of its own of what they repeat.
TEST(EngineTest, JobsWithAddressesOfAllBitsMakeTheGoldenPicture) {
  constexpr std::uint32_t kWords = 0x20'0000, kQuarter = kWords / 4;
  Dice dice(seed() + 10);
  EngineBench bench(kWords * 4, seed() + 10);
  bench.repeats = true;
  for (std::uint32_t n = 0; n < kWords; ++n) bench.word(n) = n < kQuarter ? dice.word() : kUntouched;
  for (unsigned n = 0; n < 100; ++n) {
    MappedJob m = wide_job(dice, static_cast<Mode>(n % 4), 400);
    Job& j = m.job;
    // Source and result have to be within a quarter: with all rows, and a row and a word more.
    while (j.src_pitch * (j.src_height + 1) > kQuarter / 2) j.src_height > 1 ? j.src_height /= 2 : j.src_pitch /= 2;
    while (j.dst_pitch * j.rows > kQuarter / 2) j.dst_pitch /= 2;
    j.dst_pitch = std::max(j.dst_pitch, j.pairs);
    j.src_width = std::min(j.src_width, j.src_pitch * 2);
    const auto anywhere = [&](unsigned quarter) {
      return (dice.word() >> 2 & ~(kWords - 1)) + quarter * kQuarter + dice.to(kQuarter / 2 - 4096);
    };
    j.src_base = anywhere(0);
    j.dst_base = anywhere(2);
    const std::uint32_t map = (anywhere(1) & ~15u) * 4, border = dice.word();
    if (j.mode == Mode::kTable)
      for (auto& word : m.map) word = dice.to(j.src_pitch * j.src_height - 1) * 4;
    for (std::size_t k = 0; k < m.map.size(); ++k) bench.word(map / 4 + static_cast<std::uint32_t>(k)) = m.map[k];
    bench.more_map_words = dice.to(1) ? 0 : dice.word() >> 8 & 0x7F'FFFF;
    const auto want = picture(j, m.map, border, [&](std::uint32_t at) { return bench.word(at); });
    const Result got = bench.run(j, map, border, {.latency = dice.to(20), .spread = dice.to(20)});
    ASSERT_FALSE(got.refused || got.read_error || got.write_error || got.aborted) << n;
    for (unsigned row = 0; row < j.rows; ++row)
      for (unsigned i = 0; i < j.pairs; ++i) {
        std::uint32_t& word = bench.word(j.dst_base + row * j.dst_pitch + i);
        ASSERT_EQ(word, want[std::size_t{row} * j.pairs + i]) << "job " << n << ", pair " << i << " of row " << row;
        word = kUntouched;
      }
    EXPECT_EQ(got.written_bytes, 4u * j.pairs * j.rows) << n;
    // A cache that takes lines for others, or does not find them, reads more or fewer.
    if (!j.bilinear) {
      EXPECT_EQ(got.lines, lines_read(addresses(j, m.map), 8)) << n;
    }
  }
}

/// Writes that are not taken for long: everything before them fills up, eight lines wait, and nothing is lost.
TEST(EngineTest, AJobWhoseWritesAreHeldUpIsRight) {
  Dice dice(seed() + 11);
  EngineBench bench(kSize);
  const MappedJob m = table_of(64, 8, [&](unsigned, unsigned) { return dice.to(512 * 1024 - 1) * 4; });
  fill(bench, m, dice);
  const auto want = expected(bench, m);
  const Result got = bench.run(m.job, EngineBench::kBase + kMap, kBorder, {.latency = 4, .writes_from = 2000});
  EXPECT_GE(got.clocks, 2000u);
  // Lines of the first burst of 16 words, of the next one, which is collected, of the words behind it, and eight.
  EXPECT_LE(std::ranges::count_if(bench.read_clocks, [&](std::uint64_t t) { return t < bench.read_clocks[0] + 1900; }),
            4 + 16 + 16 + 3 + 8 + 4);
  expect_picture(bench, m, want);
}

TEST(EngineTest, AResetInMidJobForgetsItAndTheNextJobIsRight) {
  Dice dice(seed() + 12);
  EngineBench bench(kSize, seed() + 12);
  for (unsigned n = 0; n < 60; ++n) {
    MappedJob m = random_job(dice, static_cast<Mode>(n % 4));
    place(m, dice.to(40));
    m.job.dst_pitch = m.job.pairs + dice.to(20);
    fill(bench, m, dice);
    bench.memory = {.latency = dice.to(30), .spread = dice.to(20), .willing = 4 + dice.to(12)};
    bench.write(Offset::kCtrl, 1);
    bench.write(Offset::kEnables, 0x7F);
    bench.submit(m.job, EngineBench::kBase + kMap, kBorder, 0xFF);
    for (unsigned k = dice.to(n % 2 ? 2000 : 100); k > 0; --k) bench.clock();
    bench.reset(1 + dice.to(3));
    for (unsigned offset = Offset::kCtrl; offset <= 0x94; offset += 4)
      if (offset != 0x1C && (offset < 0x30 || offset >= Offset::kMode)) {
        ASSERT_EQ(bench.read(offset), 0u) << offset;
      }
    for (unsigned k = 0; k < 100; ++k) bench.clock();
    ASSERT_FALSE(bench.busy() || bench.interrupt());
    fill(bench, m, dice);
    const auto want = expected(bench, m);
    bench.run(m.job, EngineBench::kBase + kMap, kBorder);
    expect_picture(bench, m, want);
    if (HasFatalFailure()) FAIL() << "job " << n;
  }
}

/// What needs more clocks than CI has: with RTL_LONG in the environment, as scripts/rtl-coverage
/// runs it.
TEST(EngineTest, CountersCountBeyondAMillion) {
  if (!std::getenv("RTL_LONG")) GTEST_SKIP() << "only with RTL_LONG";
  EngineBench bench(0x40'0000);
  bench.repeats = true;
  MappedJob m;
  m.job.pairs = m.job.dst_pitch = 2048;
  m.job.rows = 520;
  m.job.src_base = kWord;
  m.job.dst_base = kWord;
  const auto fill_with = [&](std::uint32_t entry) {
    for (std::uint32_t n = 0; n < 0x10'0000; ++n) bench.word(kWord + n) = entry;
  };
  // Each entry is bad: nothing of the source is read. The results are as bad as the entries, wherever they go.
  fill_with(1);
  const Result bad = bench.run(m.job, EngineBench::kBase, 1, {.latency = 2});
  EXPECT_EQ(bad.bad, 2048u * 520);
  EXPECT_EQ(bad.writes, 2048u * 520 / 16);
  EXPECT_EQ(bad.lines, 0u);
  EXPECT_GE(bad.clocks, 2048u * 520 * 17 / 16);
  // 2^18 pairs, each of another line.
  m.job.rows = 128;
  m.job.src_width = 4096;
  m.job.src_height = 4096;
  m.job.src_pitch = 2048;
  m.job.dst_base = kWord + 0x8'0000;
  for (std::uint32_t n = 0; n < 2048 * 128; ++n) bench.word(kWord + n) = n * 32 % (2048 * 4096 * 4);
  EXPECT_EQ(bench.run(m.job, EngineBench::kBase, 1, {.latency = 2}).lines, 2048u * 128);
}

AxiClock read_of(std::uint32_t address, unsigned length, bool ready = true) {
  AxiClock c;
  c.ar = {true, ready, 0, address, length};
  return c;
}
AxiClock write_of(std::uint32_t address, unsigned length) {
  AxiClock c;
  c.aw = {true, true, 0, address, length};
  return c;
}
AxiClock data_of(bool last, bool ready = true, std::uint64_t data = 0, unsigned strobes = 255) {
  AxiClock c;
  c.w = {true, ready, last, data, strobes};
  return c;
}
AxiClock answer(bool read) {
  AxiClock c;
  (read ? c.r_last : c.b) = true;
  return c;
}

void expect_complaint(const std::vector<AxiClock>& clocks, const char* text) {
  AxiChecker checker(2, 2);
  for (std::size_t n = 0; n + 1 < clocks.size(); ++n) EXPECT_NO_THROW(checker.clock(clocks[n]));
  try {
    checker.clock(clocks.back());
    ADD_FAILURE() << "no complaint of: " << text;
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr(text));
  }
}

TEST(AxiCheckerTest, ComplainsOfEachRule) {
  expect_complaint({read_of(64, 3, false), read_of(96, 3)}, "AR changed");
  expect_complaint({read_of(64, 3, false), read_of(64, 2)}, "AR changed");
  expect_complaint({read_of(64, 3, false), AxiClock{}}, "ARVALID taken back");
  expect_complaint({data_of(true, false), data_of(true, false, 1)}, "W changed");
  expect_complaint({data_of(true, false), AxiClock{}}, "WVALID taken back");
  expect_complaint({read_of(68, 0)}, "not aligned");
  expect_complaint({read_of(4096 - 32, 3), read_of(4096 - 24, 3)}, "crosses 4 KiB");
  expect_complaint({write_of(4096 - 24, 3)}, "AW crosses 4 KiB");
  expect_complaint({read_of(0, 0), read_of(0, 0), read_of(0, 0)}, "more reads");
  expect_complaint({write_of(0, 0), write_of(0, 0), write_of(0, 0)}, "more writes");
  expect_complaint({write_of(0, 1), data_of(true)}, "WLAST");
  expect_complaint({write_of(0, 0), data_of(false), data_of(true)}, "WLAST");
  expect_complaint({answer(true)}, "to no read");
  expect_complaint({answer(false)}, "to no write");
}

TEST(AxiCheckerTest, AcceptsWhatIsAllowedAndKnowsWhenAllIsDone) {
  AxiChecker checker(2, 2);
  EXPECT_TRUE(checker.quiet());
  for (const AxiClock& c :
       {read_of(64, 3, false), read_of(64, 3), data_of(false), data_of(true), write_of(8, 1)})
    checker.clock(c);
  EXPECT_FALSE(checker.quiet());
  checker.clock(answer(true));
  EXPECT_FALSE(checker.quiet());
  checker.clock(answer(false));
  EXPECT_TRUE(checker.quiet());
}

}  // namespace
}  // namespace fovea::rtl
