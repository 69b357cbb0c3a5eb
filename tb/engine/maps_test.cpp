// The firmware's jobs and maps for the engine against those of the golden model's tests, which are computed on their
// own, and against the definition in rtl/README.md.
#include <gtest/gtest.h>

#include <cmath>

#include "sw/remap/engine_map.h"
#include "tb/rtl/lens_maps.h"

namespace fovea::engine {
namespace {

using rtl::MappedJob;

struct View {
  const char* name;
  lens_view_t view;
  unsigned width = 720, height = 576;
};

lens_view_t view_of(unsigned mapping, double fov, double shift_x = 0, double shift_y = 0) {
  lens_view_t v;
  lens_view_default(&v);
  v.mapping = mapping;
  v.fov_deg = fov;
  v.shift_x = shift_x;
  v.shift_y = shift_y;
  return v;
}

std::vector<View> views() {
  lens_view_t narrow = view_of(LENS_STEREOGRAPHIC, 150, -31, 12.5);
  narrow.pair_method = PAIR_CENTRE;
  narrow.in_aspect = 1.09;
  narrow.out_aspect = 0.95;
  narrow.out_focal_px = 210;
  narrow.centre_x = 3.25;
  narrow.centre_y = -7;
  return {{"paper", view_of(LENS_EQUISOLID, 180)},
          {"narrow", narrow, 640, 480},
          {"linear", view_of(LENS_LINEAR, 170, 41.5), 128, 48},
          {"smallest", view_of(LENS_ORTHOGRAPHIC, 160), 4, 4}};
}

/// The words of the job window that follow from the golden model's job (table of rtl/README.md).
std::vector<std::uint32_t> window(const rtl::Job& j, unsigned pitch_bytes) {
  std::vector<std::uint32_t> w = {static_cast<unsigned>(j.mode), j.pairs | j.rows << 16, 0, pitch_bytes,
                                  j.src_width | j.src_height << 16, 0, pitch_bytes, 0,
                                  static_cast<std::uint32_t>(rtl::map_words(j)), 0x10801080, j.radius_limit,
                                  static_cast<std::uint32_t>(j.centre_x), static_cast<std::uint32_t>(j.centre_y)};
  if (j.mode == rtl::Mode::kGrid) w[0] |= j.grid_log2 << 8;
  if (j.mode == rtl::Mode::kRadial) w[0] |= j.pieces << 16 | j.piece_log2 << 24;
  for (const auto* form : {&j.a, &j.b, &j.c})
    for (const std::int32_t k : *form) w.push_back(static_cast<std::uint32_t>(k));
  return w;
}

std::vector<std::uint32_t> words(const remap_engine_job_t& job) {
  const auto* first = reinterpret_cast<const std::uint32_t*>(&job);
  return {first, first + sizeof job / 4};
}

TEST(EngineMaps, AreThoseOfTheGoldenModelsTests) {
  for (const View& v : views()) {
    SCOPED_TRACE(v.name);
    lens_t lens;
    ASSERT_EQ(lens_init(&lens, &v.view, v.width, v.height), LENS_OK);
    const unsigned pitch = (2 * v.width + 31) / 32 * 32;
    EXPECT_EQ(words(remap_engine_table(v.width, v.height, pitch)), window(rtl::table_job(lens).job, pitch));

    remap_engine_job_t job;
    const MappedJob grid = rtl::grid_job(lens, REMAP_ENGINE_GRID_LOG2);
    std::vector<std::uint32_t> map(remap_engine_grid_words(v.width, v.height) + 1, 0x5A5A5A5A);
    ASSERT_EQ(remap_engine_grid(&lens, pitch, &job, map.data()), nullptr);
    EXPECT_EQ(words(job), window(grid.job, pitch));
    ASSERT_EQ(map.size(), grid.map.size() + 1);
    EXPECT_EQ(map.back(), 0x5A5A5A5Au);
    map.pop_back();
    EXPECT_EQ(map, grid.map);

    const MappedJob radial = rtl::radial_job(lens);
    map.assign(REMAP_ENGINE_RADIAL_WORDS_MAX, 0);
    ASSERT_EQ(remap_engine_radial(&lens, pitch, &job, map.data()), nullptr);
    EXPECT_EQ(words(job), window(radial.job, pitch));
    map.resize(job.map_words);
    EXPECT_EQ(map, radial.map);
  }
}

TEST(EngineMaps, LensesThatTheEngineCannotExpressAreRefused) {
  std::vector<std::uint32_t> map(4096);
  remap_engine_job_t job;
  const auto refusals = [&](const lens_view_t& view) -> std::pair<std::string, std::string> {
    lens_t lens;
    EXPECT_EQ(lens_init(&lens, &view, 720, 576), LENS_OK);
    const char* grid = remap_engine_grid(&lens, 1440, &job, map.data());
    const char* radial = remap_engine_radial(&lens, 1440, &job, map.data());
    return {grid ? grid : "", radial ? radial : ""};
  };
  lens_view_t v = view_of(LENS_EQUISOLID, 180);
  v.theta_max = 1;
  EXPECT_EQ(refusals(v).first, "a grid cannot express the largest visible angle");
  EXPECT_EQ(refusals(v).second, "");
  v.theta_max = 1.5;  // beyond all nodes: the corner is at 62 degrees
  EXPECT_EQ(refusals(v).first, "");
  EXPECT_EQ(refusals(view_of(LENS_NONE, 180)).first, "");
  EXPECT_EQ(refusals(view_of(LENS_NONE, 180)).second, "a mapping is needed, and the page has none");
  // An offset of -2048 px or less does not fit; -2047 px do.
  EXPECT_EQ(refusals(view_of(LENS_NONE, 180, 2047)).first, "");
  EXPECT_EQ(refusals(view_of(LENS_NONE, 180, 2048)).first, "the view does not fit into the engine's numbers");
  // X reaches from (0 - 359.5 + shift) to (720 - 359.5 + shift) px; 2047 px is the limit.
  EXPECT_EQ(refusals(view_of(LENS_EQUISOLID, 180, 1686)).second, "");
  EXPECT_EQ(refusals(view_of(LENS_EQUISOLID, 180, 1687)).second, "the view does not fit into the engine's numbers");
}

// A centre is a number of 32 bits with 16 behind the point. Neither end of their range is used.
TEST(EngineMaps, NumbersAreWithinTheirBits) {
  std::vector<std::uint32_t> map(4096);
  const auto refusal = [&](double centre) -> std::string {
    lens_t lens;
    const lens_view_t view = view_of(LENS_EQUISOLID, 180);
    EXPECT_EQ(lens_init(&lens, &view, 720, 576), LENS_OK);
    lens.centre_x = centre - 359.5;
    remap_engine_job_t job;
    const char* why = remap_engine_radial(&lens, 1440, &job, map.data());
    return why ? why : std::to_string(static_cast<std::int32_t>(job.centre_x));
  };
  constexpr double kLast = 1.0 / 65536;
  const char* const does_not_fit = "the view does not fit into the engine's numbers";
  EXPECT_EQ(refusal(-32768), does_not_fit);
  EXPECT_EQ(refusal(-32768 + kLast), "-2147483647");
  EXPECT_EQ(refusal(32768 - 2 * kLast), "2147483646");
  EXPECT_EQ(refusal(32768 - kLast), does_not_fit);
}

}  // namespace
}  // namespace fovea::engine
