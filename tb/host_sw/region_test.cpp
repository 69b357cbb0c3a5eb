// A region of interest: where its edges come to lie on the display, and what cannot be one.
#include "sw/lens/region.h"

#include <gtest/gtest.h>

#include <ostream>

namespace {

constexpr unsigned kWidth = 720, kHeight = 576;

struct Case {
  const char* name;
  lens_region_t region;
  double scale;  ///< that touches the display's edges first
  double out_focal = 0, shift_x = 0, shift_y = 0, out_aspect = 1;
};

lens_view_t view_of(const Case& c) {
  lens_view_t view;
  lens_view_default(&view);
  view.out_focal_px = c.out_focal;
  view.shift_x = c.shift_x;
  view.shift_y = c.shift_y;
  view.out_aspect = c.out_aspect;
  view.centre_x = 4;
  return view;
}

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
class RegionTest : public testing::TestWithParam<Case> {};

// What the display shows at a position is what the picture without the region shows where that position lies in the
// grown rectangle. In edges of pixels: display 0 to width is the middle of the region, width / scale to each side.
TEST_P(RegionTest, FillsTheDisplayAboutItsCentre) {
  const Case& c = GetParam();
  lens_view_t whole_view = view_of(c), view = view_of(c);
  lens_t whole, lens;
  ASSERT_EQ(lens_init(&whole, &whole_view, kWidth, kHeight), LENS_OK);
  ASSERT_TRUE(lens_region_fits(&c.region, kWidth, kHeight));
  lens_show_region(&view, &whole, &c.region);
  ASSERT_EQ(lens_init(&lens, &view, kWidth, kHeight), LENS_OK);
  EXPECT_NEAR(lens_region_scale(&c.region, kWidth, kHeight), c.scale, 1e-12);
  const double left = c.region.left + c.region.width / 2 - kWidth / 2.0 / c.scale;
  const double top = c.region.top + c.region.height / 2 - kHeight / 2.0 / c.scale;
  for (const double x : {0.0, 100.0, kWidth / 2.0, kWidth / 1.0})
    for (const double y : {0.0, 77.0, kHeight / 2.0, kHeight / 1.0}) {
      const lens_point_t got = lens_source(&lens, x - 0.5, y - 0.5);
      const lens_point_t expected = lens_source(&whole, left + x / c.scale - 0.5, top + y / c.scale - 0.5);
      EXPECT_NEAR(got.column, expected.column, 1e-9) << x << " " << y;
      EXPECT_NEAR(got.row, expected.row, 1e-9) << x << " " << y;
    }
}
INSTANTIATE_TEST_SUITE_P(
    Of, RegionTest,
    testing::Values(Case{"TheWholePicture", {0, 0, 720, 576}, 1}, Case{"AQuarterAbove", {0, 0, 360, 288}, 2},
                    Case{"TheSmallest", {540, 432, 180, 144}, 4}, Case{"AWideStrip", {100, 10, 480, 20}, 1.5},
                    Case{"ATallStrip", {700, 0, 20, 288}, 2}, Case{"OfAnotherScale", {90, 72, 360, 288}, 2, 300},
                    Case{"OfAShiftedView", {90, 72, 360, 288}, 2, 0, 31, -17},
                    Case{"OfAnotherShape", {11, 72, 200, 288}, 2, 250, 3, 5, 1.25}),
    [](const auto& i) { return i.param.name; });

TEST(RegionLimitsTest, ARegionLiesInThePictureAndIsNotTooSmall) {
  const auto fits = [](double left, double top, double width, double height) {
    const lens_region_t r{left, top, width, height};
    return lens_region_fits(&r, kWidth, kHeight) != 0;
  };
  EXPECT_TRUE(fits(0, 0, 720, 576));
  EXPECT_FALSE(fits(1, 0, 720, 576));
  EXPECT_FALSE(fits(0, 1, 720, 576));
  EXPECT_TRUE(fits(360, 288, 360, 288));
  EXPECT_FALSE(fits(361, 288, 360, 288));
  EXPECT_FALSE(fits(360, 289, 360, 288));
  EXPECT_FALSE(fits(-1, 0, 360, 288));
  EXPECT_FALSE(fits(0, -1, 360, 288));
  EXPECT_TRUE(fits(0, 0, 180, 1)) << "a quarter of one side is enough";
  EXPECT_TRUE(fits(0, 0, 1, 144));
  EXPECT_FALSE(fits(0, 0, 179, 143));
  EXPECT_FALSE(fits(0, 0, 720, 0));
  EXPECT_FALSE(fits(0, 0, -180, 144));
  EXPECT_FALSE(fits(0, 0, 180, -144));
}

}  // namespace
