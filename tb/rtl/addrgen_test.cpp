// The address generator against its golden model, bit by bit, and that against the firmware's
// table.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tb/rtl/addrgen_bench.h"
#include "tb/rtl/lens_maps.h"
#include "tb/rtl/wide_jobs.h"

namespace fovea::rtl {

void PrintTo(const Beat& b, std::ostream* os) {
  *os << "{src " << b.src << " dst " << b.dst << " frac " << b.frac_x << "," << b.frac_y
      << (b.border ? " border" : "") << (b.bad ? " bad" : "") << (b.edge_x ? " edge_x" : "")
      << (b.edge_y ? " edge_y" : "") << (b.odd ? " odd" : "") << (b.last ? " last" : "") << "}";
}

namespace {

lens_t lens_of(lens_view_t& view, unsigned width, unsigned height) {
  lens_t lens;
  EXPECT_EQ(lens_init(&lens, &view, width, height), LENS_OK);
  return lens;
}

lens_view_t view_of(unsigned mapping, double fov) {
  lens_view_t view;
  lens_view_default(&view);
  view.mapping = mapping;
  view.fov_deg = fov;
  return view;
}

/// Compares and says where the first difference is.
void expect_equal(const std::vector<Beat>& expected, const std::vector<Beat>& got, const Job& job) {
  ASSERT_EQ(expected.size(), got.size());
  for (std::size_t n = 0; n < got.size(); ++n)
    ASSERT_EQ(expected[n], got[n]) << "pair " << n % job.pairs << " of row " << n / job.pairs
                                   << ", mode " << static_cast<unsigned>(job.mode);
}

void run_and_compare(AddrgenBench& bench, const MappedJob& m, Pace pace = {}) {
  ASSERT_TRUE(possible(m.job));
  const Outcome got = bench.run(m.job, m.map, pace);
  expect_equal(addresses(m.job, m.map), got.beats, m.job);
  EXPECT_EQ(got.map_taken, m.map.size());
}

TEST(AddrgenTest, RandomJobsEqualTheGoldenModelUnderAnyBackPressure) {
  Dice dice(seed());
  AddrgenBench bench(seed());
  std::size_t count[4] = {}, with_source[4] = {};
  for (unsigned n = 0; n < 400; ++n) {
    const MappedJob m = random_job(dice, static_cast<Mode>(n % 4));
    const Pace pace{1 + dice.to(15), 1 + dice.to(15)};
    ASSERT_TRUE(possible(m.job));
    const Outcome got = bench.run(m.job, m.map, pace);
    expect_equal(addresses(m.job, m.map), got.beats, m.job);
    if (HasFatalFailure()) FAIL() << "job " << n;
    ASSERT_EQ(got.map_taken, m.map.size()) << "job " << n;
    for (const Beat& b : got.beats) ++count[n % 4], with_source[n % 4] += !b.border;
  }
  // Neither all border nor none: the comparison has seen both.
  for (unsigned mode = 0; mode < 4; ++mode) {
    EXPECT_GT(with_source[mode], count[mode] / 20) << "mode " << mode;
    EXPECT_LT(with_source[mode], count[mode] * 49 / 50) << "mode " << mode;
  }
}

TEST(AddrgenTest, RandomJobsOfAllWidthsEqualTheGoldenModel) {
  Dice dice(seed() + 2);
  AddrgenBench bench(seed() + 2);
  std::size_t count[4] = {}, with_source[4] = {};
  for (unsigned n = 0; n < 600; ++n) {
    const MappedJob m = wide_job(dice, static_cast<Mode>(n % 4), 600);
    const Pace pace{8 + dice.to(8), 8 + dice.to(8)};
    ASSERT_TRUE(possible(m.job));
    const Outcome got = bench.run(m.job, m.map, pace);
    expect_equal(addresses(m.job, m.map), got.beats, m.job);
    if (HasFatalFailure()) FAIL() << "job " << n;
    ASSERT_EQ(got.map_taken, m.map.size()) << "job " << n;
    for (const Beat& b : got.beats) ++count[n % 4], with_source[n % 4] += !b.border;
  }
  for (unsigned mode = 0; mode < 4; ++mode) {
    std::printf("mode %u: %zu pairs, %zu with a source\n", mode, count[mode], with_source[mode]);
    EXPECT_GT(with_source[mode], count[mode] / 20) << "mode " << mode;
    EXPECT_LT(with_source[mode], count[mode] * 49 / 50) << "mode " << mode;
  }
}

// Counters, and where they end: the widest row, the tallest column, the most nodes, the largest frame.
TEST(AddrgenTest, JobsAtTheLimitsEqualTheGoldenModel) {
  Dice dice(seed() + 3);
  AddrgenBench bench;
  const auto run = [&](unsigned pairs, unsigned rows, Mode mode, unsigned grid_log2 = 2) {
    MappedJob m;
    Job& j = m.job;
    j.mode = mode;
    j.pairs = pairs;
    j.rows = rows;
    j.grid_log2 = grid_log2;
    j.src_width = j.src_height = 4096;
    j.src_pitch = j.dst_pitch = 8191;
    j.a[1] = (4096 << 16) / static_cast<int>(pairs);
    j.b[2] = (4096 << 16) / static_cast<int>(rows);
    j.c[0] = 1 << 16;
    j.pieces = 128;
    j.piece_log2 = 17;
    m.map.resize(map_words(j));
    for (auto& word : m.map) word = mode == Mode::kTable ? dice.to(4096 * 8191 - 1) * 4 : dice.word() & 0x00FF'00FF;
    run_and_compare(bench, m);
  };
  for (const Mode mode : {Mode::kTable, Mode::kGrid, Mode::kRadial, Mode::kProject}) {
    const bool grid = mode == Mode::kGrid;
    run(grid ? 510 : 2048, 5, mode);   // with a step of 4 pixels, 256 nodes
    run(2048, 3, mode, 6);
    run(1, 4096, mode);
    run(2, 4095, mode, 6);
    if (HasFatalFailure()) FAIL() << "mode " << static_cast<unsigned>(mode);
  }
  // The forms wrap at 36 bits: here at -2^35, the number whose size has one bit more.
  MappedJob m;
  m.job.mode = Mode::kProject;
  m.job.pairs = 20;
  m.job.rows = 2;
  m.job.c[0] = (1 << 24) - 1;
  for (auto* form : {&m.job.a, &m.job.b}) (*form)[0] = (*form)[1] = (*form)[2] = -0x7FFF'FFFF - 1;
  run_and_compare(bench, m);
  // The largest square radius: both X and Y are -2^19.
  m.job.mode = Mode::kRadial;
  m.job.pairs = m.job.rows = 1;
  for (const unsigned log2 : {0u, 23u}) {
    m.job.piece_log2 = log2;
    m.job.pieces = 128;
    m.map.assign(map_words(m.job), 0x0200'0000);
    m.job.a[0] = m.job.b[0] = m.job.c[0] = -(1 << 27);
    run_and_compare(bench, m);
  }
}

TEST(AddrgenTest, FollowsTheFirmwaresTableForEveryMappingAndSize) {
  AddrgenBench bench;
  const struct {
    unsigned width, height, mapping;
    double fov;
  } cases[] = {{720, 576, LENS_EQUISOLID, 180},     {720, 480, LENS_LINEAR, 190},
               {640, 480, LENS_STEREOGRAPHIC, 200}, {4, 4, LENS_ORTHOGRAPHIC, 170},
               {2, 1, LENS_EQUISOLID, 180},         {64, 2, LENS_RECTILINEAR, 120}};
  for (const auto& c : cases) {
    lens_view_t view = view_of(c.mapping, c.fov);
    view.shift_x = 3;
    const lens_t lens = lens_of(view, c.width, c.height);
    const MappedJob m = table_job(lens);
    run_and_compare(bench, m);
    // And without the golden model: the firmware's loop reads frame + entry.
    const Outcome got = bench.run(m.job, m.map);
    for (std::size_t n = 0; n < m.map.size(); ++n) {
      const Beat& b = got.beats[n];
      if (m.map[n] == lens_black_offset(c.height, c.width * 2)) {
        ASSERT_TRUE(b.border && !b.bad);
      } else {
        ASSERT_EQ(b.src, m.job.src_base + m.map[n] / 4);
      }
      ASSERT_EQ(b.dst, m.job.dst_base + n);
    }
  }
}

TEST(AddrgenTest, OnePairAClockInEveryModeAfterItsStart) {
  AddrgenBench bench;
  lens_view_t view = view_of(LENS_EQUISOLID, 180);
  const lens_t lens = lens_of(view, 720, 576);
  const std::uint64_t pairs = 360 * 576;
  // Start: 8 clocks of pipeline. Grid: two rows of 46 nodes before the first pair. Radial: the
  // coefficients, one a clock. Project: 23 stages.
  const MappedJob table = table_job(lens), grid = grid_job(lens, 4), radial = radial_job(lens);
  EXPECT_LE(bench.run(table.job, table.map).clocks, pairs + 8);
  EXPECT_LE(bench.run(grid.job, grid.map).clocks, pairs + 2 * 46 + 16);
  EXPECT_LE(bench.run(radial.job, radial.map).clocks, pairs + radial.map.size() + 16);
  Job project;
  project.mode = Mode::kProject;
  project.pairs = 360;
  project.rows = 576;
  project.c[0] = 1;
  EXPECT_LE(bench.run(project, {}).clocks, pairs + 32);
}

/// Share of the pairs whose source differs from that of the firmware's table.
double share_of_other_sources(const Outcome& got, const MappedJob& table) {
  std::size_t other = 0;
  for (std::size_t n = 0; n < table.map.size(); ++n) {
    const bool black = table.map[n] == table.job.src_pitch * table.job.src_height * 4;
    other +=
        black ? !got.beats[n].border : got.beats[n].src != table.job.src_base + table.map[n] / 4;
  }
  return static_cast<double>(other) / static_cast<double>(table.map.size());
}

TEST(AddrgenTest, GridAndRadialFunctionComeCloseToTheTable) {
  AddrgenBench bench;
  for (const unsigned mapping :
       {LENS_LINEAR, LENS_ORTHOGRAPHIC, LENS_EQUISOLID, LENS_STEREOGRAPHIC}) {
    lens_view_t view = view_of(mapping, 180);
    view.in_aspect = 1.09;
    const lens_t lens = lens_of(view, 720, 576);
    const MappedJob table = table_job(lens), grid = grid_job(lens, 3), radial = radial_job(lens);
    const Outcome by_radius = bench.run(radial.job, radial.map);
    expect_equal(addresses(radial.job, radial.map), by_radius.beats, radial.job);
    // Positions err by about 1/256 px, the coefficients' and the centre's rounding; an entry
    // changes in one of two directions: twice that share at most, on both axes.
    EXPECT_LT(share_of_other_sources(by_radius, table), 4.0 / 256);
    // Nodes are rounded to 1/16 px: at most half of that on average on each axis.
    const Outcome by_grid = bench.run(grid.job, grid.map);
    expect_equal(addresses(grid.job, grid.map), by_grid.beats, grid.job);
    EXPECT_LT(share_of_other_sources(by_grid, table), 2.0 / 32);
    std::printf("mapping %u: other pair than the table's: radial %.3f %%, grid of 8 px %.2f %%\n",
                mapping, 100 * share_of_other_sources(by_radius, table),
                100 * share_of_other_sources(by_grid, table));
  }
}

TEST(AddrgenTest, AHomographyMapsTheCornersOfItsPlane) {
  // x = (256 u + 40) / (256 + v): at v = 0 a picture at its own scale, at v = 256 at half of it.
  MappedJob m;
  Job& j = m.job;
  j.mode = Mode::kProject;
  j.pairs = 100;
  j.rows = 257;
  j.src_width = 400;
  j.src_height = 300;
  j.src_pitch = 200;
  j.a[0] = 40;
  j.a[1] = 512;
  j.b[2] = 256;
  j.c[0] = 256;
  j.c[2] = 1;
  AddrgenBench bench;
  const Outcome got = bench.run(j, {});
  expect_equal(addresses(j, {}), got.beats, j);
  const auto at = [&](unsigned pair, unsigned row) { return got.beats[row * 100 + pair].src; };
  EXPECT_EQ(at(0, 0), 0u);                  // 40 / 256 px
  EXPECT_EQ(at(99, 0), 99u);                // pixel 198.16
  EXPECT_EQ(at(99, 256), 128u * 200 + 49);  // pixel (99.08, 128)
}

TEST(AddrgenTest, AnAbandonedJobLeavesNothingBehind) {
  Dice dice(seed() + 1);
  AddrgenBench bench(seed() + 1);
  for (unsigned n = 0; n < 120; ++n) {
    const MappedJob first = random_job(dice, static_cast<Mode>(dice.to(3)));
    const MappedJob second = random_job(dice, static_cast<Mode>(dice.to(3)));
    const std::size_t limit = dice.to(static_cast<unsigned>(first.job.pairs * first.job.rows - 1));
    bench.run(first.job, first.map, {1 + dice.to(15), 1 + dice.to(15)}, limit);
    run_and_compare(bench, second, {1 + dice.to(15), 1 + dice.to(15)});
    if (HasFatalFailure()) FAIL() << "job " << n;
  }
}

TEST(AddrgenTest, JobsBeyondTheLimitsAreRefusedAndThoseAtTheLimitsAreNot) {
  AddrgenBench bench;
  Job good;
  good.pairs = 8;
  good.rows = 8;
  good.src_width = 16;
  good.src_height = 8;
  good.src_pitch = 8;
  const auto check = [&](bool refused, auto change) {
    Job job = good;
    change(job);
    EXPECT_EQ(bench.refused(job), refused);
    EXPECT_EQ(possible(job), !refused);
  };
  check(false, [](Job&) {});
  check(true, [](Job& j) { j.pairs = 0; });
  check(false, [](Job& j) { j.pairs = 2048; });
  check(true, [](Job& j) { j.pairs = 2049; });
  check(true, [](Job& j) { j.rows = 0; });
  check(false, [](Job& j) { j.rows = 4096; });
  check(true, [](Job& j) { j.rows = 4097; });
  check(true, [](Job& j) { j.src_width = 0; });
  check(true, [](Job& j) { j.src_width = 15; });
  check(true, [](Job& j) { j.src_width = 18; });  // wider than the pitch
  check(false, [](Job& j) { j.src_width = 4096, j.src_pitch = 2048; });
  check(true, [](Job& j) { j.src_width = 4098, j.src_pitch = 4095; });
  check(true, [](Job& j) { j.src_height = 0; });
  check(false, [](Job& j) { j.src_height = 4096; });
  check(true, [](Job& j) { j.src_height = 4097; });
  const auto grid = [](unsigned log2, unsigned pairs) {
    return [=](Job& j) { j.mode = Mode::kGrid, j.grid_log2 = log2, j.pairs = pairs; };
  };
  check(true, grid(1, 8));
  check(false, grid(2, 510));  // 256 nodes
  check(true, grid(2, 511));   // 257 nodes
  check(false, grid(6, 2048));
  check(true, grid(7, 8));
  for (const unsigned log2 : {2u, 3u})  // each number of nodes near the limit
    for (unsigned pairs = 200 << (log2 - 1); pairs < 260u << (log2 - 1); ++pairs)
      check(2 * pairs > 255u << log2, grid(log2, pairs));
  const auto radial = [](unsigned pieces, unsigned log2) {
    return [=](Job& j) { j.mode = Mode::kRadial, j.pieces = pieces, j.piece_log2 = log2; };
  };
  check(true, radial(0, 0));
  check(false, radial(128, 23));
  check(true, radial(129, 0));
  check(true, radial(1, 24));
  Dice dice(seed() + 4);
  for (unsigned n = 0; n < 2000; ++n) {
    const Job job = any_job(dice);
    ASSERT_EQ(bench.refused(job), !possible(job)) << "job " << n;
  }
}

/// One pair on the x axis, whose square radius in Q8 is as large as the limit, or larger by one of its bits.
TEST(AddrgenTest, EachBitOfTheRadiusLimitDecides) {
  Dice dice(seed() + 6);
  AddrgenBench bench;
  MappedJob m;
  Job& j = m.job;
  j.mode = Mode::kRadial;
  j.src_width = j.src_height = 4096;
  j.src_pitch = 2048;
  j.pieces = 128;
  j.piece_log2 = 23;
  m.map.assign(3 * 128, 0);
  for (unsigned n = 0; n < 128; ++n) m.map[3 * n] = 1 << 20;  // gain 1
  std::uint32_t bits = 0;
  for (unsigned n = 0; n < 60; ++n) {
    const std::uint32_t x = n == 0 ? 0x7'FFFF : dice.word() >> (13 + n % 12);  // Q8
    const auto square = static_cast<std::uint32_t>(std::uint64_t{x} * x >> 8);
    j.a[0] = static_cast<std::int32_t>(x << 8);
    bits |= square;
    j.radius_limit = square;
    EXPECT_FALSE(addresses(j, m.map).at(0).border);
    run_and_compare(bench, m);
    for (unsigned bit = 0; bit < 32; ++bit)
      if (square >> bit & 1) {
        j.radius_limit = square & ~(1u << bit);
        EXPECT_TRUE(addresses(j, m.map).at(0).border);
        run_and_compare(bench, m);
      }
  }
  EXPECT_EQ(bits, (1u << 30) - 1);
}

TEST(AddrgenTest, AJobAfterAResetInItsMiddleIsRight) {
  Dice dice(seed() + 5);
  AddrgenBench bench(seed() + 5);
  for (unsigned n = 0; n < 40; ++n) {
    const MappedJob first = random_job(dice, static_cast<Mode>(n % 4)),
                    second = random_job(dice, static_cast<Mode>(n / 4 % 4));
    const std::size_t limit = dice.to(static_cast<unsigned>(first.job.pairs * first.job.rows - 1));
    bench.run(first.job, first.map, {1 + dice.to(15), 1 + dice.to(15)}, limit, AddrgenBench::End::kReset);
    run_and_compare(bench, second);
    if (HasFatalFailure()) FAIL() << "job " << n;
  }
}

}  // namespace
}  // namespace fovea::rtl
