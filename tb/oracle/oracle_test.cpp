// The oracle against published figures of optics, and against planted mistakes.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tb/oracle/frame_compare.h"
#include "tb/oracle/lens_oracle.h"

namespace fovea::oracle {
namespace {

const double kPi = std::acos(-1.0);

Geometry geometry(Mapping mapping, double fov_deg = 180) {
  Geometry g;
  g.mapping = mapping;
  g.fov_deg = fov_deg;
  return g;
}

double distance_from_centre(const Geometry& g, const Position& p) {
  return std::hypot(p.x - (g.width - 1) / 2.0, p.y - (g.height - 1) / 2.0);
}

TEST(LensFocalTest, EqualsThePublishedTableAt720Pixels) {
  struct Row {
    double fov, literal, equisolid, linear, orthographic, stereographic;
  };
  const Row rows[] = {{100, 234.97, 425.92, 412.53, 469.95, 386.01},
                      {120, 207.85, 360.00, 343.77, 415.69, 311.77},
                      {150, 186.35, 295.68, 275.02, 372.70, 234.58},
                      {170, 180.69, 266.43, 242.66, 361.38, 196.44},
                      {180, 180.00, 254.56, 229.18, 360.00, 180.00}};
  for (const Row& row : rows) {
    Geometry literal = geometry(Mapping::kEquisolid, row.fov);
    literal.paper_literal_focal = true;
    EXPECT_NEAR(lens_focal(literal), row.literal, 0.005);
    EXPECT_NEAR(lens_focal(geometry(Mapping::kEquisolid, row.fov)), row.equisolid, 0.005);
    EXPECT_NEAR(lens_focal(geometry(Mapping::kLinear, row.fov)), row.linear, 0.005);
    EXPECT_NEAR(lens_focal(geometry(Mapping::kOrthographic, row.fov)), row.orthographic, 0.005);
    EXPECT_NEAR(lens_focal(geometry(Mapping::kStereographic, row.fov)), row.stereographic, 0.005);
  }
  EXPECT_NEAR(lens_focal(geometry(Mapping::kEquisolid, 220)), 219.74, 0.005);
  EXPECT_NEAR(lens_focal(geometry(Mapping::kLinear, 190)), 217.12, 0.005);
}

TEST(SourcePositionTest, HasThePublishedRadiusAtEdgeAndCorner) {
  struct Row {
    Mapping mapping;
    double hfov, vfov, edge, corner;
  };
  const Row rows[] = {{Mapping::kLinear, 115.0, 103.0, 230.1, 254.3},
                      {Mapping::kOrthographic, 90.0, 77.3, 254.6, 283.7},
                      {Mapping::kEquisolid, 109.5, 97.1, 234.0, 258.8},
                      {Mapping::kStereographic, 126.9, 116.0, 222.5, 245.9}};
  for (const Row& row : rows) {
    const Geometry g = geometry(row.mapping);
    EXPECT_NEAR(2 * std::atan(360 / output_focal(g)) * 180 / kPi, row.hfov, 0.06);
    EXPECT_NEAR(2 * std::atan(288 / output_focal(g)) * 180 / kPi, row.vfov, 0.06);
    EXPECT_NEAR(distance_from_centre(g, source_position(g, 719.5, 287.5)), row.edge, 0.06);
    EXPECT_NEAR(distance_from_centre(g, source_position(g, 719.5, 575.5)), row.corner, 0.06);
  }
}

TEST(SourcePositionTest, StaysOnItsRadius) {
  for (Mapping mapping :
       {Mapping::kLinear, Mapping::kOrthographic, Mapping::kEquisolid, Mapping::kStereographic}) {
    const Geometry g = geometry(mapping);
    for (double u : {0.0, 100.0, 359.0, 719.0})
      for (double v : {0.0, 300.0, 575.0}) {
        const Position p = source_position(g, u, v);
        EXPECT_NEAR((p.x - 359.5) * (v - 287.5), (p.y - 287.5) * (u - 359.5), 1e-6);
      }
  }
}

TEST(SourcePositionTest, TouchesThePublishedWindowOfAnEquisolidSource) {
  const Geometry g = geometry(Mapping::kEquisolid);
  EXPECT_EQ(std::lround(source_position(g, 0, 287).x), 126);
  EXPECT_EQ(std::lround(source_position(g, 719, 287).x), 593);
  EXPECT_EQ(std::lround(source_position(g, 359, 0).y), 78);
  EXPECT_EQ(std::lround(source_position(g, 359, 575).y), 497);
}

TEST(SourcePositionTest, RectilinearLensIsThePictureItself) {
  const Geometry g = geometry(Mapping::kRectilinear, 90);
  const Position p = source_position(g, 12, 34);
  EXPECT_NEAR(p.x, 12, 1e-9);
  EXPECT_NEAR(p.y, 34, 1e-9);
}

TEST(SourcePositionTest, WideLensesStayFinite) {
  for (Mapping mapping : {Mapping::kLinear, Mapping::kEquisolid, Mapping::kStereographic}) {
    const Geometry g = geometry(mapping, 190);
    const Position p = source_position(g, 0, 0);
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
    EXPECT_LT(distance_from_centre(g, p), 461);
  }
}

TEST(SourcePositionTest, AspectShiftAndCentreAct) {
  Geometry g = geometry(Mapping::kLinear, 180);
  g.centre_x = 7;
  g.centre_y = -3;
  g.shift_x = 0.5;
  g.shift_y = -0.5;
  // Output position 359, 288 plus the shift is the axis.
  EXPECT_NEAR(source_position(g, 359, 288).x, 366.5, 1e-9);
  EXPECT_NEAR(source_position(g, 359, 288).y, 284.5, 1e-9);
  g = geometry(Mapping::kLinear, 180);
  g.in_aspect = 1.25;
  g.out_aspect = 1.0;
  const double f = 720 / kPi;
  EXPECT_NEAR(source_position(g, 359.5, 287.5 + 100).y, 287.5 + 1.25 * f * std::atan(100 / f),
              1e-9);
  g.out_aspect = 2.0;
  EXPECT_NEAR(source_position(g, 359.5, 287.5 + 100).y, 287.5 + 1.25 * f * std::atan(50 / f), 1e-9);
  EXPECT_NEAR(source_position(g, 359.5 + 100, 287.5).x, 359.5 + f * std::atan(100 / f), 1e-9);
}

TEST(TableLensTest, ReproducesAClosedFormWithinTheInterpolationError) {
  Geometry table = geometry(Mapping::kTable);
  const Geometry closed = geometry(Mapping::kEquisolid);
  const double f = lens_focal(closed);
  table.focal_px = f;
  table.theta_max = kPi / 2;
  for (int i = 0; i < 129; ++i) table.table_r.push_back(2 * f * std::sin(i * kPi / 4 / 128));
  // Linear interpolation: step^2 / 8 times the second derivative f/2 sin(theta/2).
  const double bound = std::pow(kPi / 2 / 128, 2) / 8 * f / 2 * std::sin(kPi / 4);
  double worst = 0;
  for (double theta = 0; theta < kPi / 2; theta += 0.001)
    worst = std::max(worst, std::abs(*lens_radius(table, theta) - *lens_radius(closed, theta)));
  EXPECT_LE(worst, bound);
  EXPECT_GT(worst, bound / 2);
  EXPECT_FALSE(lens_radius(table, kPi / 2 + 1e-6));
}

/// Bow of a straight scene line as the correction `g` shows it, if the lens is truly equisolid 180.
struct Bow {
  double rms = 0, max = 0, peak_to_peak = 0;
};
Bow bow_of_line(const Geometry& g, double height_over_depth) {
  const double f = lens_focal(geometry(Mapping::kEquisolid));
  const auto slope_seen = [&](double u, double v) {
    const Position p = source_position(g, u, v);
    const double x = p.x - 359.5, y = p.y - 287.5, r = std::hypot(x, y);
    return y / r * std::tan(2 * std::asin(r / (2 * f)));
  };
  std::vector<double> heights;
  for (unsigned u = 0; u < g.width; ++u) {
    double low = 287.5 + 1e-6, high = 287.5 + 600;
    for (int i = 0; i < 60; ++i) {
      const double v = (low + high) / 2;
      (slope_seen(u, v) > height_over_depth ? high : low) = v;
    }
    heights.push_back(low);
  }
  // The line is horizontal and the picture symmetric: the best line is the mean height.
  double mean = 0;
  for (double h : heights) mean += h / static_cast<double>(heights.size());
  Bow bow;
  double low = 1e9, high = -1e9;
  for (double h : heights) {
    bow.rms += (h - mean) * (h - mean);
    bow.max = std::max(bow.max, std::abs(h - mean));
    low = std::min(low, h);
    high = std::max(high, h);
  }
  bow.rms = std::sqrt(bow.rms / static_cast<double>(heights.size()));
  bow.peak_to_peak = high - low;
  return bow;
}

TEST(StraightnessTest, TheRightFocalLengthKeepsLinesStraight) {
  const Geometry g = geometry(Mapping::kEquisolid);
  for (double height : {26.0, 79.0, 140.0, 176.0})
    EXPECT_LT(bow_of_line(g, height / lens_focal(g)).peak_to_peak, 1e-6);
}

TEST(StraightnessTest, ThePrintedFocalLengthBowsLinesAsTabulated) {
  Geometry g = geometry(Mapping::kEquisolid);
  g.paper_literal_focal = true;
  struct Row {
    double height, rms, max, peak_to_peak;  // height of the line at the centre of the output
  };
  const Row rows[] = {{26, 3.8, 7.5, 12.2},
                      {79, 11.4, 22.7, 36.8},
                      {140, 19.1, 38.3, 61.8},
                      {176, 23.0, 46.3, 74.5}};
  const double right = lens_focal(geometry(Mapping::kEquisolid)), printed = lens_focal(g);
  for (const Row& row : rows) {
    const double shown = std::atan(row.height / printed);
    const double real = 2 * std::asin(std::sin(shown / 2) * printed / right);
    const Bow bow = bow_of_line(g, std::tan(real));
    // The table gives heights to 1 px and bows, about proportional to them, to 0.1 px.
    const double slack = 0.5 / row.height;
    EXPECT_NEAR(bow.rms, row.rms, 0.05 + row.rms * slack);
    EXPECT_NEAR(bow.max, row.max, 0.05 + row.max * slack);
    EXPECT_NEAR(bow.peak_to_peak, row.peak_to_peak, 0.05 + row.peak_to_peak * slack);
  }
}

TEST(ExpectedEntryTest, MethodATakesTheFirstPixelsNearestSourceAndItsAlignedPair) {
  Geometry g =
      geometry(Mapping::kRectilinear, 90);  // source = output, scaled by lens / output focal
  g.width = 8;
  g.height = 4;
  g.pitch_bytes = 32;
  EXPECT_EQ(expected_entry(g, 0, 0).entry, 0u);
  EXPECT_EQ(expected_entry(g, 3, 2).entry, 2u * 32 + 12);
  // One pixel to the right: pixel 2 comes from 3, an odd column, whose pair is the one of 2.
  g.centre_x = 1;
  EXPECT_EQ(expected_entry(g, 1, 0).entry, 4u);
  g.centre_x = 1.49;
  EXPECT_EQ(expected_entry(g, 1, 0).entry, 4u);
  g.centre_x = 1.51;
  EXPECT_EQ(expected_entry(g, 1, 0).entry, 8u);
  EXPECT_NEAR(expected_entry(g, 1, 0).margin, 0.01, 1e-9);
  // Row 0 comes from -0.6: outside, the black pair behind the frame.
  g.centre_x = 0;
  g.centre_y = -0.6;
  EXPECT_EQ(expected_entry(g, 0, 0).entry, 4u * 32);
  EXPECT_FALSE(expected_entry(g, 0, 0).inside);
  EXPECT_EQ(expected_entry(g, 0, 1).entry, 0u);
}

TEST(ExpectedEntryTest, MethodBTakesThePairNearestToThePairsMiddle) {
  Geometry g = geometry(Mapping::kRectilinear, 90);
  g.width = 8;
  g.height = 4;
  g.pitch_bytes = 16;
  // Middle of output pair 1 is 2.5; with 1.1 it is seen at 3.6, nearer to 4.5 than to 2.5.
  g.centre_x = 1.1;
  EXPECT_EQ(expected_entry(g, 1, 0).entry, 4u);
  g.method = PairMethod::kPairCentre;
  EXPECT_EQ(expected_entry(g, 1, 0).entry, 8u);
  g.centre_x = 0.9;
  EXPECT_EQ(expected_entry(g, 1, 0).entry, 4u);
}

TEST(ExpectedEntryTest, DirectionsBeyondTheTableAreBlack) {
  Geometry g = geometry(Mapping::kTable);
  g.theta_max = 0.5;
  g.table_r = {0, 60, 120};
  g.out_focal_px = 200;
  EXPECT_EQ(expected_entry(g, 0, 287).entry, 576u * 1440);
  EXPECT_LT(expected_entry(g, 180, 287).entry, 576u * 1440);
}

TEST(ExpectedEntryTest, WithoutALensOnlyTheShiftActs) {
  Geometry g = geometry(Mapping::kNone);
  g.centre_x = 50;
  g.in_aspect = 2;
  EXPECT_EQ(expected_entry(g, 10, 20).entry, 20u * 1440 + 40);
  g.shift_x = 3;  // column 23, pair 22
  g.shift_y = -5;
  EXPECT_EQ(expected_entry(g, 10, 20).entry, 15u * 1440 + 44);
  EXPECT_EQ(expected_entry(g, 10, 4).entry, 576u * 1440);
  EXPECT_EQ(expected_entry(g, 359, 20).entry, 576u * 1440);
}

TEST(ExpectedEntryTest, ThetaMaxLimitsClosedFormsAndIsABoundaryToo) {
  Geometry g = geometry(Mapping::kLinear);
  const double f = lens_focal(g);
  // Output pixel 560 of the middle rows lies at this angle; end the lens 0.01 px of radius before
  // it.
  const double theta = std::atan(std::hypot(560 - 359.5, 0.5) / f);
  g.theta_max = theta - 0.01 / f;
  const Expected e = expected_entry(g, 280, 287);
  EXPECT_EQ(e.entry, 576u * 1440);
  EXPECT_NEAR(e.margin, 0.01, 1e-9);
  auto lut = build_lut(g);
  lut[287 * 360 + 280] = expected_entry(geometry(Mapping::kLinear), 280, 287).entry;
  EXPECT_EQ(check_lut(lut, g).wrong, 0u);
  EXPECT_EQ(check_lut(lut, g).near_boundary, 1u);
  EXPECT_EQ(check_lut(lut, g, 0.005).wrong, 1u);
  g.theta_max = theta - 0.03 / f;
  EXPECT_EQ(check_lut(lut, g).wrong, 1u);
  g.theta_max = kPi / 2;  // no limit: a view never shows 90 degrees
  EXPECT_EQ(build_lut(g), build_lut(geometry(Mapping::kLinear)));
}

TEST(CheckLutTest, AcceptsTheTableItself) {
  const Geometry g = geometry(Mapping::kLinear);
  const LutCheck check = check_lut(build_lut(g), g);
  EXPECT_EQ(check.entries, 207360u);
  EXPECT_EQ(check.wrong, 0u);
  EXPECT_EQ(check.near_boundary, 0u);
  // Positions are spread evenly: 0.04 of every px in y, 0.04 of every 2 px in x.
  EXPECT_NEAR(static_cast<double>(check.at_risk), 207360 * (0.04 + 0.02 - 0.04 * 0.02), 1500);
}

TEST(CheckLutTest, ComplainsOfOneChangedEntry) {
  const Geometry g = geometry(Mapping::kLinear);
  auto lut = build_lut(g);
  // The first entry from the middle on that is firm in x.
  std::size_t i = lut.size() / 2;
  while (expected_entry(g, static_cast<unsigned>(i % 360), static_cast<unsigned>(i / 360)).margin <
         0.1)
    ++i;
  for (std::int32_t change : {4, -4, 1440, -1440, 2, 1}) {
    lut[i] += static_cast<std::uint32_t>(change);
    const LutCheck check = check_lut(lut, g);
    EXPECT_EQ(check.wrong, 1u) << change;
    ASSERT_TRUE(check.first_wrong);
    EXPECT_EQ(check.first_wrong->row * 360 + check.first_wrong->pair, i);
    EXPECT_NE(check.first_wrong->text().find("got " + std::to_string(lut[i])), std::string::npos);
    lut[i] -= static_cast<std::uint32_t>(change);
  }
}

TEST(CheckLutTest, ComplainsOfMissingAndSurplusEntries) {
  const Geometry g = geometry(Mapping::kLinear);
  auto lut = build_lut(g);
  lut.pop_back();
  EXPECT_EQ(check_lut(lut, g).wrong, 1u);
  lut.resize(207360 + 3, lut.back());
  lut[207359] = build_lut(g).back();
  EXPECT_EQ(check_lut(lut, g).wrong, 3u);
}

TEST(CheckLutTest, ToleranceIsTight) {
  const Geometry g = geometry(Mapping::kEquisolid);
  Geometry moved = g;
  moved.centre_x = 0.019;
  LutCheck check = check_lut(build_lut(moved), g);
  EXPECT_EQ(check.wrong, 0u);
  // A move by d px changes d / 2 of the entries: a pair is two pixels wide.
  EXPECT_NEAR(static_cast<double>(check.near_boundary), 207360 * 0.019 / 2, 400);
  moved.centre_x = 0.03;
  check = check_lut(build_lut(moved), g);
  EXPECT_NEAR(static_cast<double>(check.wrong), 207360 * 0.01 / 2, 300);
  moved = g;
  moved.centre_y = -0.019;
  EXPECT_EQ(check_lut(build_lut(moved), g).wrong, 0u);
  moved.centre_y = -0.03;
  EXPECT_GT(check_lut(build_lut(moved), g).wrong, 1000u);
}

TEST(CheckLutTest, ANearBoundaryEntryMustBeTheNeighbourAcrossThatBoundary) {
  const Geometry g = geometry(Mapping::kEquisolid);
  auto lut = build_lut(g);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < lut.size() && seen < 50; ++i) {
    const Expected e =
        expected_entry(g, static_cast<unsigned>(i % 360), static_cast<unsigned>(i / 360));
    if (e.margin > 0.02) continue;
    ++seen;
    lut[i] += 2 * 1440;  // two rows further: near no boundary of this position
  }
  EXPECT_EQ(seen, 50u);
  EXPECT_EQ(check_lut(lut, g).wrong, 50u);
}

TEST(CheckLutTest, ComplainsOfTheWrongMethodAndTheWrongFocalLength) {
  Geometry g = geometry(Mapping::kEquisolid);
  const auto method_a = build_lut(g);
  g.method = PairMethod::kPairCentre;
  EXPECT_GT(check_lut(method_a, g).wrong, 10000u);
  g.method = PairMethod::kFirstPixel;
  g.paper_literal_focal = true;
  EXPECT_GT(check_lut(method_a, g).wrong, 100000u);
}

Frame noise(unsigned width, unsigned height) {
  Frame f{width, height, {}};
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < std::size_t{width} * height * 2; ++i) {
    state = state * 1664525 + 1013904223;
    f.uyvy.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  return f;
}

TEST(RemapTest, MovesWholePairsAndKnowsTheBlackPair) {
  const Frame in = noise(4, 2);
  const std::uint32_t pitch = 32;
  const std::vector<std::uint32_t> lut = {pitch + 4, 0, 2 * pitch, 4};
  const Frame out = remap(in, lut, pitch);
  const auto& b = in.uyvy;
  const std::vector<std::uint8_t> expected = {b[12], b[13], b[14], b[15], b[0], b[1], b[2], b[3],
                                              128,   16,    128,   16,    b[4], b[5], b[6], b[7]};
  EXPECT_EQ(out.uyvy, expected);
}

TEST(RemapTest, RefusesEntriesThatAreNoPair) {
  const Frame in = noise(4, 2);
  for (std::uint32_t bad : {2u, 8u, 64u + 4u, 96u, 0xffffffffu})
    EXPECT_THROW(remap(in, std::vector<std::uint32_t>{bad, 0, 0, 0}, 32), std::invalid_argument)
        << bad;
  EXPECT_THROW(remap(in, std::vector<std::uint32_t>{0, 0, 0}, 32), std::invalid_argument);
}

TEST(RemapTest, CorrectionDoesNotDependOnTheLighting) {
  Geometry g = geometry(Mapping::kEquisolid);
  g.width = 64;
  g.height = 48;
  g.pitch_bytes = 128;
  const auto lut = build_lut(g);
  Frame in = noise(64, 48);
  for (auto& v : in.uyvy) v /= 4;
  Frame brighter = in;
  for (auto& v : brighter.uyvy) v = static_cast<std::uint8_t>(2 * v + 40);
  Frame expected = remap(in, lut, 128);
  for (auto& v : expected.uyvy) v = static_cast<std::uint8_t>(2 * v + 40);
  EXPECT_FALSE(compare(expected, remap(brighter, lut, 128)));
}

TEST(CompareTest, FindsOneChangedByte) {
  const Frame a = noise(16, 4);
  EXPECT_FALSE(compare(a, a));
  for (std::size_t i : {std::size_t{0}, std::size_t{35}, a.uyvy.size() - 1}) {
    Frame b = a;
    b.uyvy[i] ^= 1;
    const auto d = compare(a, b);
    ASSERT_TRUE(d);
    EXPECT_EQ(d->y, i / 32);
    EXPECT_EQ(d->byte, i % 4);
    EXPECT_EQ(d->x, i % 32 / 4 * 2 + (i % 4 == 3));
    EXPECT_EQ(d->expected, a.uyvy[i]);
    EXPECT_EQ(d->got, b.uyvy[i]);
    EXPECT_EQ(d->count, 1u);
  }
}

TEST(CompareTest, FindsOtherSizes) {
  const Frame a = noise(16, 4);
  Frame b = a;
  b.uyvy.resize(b.uyvy.size() - 4);
  ASSERT_TRUE(compare(a, b));
  EXPECT_EQ(compare(a, b)->got, -1);
  b = a;
  std::swap(b.width, b.height);
  EXPECT_TRUE(compare(a, b));
}

}  // namespace
}  // namespace fovea::oracle
