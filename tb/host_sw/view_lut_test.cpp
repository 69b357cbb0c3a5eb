// Tables of composed views against the oracle, in double precision and in fixed point.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "model/video/scene/mount.h"
#include "sw/lens/view_lut.h"
#include "tb/oracle/view_oracle.h"

namespace fovea {
namespace {

struct Setting {
  oracle::Views views;
  std::array<lens_view_t, 4> lens;
  unsigned width() const { return views.lens[0].width; }
  unsigned height() const { return views.lens[0].height; }
  unsigned pitch() const { return views.lens[0].pitch_bytes; }
};

/// Four lenses that differ in mapping, centre, aspect and view.
Setting setting(unsigned width, unsigned height, bool birds_eye, bool quad = false, bool method_b = false) {
  Setting s;
  s.views.birds_eye = birds_eye;
  s.views.quad = quad;
  const std::array<unsigned, 4> mapping{LENS_EQUISOLID, LENS_LINEAR, LENS_STEREOGRAPHIC, LENS_TABLE};
  for (unsigned n = 0; n < 4; ++n) {
    oracle::Geometry& g = s.views.lens[n];
    lens_view_t& l = s.lens[n];
    g.width = width;
    g.height = height;
    g.pitch_bytes = (width * 2 + 31) / 32 * 32;
    g.method = method_b ? oracle::PairMethod::kPairCentre : oracle::PairMethod::kFirstPixel;
    lens_view_default(&l);
    l.pair_method = method_b ? PAIR_CENTRE : PAIR_FIRST_PIXEL;
    l.mapping = mapping[n];
    g.mapping = std::array{oracle::Mapping::kEquisolid, oracle::Mapping::kLinear, oracle::Mapping::kStereographic,
                           oracle::Mapping::kTable}[n];
    l.fov_deg = g.fov_deg = 170 + 5 * n;
    l.centre_x = g.centre_x = 1.3 * n - 2;
    l.centre_y = g.centre_y = 3.7 - 2.1 * n;
    l.in_aspect = g.in_aspect = 1 + 0.04 * n;
    l.out_focal_px = g.out_focal_px = width * (0.25 + 0.05 * n);
    l.shift_x = g.shift_x = n == 1 ? 9.25 : 0;
    l.shift_y = g.shift_y = n == 2 ? -4.5 : 0;
  }
  lens_view_t& table = s.lens[3];
  oracle::Geometry& g = s.views.lens[3];
  table.theta_max = g.theta_max = 1.5;
  table.table_count = PARAM_TABLE_MAX;
  for (unsigned i = 0; i < PARAM_TABLE_MAX; ++i) {
    const double t = 1.5 * i / (PARAM_TABLE_MAX - 1);
    table.table_r[i] = width / 3.0 * t * (1 - 0.04 * t * t);
    g.table_r.push_back(table.table_r[i]);
  }
  table.focal_px = width / 3.0;
  g.focal_px = width / 3.0;
  s.views.mount = {{{2.3, 0.1, 0.7, 3, 40, 1}, {0.5, -1, 1, -88, 55, -2}, {-2.3, 0, 0.9, 179, 45, 0.5},
                    {0.6, 1.1, 1.05, 92, 50, 4}}};
  return s;
}

/// Lenses that end within the picture, and a rear camera that looks forward: much of its part is behind it.
void limit(Setting& s) {
  for (unsigned n = 0; n < 4; ++n) s.lens[n].theta_max = s.views.lens[n].theta_max = 0.7 + 0.1 * n;
  lens_view_t& table = s.lens[3];
  for (unsigned i = 0; i < PARAM_TABLE_MAX; ++i)
    s.views.lens[3].table_r[i] = table.table_r[i] = s.width() / 3.0 * i / (PARAM_TABLE_MAX - 1);
  s.lens[2].theta_max = s.views.lens[2].theta_max = 0;
  s.views.mount[2].yaw = 60;
}

view_rectangle_t car_of(const Setting& s) {
  const double x = (s.width() - 1) / 2.0, y = (s.height() - 1) / 2.0;
  const double across = s.views.car_width / 2 / s.views.ground_width * s.width();
  const double along = s.views.car_length / 2 / s.views.ground_height * s.height();
  return {x - across, y - along, x + across, y + along};
}

/// The table as the firmware builds it.
std::vector<std::uint32_t> build(const Setting& s, bool fixed_point) {
  const unsigned pairs = s.width() / 2;
  std::vector<std::uint32_t> lut(std::size_t{pairs} * s.height(), lens_black_offset(s.height(), s.pitch()));
  const view_rectangle_t car = car_of(s);
  for (unsigned n = 0; n < 4; ++n) {
    lens_t lens, wide;
    EXPECT_EQ(lens_init(&lens, &s.lens[n], s.width(), s.height()), LENS_OK);
    view_map_t map{};
    map.lens = &lens;
    map.pitch_bytes = s.pitch();
    if (s.views.quad) map.place = {1, n % 2 * s.width() / 2, n / 2 * s.height() / 2};
    if (s.views.birds_eye) {
      const oracle::CarCamera& c = s.views.mount[n];
      const auto m = video::ray_matrix({s.width(), s.height(), s.views.ground_width, s.views.ground_height},
                                       {c.x, c.y, c.height, c.yaw, c.pitch, c.roll});
      std::copy(m.begin(), m.end(), map.m);
    } else {
      view_map_half(&map, &lens, n % 2 * s.width() / 2, n / 2 * s.height() / 2);
    }
    static fast_lut_t fast;
    if (fixed_point) {
      EXPECT_EQ(view_map_fixed_point(&map, &fast, &wide), FAST_LUT_OK) << n;
    }
    for (unsigned v = 0; v < s.height(); ++v) {
      view_span_t spans[VIEW_SPANS_MAX];
      const unsigned count = s.views.birds_eye
                                 ? view_birds_eye_row(&car, lens.pair_method_b, pairs, v, spans)
                                 : view_four_way_row(pairs, s.height(), v, spans);
      unsigned first = 0;
      for (unsigned i = 0; i < count; first = spans[i++].end)
        if (spans[i].camera == n)
          view_map_row(&map, v, first, spans[i].end, lut.data() + std::size_t{v} * pairs + first);
    }
  }
  return lut;
}

struct Case {
  const char* name;
  unsigned width, height;
  bool birds_eye, quad, method_b, limited;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
class ViewLutTest : public testing::TestWithParam<Case> {};
TEST_P(ViewLutTest, IsTheOraclesInBothPrecisions) {
  const Case& c = GetParam();
  Setting s = setting(c.width, c.height, c.birds_eye, c.quad, c.method_b);
  if (c.limited) limit(s);
  const auto exact = build(s, false);
  // Both compute in double precision, in different ways.
  const oracle::LutCheck check = oracle::check_view(exact, s.views, 0.001);
  EXPECT_EQ(check.wrong, 0u) << check.first_wrong->text();
  EXPECT_LT(check.near_boundary, check.entries / 1000);
  EXPECT_GT(std::ranges::count_if(exact, [&](auto e) { return e != lens_black_offset(c.height, s.pitch()); }),
            static_cast<long>(exact.size() / (c.limited ? 20 : 3)));
  EXPECT_EQ(build(s, true), exact);
}
INSTANTIATE_TEST_SUITE_P(Views, ViewLutTest,
                         testing::Values(Case{"FourWay", 720, 576, false, false, false, false},
                                         Case{"FourWayCentres", 188, 48, false, false, true, false},
                                         Case{"FourWayQuad", 320, 240, false, true, false, false},
                                         Case{"BirdsEye", 720, 576, true, false, false, false},
                                         Case{"BirdsEyeCentres", 320, 240, true, false, true, false},
                                         Case{"BirdsEyeQuad", 720, 480, true, true, false, false},
                                         Case{"FourWayLimited", 320, 240, false, false, false, true},
                                         Case{"BirdsEyeLimited", 320, 240, true, false, false, true}),
                         [](const auto& i) { return i.param.name; });

TEST(ViewLut, TheCheckComplainsOfWhatIsWrong) {
  const Setting s = setting(160, 120, true);
  auto lut = build(s, true);
  for (const std::size_t at : {std::size_t{0}, std::size_t{60 * 80 + 5}, lut.size() - 1}) {
    auto wrong = lut;
    wrong[at] += 4;
    EXPECT_EQ(oracle::check_view(wrong, s.views).wrong, 1u) << at;
  }
  Setting other = s;
  other.views.mount[1].yaw += 0.2;
  EXPECT_GT(oracle::check_view(lut, other.views).wrong, 100u);
  other = s;
  other.views.car_width += 0.3;
  EXPECT_GT(oracle::check_view(lut, other.views).wrong, 100u);
  lut.pop_back();
  EXPECT_EQ(oracle::check_view(lut, s.views).wrong, 1u);
}

/// The spans of a row as one camera a pair.
std::vector<unsigned> cameras_in(unsigned count, const view_span_t* spans) {
  std::vector<unsigned> out;
  for (unsigned i = 0; i < count; ++i) out.resize(spans[i].end, spans[i].camera);
  return out;
}

TEST(ViewLut, SeamsBeginAtTheCorners) {
  // Pairs at u = 0, 2, ... 18; the car covers u from 6 to 12 and v from 4 to 8.
  const view_rectangle_t car{6, 4, 12, 8};
  view_span_t spans[VIEW_SPANS_MAX];
  const auto row = [&](unsigned v, bool b = false) {
    return cameras_in(view_birds_eye_row(&car, b, 10, v, spans), spans);
  };
  using V = std::vector<unsigned>;
  const unsigned F = VIEW_FRONT, R = VIEW_RIGHT, B = VIEW_REAR, L = VIEW_LEFT, N = VIEW_NO_CAMERA;
  EXPECT_EQ(row(4), (V{L, L, L, F, F, F, F, R, R, R}));  // on the car's edge, and on the corners
  EXPECT_EQ(row(3), (V{L, L, L, F, F, F, F, R, R, R}));  // seams at 5 and 13
  EXPECT_EQ(row(2), (V{L, L, F, F, F, F, F, F, R, R}));  // at 4 and 14, the pairs there are in front
  EXPECT_EQ(row(5), (V{L, L, L, N, N, N, N, R, R, R}));
  EXPECT_EQ(row(5, true), (V{L, L, L, N, N, N, R, R, R, R}));  // 12.5 is beside the car
  EXPECT_EQ(row(8), (V{L, L, L, B, B, B, B, R, R, R}));
  EXPECT_EQ(row(14), (V(10, B)));  // at 0 and 18
  EXPECT_EQ(row(13), (V{L, B, B, B, B, B, B, B, B, R}));
  EXPECT_EQ(row(100), (V(10, B)));
  const view_rectangle_t none{9, 6, 9, 6};
  EXPECT_EQ(cameras_in(view_birds_eye_row(&none, 0, 10, 6, spans), spans), (V{L, L, L, L, L, R, R, R, R, R}));
  EXPECT_EQ(cameras_in(view_four_way_row(10, 8, 3, spans), spans), (V{0, 0, 0, 0, 0, 1, 1, 1, 1, 1}));
  EXPECT_EQ(cameras_in(view_four_way_row(10, 8, 4, spans), spans), (V{2, 2, 2, 2, 2, 3, 3, 3, 3, 3}));
}

TEST(ViewLut, WithoutALensTheQuarterIsThePictureItself) {
  lens_view_t view;
  lens_view_default(&view);
  view.mapping = LENS_NONE;
  lens_t lens;
  ASSERT_EQ(lens_init(&lens, &view, 32, 16), LENS_OK);
  view_map_t map{};
  map.pitch_bytes = 64;
  view_map_half(&map, &lens, 16, 8);
  std::array<std::uint32_t, 8> row;
  view_map_row(&map, 9, 8, 16, row.data());
  // Pixel (2 k, 1) of the half picture is at (4 k + 0.5, 2.5), which rounds up.
  for (unsigned k = 0; k < 8; ++k) EXPECT_EQ(row[k], 3 * 64u + (4 * k + 1) / 2 * 4) << k;
}

/// A camera that is turned about the vertical axis: in the row of the axis the third component of a direction is
/// 1 + u / 2.
TEST(ViewLut, DirectionsAreDividedByTheirDepth) {
  const Setting s = setting(64, 32, false, false, false);
  lens_t lens;
  ASSERT_EQ(lens_init(&lens, &s.lens[0], s.width(), s.height()), LENS_OK);
  view_map_t turned{}, flat{};
  turned.lens = flat.lens = &lens;
  const double of_turned[] = {1, 0, 0, 0, 1, 0, 0.5, 0, 1}, of_flat[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::copy(std::begin(of_turned), std::end(of_turned), turned.m);
  std::copy(std::begin(of_flat), std::end(of_flat), flat.m);
  for (const double u : {-0.4, 0.25, 0.5}) {
    const lens_point_t got = view_map_source(&turned, u, 0), wanted = view_map_source(&flat, u / (1 + u / 2), 0);
    ASSERT_TRUE(got.visible && wanted.visible) << u;
    EXPECT_NEAR(got.column, wanted.column, 1e-9) << u;
    EXPECT_NEAR(got.row, wanted.row, 1e-9) << u;
    EXPECT_GT(std::abs(view_map_source(&flat, u, 0).column - wanted.column), 0.1) << "it makes a difference";
  }
}

/// To the nearest unit, on both sides of 0.
TEST(ViewLut, TheCentreOfTheLensIsRoundedToFixedPoint) {
  const Setting s = setting(64, 32, false, false, false);
  lens_t lens, wide;
  static fast_lut_t fast;
  ASSERT_EQ(lens_init(&lens, &s.lens[0], s.width(), s.height()), LENS_OK);
  constexpr double kUnit = 1.0 / (1u << FAST_LUT_FRACTION);
  for (const double quarters : {0.0, 0.25, 0.75}) {
    lens.centre_x = -100 - quarters * kUnit;  // 31.5 + 0.5 before
    lens.centre_y = 3 + quarters * kUnit;     // 15.5 + 0.5 before
    view_map_t map{};
    view_map_half(&map, &lens, 0, 0);
    ASSERT_EQ(view_map_fixed_point(&map, &fast, &wide), FAST_LUT_OK);
    const int up = quarters > 0.5;
    EXPECT_EQ(map.centre_column, -68 * (1 << FAST_LUT_FRACTION) - up) << quarters;
    EXPECT_EQ(map.centre_row, 19 * (1 << FAST_LUT_FRACTION) + up) << quarters;
  }
}

TEST(ViewPage, EveryFaultIsNamed) {
  view_page_t page{};
  page.view = VIEW_BIRDS_EYE;
  view_page_seal(&page);
  EXPECT_EQ(view_page_fault(&page), nullptr);
  const auto fault = [](view_page_t p) {
    const char* text = view_page_fault(&p);
    return std::string(text ? text : "");
  };
  view_page_t p = page;
  p.magic ^= 1;
  EXPECT_NE(fault(p).find("magic"), std::string::npos);
  p = page;
  ++p.version;
  EXPECT_NE(fault(p).find("version"), std::string::npos);
  p = page;
  p.bytes -= 4;
  EXPECT_NE(fault(p).find("size"), std::string::npos);
  p = page;
  p.ground[3][8] = 1;
  EXPECT_NE(fault(p).find("checksum"), std::string::npos);
  for (const std::uint32_t view : {std::uint32_t{VIEW_SINGLE}, VIEW_BIRDS_EYE + 1u}) {
    p = page;
    p.view = view;
    view_page_seal(&p);
    EXPECT_NE(fault(p).find("unknown view"), std::string::npos);
  }
  p = page;
  p.source = VIEW_QUAD + 1;
  view_page_seal(&p);
  EXPECT_NE(fault(p).find("unknown source"), std::string::npos);
}

}  // namespace
}  // namespace fovea
