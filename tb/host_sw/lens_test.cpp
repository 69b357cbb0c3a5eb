// Lens formulas against figures computed independently from the definitions of the mappings.
#include "sw/lens/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace {

constexpr double kPi = 3.14159265358979323846;

lens_view_t view_of(std::uint32_t mapping, double fov_deg) {
  lens_view_t view;
  lens_view_default(&view);
  view.mapping = mapping;
  view.fov_deg = fov_deg;
  return view;
}

lens_t lens_of(const lens_view_t& view, unsigned width = 720, unsigned height = 576) {
  lens_t lens;
  EXPECT_EQ(lens_init(&lens, &view, width, height), LENS_OK);
  return lens;
}

lens_t lens_of(lens_view_t&&, unsigned = 0, unsigned = 0) = delete;  // the view must live

struct FocalRow {
  double fov, printed, equisolid, linear, ortho, stereo;
};
// Table of section 1.9, W = 720; 0: the mapping cannot.
constexpr FocalRow kFocals[] = {
    {100, 234.97, 425.92, 412.53, 469.95, 386.01}, {120, 207.85, 360.00, 343.77, 415.69, 311.77},
    {150, 186.35, 295.68, 275.02, 372.70, 234.58}, {170, 180.69, 266.43, 242.66, 361.38, 196.44},
    {180, 180.00, 254.56, 229.18, 360.00, 180.00}, {190, 180.69, 244.14, 217.12, 0, 164.94},
    {220, 191.55, 219.74, 187.51, 0, 126.04}};

TEST(LensFocalTest, MatchesTheTableOfFocalLengths) {
  for (const FocalRow& row : kFocals) {
    SCOPED_TRACE(row.fov);
    EXPECT_NEAR(lens_focal_from_fov(LENS_EQUISOLID, 720, row.fov, 1), row.printed, 0.005);
    EXPECT_NEAR(lens_focal_from_fov(LENS_EQUISOLID, 720, row.fov, 0), row.equisolid, 0.005);
    EXPECT_NEAR(lens_focal_from_fov(LENS_LINEAR, 720, row.fov, 0), row.linear, 0.005);
    EXPECT_NEAR(lens_focal_from_fov(LENS_ORTHOGRAPHIC, 720, row.fov, 0), row.ortho, 0.005);
    EXPECT_NEAR(lens_focal_from_fov(LENS_STEREOGRAPHIC, 720, row.fov, 0), row.stereo, 0.005);
  }
}

TEST(LensFocalTest, PaperLiteralTouchesOnlyTheEquisolidMapping) {
  for (std::uint32_t mapping :
       {LENS_RECTILINEAR, LENS_LINEAR, LENS_ORTHOGRAPHIC, LENS_STEREOGRAPHIC})
    EXPECT_EQ(lens_focal_from_fov(mapping, 720, 120, 1), lens_focal_from_fov(mapping, 720, 120, 0));
}

TEST(LensFocalTest, ImpossibleFieldsOfViewGiveNone) {
  EXPECT_EQ(lens_focal_from_fov(LENS_RECTILINEAR, 720, 180, 0), 0);
  EXPECT_EQ(lens_focal_from_fov(LENS_ORTHOGRAPHIC, 720, 180.1, 0), 0);
  EXPECT_EQ(lens_focal_from_fov(LENS_EQUISOLID, 720, 360, 0), 0);
  EXPECT_EQ(lens_focal_from_fov(LENS_LINEAR, 720, 360, 0), 0);
  EXPECT_EQ(lens_focal_from_fov(LENS_STEREOGRAPHIC, 720, 360, 0), 0);
  EXPECT_GT(lens_focal_from_fov(LENS_RECTILINEAR, 720, 179.9, 0), 0);
  EXPECT_GT(lens_focal_from_fov(LENS_ORTHOGRAPHIC, 720, 180, 0), 0);
  EXPECT_GT(lens_focal_from_fov(LENS_EQUISOLID, 720, 359.9, 0), 0);
  EXPECT_GT(lens_focal_from_fov(LENS_LINEAR, 720, 359.9, 0), 0);
  EXPECT_GT(lens_focal_from_fov(LENS_STEREOGRAPHIC, 720, 359.9, 0), 0);
  EXPECT_EQ(lens_focal_from_fov(LENS_LINEAR, 720, 0, 0), 0);
  EXPECT_EQ(lens_focal_from_fov(LENS_LINEAR, 720, -10, 0), 0);
  EXPECT_EQ(lens_focal_from_fov(LENS_LINEAR, 720, std::nan(""), 0), 0);
  EXPECT_EQ(lens_focal_from_fov(LENS_TABLE, 720, 180, 0), 0);
}

TEST(LensFocalTest, HalfTheFieldOfViewLandsOnThePictureEdge) {
  for (std::uint32_t mapping :
       {LENS_LINEAR, LENS_ORTHOGRAPHIC, LENS_EQUISOLID, LENS_STEREOGRAPHIC, LENS_RECTILINEAR}) {
    const lens_view_t view = view_of(mapping, 140);
    const lens_t lens = lens_of(view);
    EXPECT_NEAR(lens_radius(&lens, 70 * kPi / 180), 360.0, 1e-9) << mapping;
  }
}

struct EdgeRow {
  std::uint32_t mapping;
  double right_edge, corner;
};
// Table of section 1.3: FOV 180, F = f, radii of the source at the output's right edge and corner.
constexpr EdgeRow kEdges[] = {{LENS_LINEAR, 230.1, 254.3},
                              {LENS_ORTHOGRAPHIC, 254.6, 283.7},
                              {LENS_EQUISOLID, 234.0, 258.8},
                              {LENS_STEREOGRAPHIC, 222.5, 245.9}};

TEST(LensSourceTest, RadiiAtEdgeAndCornerMatchTheTable) {
  for (const EdgeRow& row : kEdges) {
    SCOPED_TRACE(row.mapping);
    const lens_view_t view = view_of(row.mapping, 180);
    const lens_t lens = lens_of(view);
    // The table's edge is W/2 and its corner (W/2, H/2) from the centre: half a pixel outside.
    const lens_point_t edge = lens_source(&lens, 719.5, 287.5);
    EXPECT_NEAR(edge.column - 359.5, row.right_edge, 0.06);
    EXPECT_DOUBLE_EQ(edge.row, 287.5);
    const lens_point_t corner = lens_source(&lens, 719.5, 575.5);
    EXPECT_NEAR(std::hypot(corner.column - 359.5, corner.row - 287.5), row.corner, 0.06);
  }
}

TEST(LensSourceTest, TrigFreeFormsEqualTheDefinitions) {
  for (std::uint32_t mapping :
       {LENS_RECTILINEAR, LENS_LINEAR, LENS_ORTHOGRAPHIC, LENS_EQUISOLID, LENS_STEREOGRAPHIC}) {
    const lens_view_t view = view_of(mapping, 130);
    const lens_t lens = lens_of(view);
    for (double r = 1e-6; r < 20; r *= 1.7)
      EXPECT_NEAR(lens_gain(&lens, r * r) * r, lens_radius(&lens, std::atan(r)),
                  1e-9 * (1 + 300 * r))
          << mapping << " r " << r;
  }
}

TEST(LensSourceTest, EquisolidRoundTripThroughThePapersForwardFormula) {
  const lens_view_t view = view_of(LENS_EQUISOLID, 170);
  const lens_t lens = lens_of(view);
  const double f = lens.focal;
  for (double radius = 0.5; radius < 430; radius += 13.7) {
    const double source = lens_gain(&lens, radius / f * (radius / f)) * radius / f;
    EXPECT_NEAR(f * std::tan(2 * std::asin(source / (2 * f))), radius, 1e-8);
  }
}

TEST(LensSourceTest, PointsStayOnTheirRadius) {
  const lens_view_t view = view_of(LENS_STEREOGRAPHIC, 160);
  const lens_t lens = lens_of(view);
  for (double u = 3; u < 720; u += 101)
    for (double v = 1; v < 576; v += 97) {
      const lens_point_t p = lens_source(&lens, u, v);
      EXPECT_NEAR((p.column - 359.5) * (v - 287.5), (p.row - 287.5) * (u - 359.5), 1e-7);
    }
}

TEST(LensSourceTest, WiderThan180DegreesIsSafe) {
  for (std::uint32_t mapping : {LENS_LINEAR, LENS_EQUISOLID, LENS_STEREOGRAPHIC}) {
    const lens_view_t view = view_of(mapping, 190);
    const lens_t lens = lens_of(view);
    for (double u : {0.0, 359.5, 719.0}) {
      const lens_point_t p = lens_source(&lens, u, 0);
      EXPECT_TRUE(p.visible);
      EXPECT_TRUE(std::isfinite(p.column) && std::isfinite(p.row));
      EXPECT_LT(std::hypot(p.column - 359.5, p.row - 287.5), 360.0);
    }
  }
}

TEST(LensSourceTest, OnTheAxisTheSourceIsTheOpticalCentre) {
  for (std::uint32_t mapping :
       {LENS_LINEAR, LENS_ORTHOGRAPHIC, LENS_EQUISOLID, LENS_STEREOGRAPHIC, LENS_RECTILINEAR}) {
    lens_view_t view = view_of(mapping, 120);
    view.centre_x = 7.25;
    view.centre_y = -3.5;
    view.shift_x = 0.5;  // brings pixel (359, 287) onto the axis
    view.shift_y = 0.5;
    const lens_t lens = lens_of(view);
    const lens_point_t p = lens_source(&lens, 359, 287);
    EXPECT_DOUBLE_EQ(p.column, 359.5 + 7.25);
    EXPECT_DOUBLE_EQ(p.row, 287.5 - 3.5);
  }
}

TEST(LensSourceTest, AspectsScaleTheVerticalDirections) {
  lens_view_t view = view_of(LENS_RECTILINEAR, 90);
  view.in_aspect = 1.25;
  view.out_aspect = 0.8;
  view.out_focal_px = 2 * 360.0;  // lens focal is 720 / (2 tan 45) = 360: zoom 2
  const lens_t lens = lens_of(view);
  const lens_point_t p = lens_source(&lens, 359.5 + 100, 287.5 + 40);
  EXPECT_NEAR(p.column, 359.5 + 50, 1e-9);
  EXPECT_NEAR(p.row, 287.5 + 1.25 * 40 / (2 * 0.8), 1e-9);
}

TEST(LensSourceTest, ThetaMaxHidesWhatLiesBeyond) {
  lens_view_t view = view_of(LENS_LINEAR, 180);
  view.theta_max = 45 * kPi / 180;
  const lens_t lens = lens_of(view);
  const double reach = lens.out_focal;  // tan 45 = 1
  EXPECT_TRUE(lens_source(&lens, 359.5 + reach - 1e-6, 287.5).visible);
  EXPECT_FALSE(lens_source(&lens, 359.5 + reach + 1e-6, 287.5).visible);
}

TEST(LensSourceTest, NoneShowsThePictureShifted) {
  lens_view_t view = view_of(LENS_NONE, 0);
  view.shift_x = 6;
  view.shift_y = -2;
  view.centre_x = 99;  // no effect
  const lens_t lens = lens_of(view);
  const lens_point_t p = lens_source(&lens, 100, 200);
  EXPECT_EQ(p.column, 106);
  EXPECT_EQ(p.row, 198);
}

TEST(LensSqrtTest, IsWithinTwoUnitsInTheLastPlace) {
  double worst = 0;
  const auto check = [&](double x) {
    const double exact = std::sqrt(x), unit = std::nextafter(exact, HUGE_VAL) - exact;
    worst = std::max(worst, std::abs(lens_sqrt(x) - exact) / unit);
  };
  for (double x = 1e-12; x < 1e12; x *= 1.00037) check(x);
  for (double edge : {0.25, 0.5, 1.0, 2.0, 4.0, 1e-300, 1e300})
    for (double x : {std::nextafter(edge, 0.0), edge, std::nextafter(edge, HUGE_VAL)}) check(x);
  EXPECT_LE(worst, 2.0);
  EXPECT_EQ(lens_sqrt(0.0), 0.0);
}

TEST(LensTableTest, ReproducesAClosedForm) {
  lens_view_t view = view_of(LENS_TABLE, 0);
  view.table_count = PARAM_TABLE_MAX;
  view.theta_max = 95 * kPi / 180;
  const double f = 254.56;
  for (unsigned i = 0; i < view.table_count; ++i)
    view.table_r[i] = 2 * f * std::sin(i * view.theta_max / (view.table_count - 1) / 2);
  const lens_t lens = lens_of(view);
  // Linear interpolation errs by at most step^2 / 8 * |R''| = (95 deg / 128)^2 / 8 * f / 2 * sin.
  const double step = view.theta_max / 128, bound = step * step / 8 * f / 2;
  for (double theta = 0.01; theta < view.theta_max; theta += 0.013)
    EXPECT_NEAR(lens_radius(&lens, theta), 2 * f * std::sin(theta / 2), bound);
  EXPECT_DOUBLE_EQ(lens_radius(&lens, view.theta_max), view.table_r[view.table_count - 1]);
  EXPECT_DOUBLE_EQ(lens.focal, view.table_r[1] / step);
}

TEST(LensTableTest, EachFaultIsRefused) {
  lens_view_t view = view_of(LENS_TABLE, 0);
  lens_t lens;
  view.table_count = 3;
  view.theta_max = 1;
  view.table_r[1] = 100;
  view.table_r[2] = 200;
  EXPECT_EQ(lens_init(&lens, &view, 720, 576), LENS_OK);
  lens_view_t bad = view;
  bad.table_count = 1;
  EXPECT_EQ(lens_init(&lens, &bad, 720, 576), LENS_BAD_TABLE);
  bad = view;
  bad.table_count = PARAM_TABLE_MAX + 1;
  EXPECT_EQ(lens_init(&lens, &bad, 720, 576), LENS_BAD_TABLE);
  bad = view;
  bad.theta_max = 0;
  EXPECT_EQ(lens_init(&lens, &bad, 720, 576), LENS_BAD_TABLE);
  bad = view;
  bad.table_r[2] = 100;
  EXPECT_EQ(lens_init(&lens, &bad, 720, 576), LENS_BAD_TABLE);
  bad = view;
  bad.table_r[2] = std::nan("");
  EXPECT_EQ(lens_init(&lens, &bad, 720, 576), LENS_BAD_TABLE);
  bad = view;
  bad.table_r[0] = 1;
  EXPECT_EQ(lens_init(&lens, &bad, 720, 576), LENS_BAD_TABLE);
}

TEST(LensInitTest, EachFaultIsRefused) {
  lens_t lens;
  lens_view_t view = view_of(LENS_EQUISOLID, 180);
  EXPECT_EQ(lens_init(&lens, &view, 719, 576), LENS_BAD_SIZE);
  EXPECT_EQ(lens_init(&lens, &view, 0, 576), LENS_BAD_SIZE);
  EXPECT_EQ(lens_init(&lens, &view, 720, 5000), LENS_BAD_SIZE);
  view.mapping = 7;
  EXPECT_EQ(lens_init(&lens, &view, 720, 576), LENS_BAD_MAPPING);
  view = view_of(LENS_ORTHOGRAPHIC, 190);
  EXPECT_EQ(lens_init(&lens, &view, 720, 576), LENS_BAD_FOV);
  view = view_of(LENS_EQUISOLID, 180);
  view.out_focal_px = -1;
  EXPECT_EQ(lens_init(&lens, &view, 720, 576), LENS_BAD_FOCAL);
  view = view_of(LENS_EQUISOLID, 180);
  view.in_aspect = 0;
  EXPECT_EQ(lens_init(&lens, &view, 720, 576), LENS_BAD_FOCAL);
  view = view_of(LENS_EQUISOLID, 180);
  view.focal_px = std::numeric_limits<double>::infinity();
  EXPECT_EQ(lens_init(&lens, &view, 720, 576), LENS_BAD_FOCAL);
  for (int r = LENS_OK; r <= LENS_BAD_TABLE; ++r)
    EXPECT_NE(std::string(lens_result_text(static_cast<lens_result_t>(r))), "unknown");
}

}  // namespace
