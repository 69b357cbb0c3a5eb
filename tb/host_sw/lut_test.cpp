// The table of pixel pairs: methods A and B, rounding, border, symmetry.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sw/lens/lens.h"

namespace {

lens_view_t view_of(std::uint32_t mapping, double fov_deg) {
  lens_view_t view;
  lens_view_default(&view);
  view.mapping = mapping;
  view.fov_deg = fov_deg;
  return view;
}

std::vector<std::uint32_t> build(const lens_view_t& view, unsigned width, unsigned height,
                                 unsigned pitch) {
  lens_t lens;
  EXPECT_EQ(lens_init(&lens, &view, width, height), LENS_OK);
  std::vector<std::uint32_t> lut(lens_lut_entries(width, height) + 2, 0xDEADBEEF);
  lens_build_lut(&lens, lut.data(), pitch);
  EXPECT_EQ(lut[lut.size() - 1], 0xDEADBEEF) << "written behind the table";
  EXPECT_EQ(lut[lut.size() - 2], 0xDEADBEEF) << "written behind the table";
  lut.resize(lut.size() - 2);
  return lut;
}

TEST(LutTest, WithoutCorrectionItIsThePictureItself) {
  const auto lut = build(view_of(LENS_NONE, 0), 8, 4, 32);
  for (unsigned v = 0; v < 4; ++v)
    for (unsigned i = 0; i < 4; ++i) EXPECT_EQ(lut[v * 4 + i], v * 32 + i * 4);
}

TEST(LutTest, OutsideThePictureEntriesPointAtTheBlackWord) {
  lens_view_t view = view_of(LENS_NONE, 0);
  view.shift_x = -2;
  view.shift_y = 1;
  const auto lut = build(view, 8, 4, 32);
  const std::uint32_t black = 4 * 32;
  for (unsigned v = 0; v < 4; ++v)
    for (unsigned i = 0; i < 4; ++i)
      EXPECT_EQ(lut[v * 4 + i], i == 0 || v == 3 ? black : (v + 1) * 32 + (i - 1) * 4);
}

TEST(LutTest, OddSourceColumnsFallOnTheirWholePair) {
  lens_view_t view = view_of(LENS_NONE, 0);
  view.shift_x = 1;  // first pixel of each pair comes from an odd column
  const auto lut = build(view, 8, 2, 32);
  for (unsigned i = 0; i < 4; ++i) EXPECT_EQ(lut[i], i * 4);
}

TEST(LutTest, PositionsRoundToNearestHalvesUp) {
  lens_t lens;
  const lens_view_t view = view_of(LENS_NONE, 0);
  ASSERT_EQ(lens_init(&lens, &view, 8, 4), LENS_OK);
  const auto entry = [&](double column, double row) {
    return lens_lut_entry(&lens, lens_point_t{column, row, 1}, 32, 999);
  };
  EXPECT_EQ(entry(1.49, 0), 0u);
  EXPECT_EQ(entry(1.5, 0), 4u);  // column 2
  EXPECT_EQ(entry(0, 1.49), 32u);
  EXPECT_EQ(entry(0, 1.5), 64u);
  EXPECT_EQ(entry(-0.5, 0), 0u);
  EXPECT_EQ(entry(-0.51, 0), 999u);
  EXPECT_EQ(entry(7.49, 3.49), 3u * 32 + 12);
  EXPECT_EQ(entry(7.5, 0), 999u);
  EXPECT_EQ(entry(0, 3.5), 999u);
  EXPECT_EQ(entry(1e300, 0), 999u);
  EXPECT_EQ(entry(-1e300, 0), 999u);
  EXPECT_EQ(entry(std::nan(""), 0), 999u);
  EXPECT_EQ(lens_lut_entry(&lens, lens_point_t{1, 1, 0}, 32, 999), 999u);
}

TEST(LutTest, MethodsAAndBMapFirstPixelAndCentre) {
  for (bool b : {false, true}) {
    lens_view_t view = view_of(LENS_EQUISOLID, 180);
    if (b) view.pair_method = PAIR_CENTRE;
    const auto lut = build(view, 720, 576, 1440);
    const double f = 720 / (4 * std::sin(45 * M_PI / 180));  // equation (10), corrected
    unsigned differing = 0;
    for (unsigned v = 0; v < 576; v += 25)
      for (unsigned i = 0; i < 360; i += 7) {
        // The paper's (12) to (14), literally.
        const double j = 2 * i + (b ? 0.5 : 0.0) - 359.5, k = v - 287.5;
        const double rp = std::sqrt(j * j + k * k);
        const double gain = 2 * f / rp * std::sin(0.5 * std::atan(rp / f));
        const auto n = static_cast<unsigned>(std::lround(359.5 + gain * j));
        const auto m = static_cast<unsigned>(std::lround(287.5 + gain * k));
        differing += lut[v * 360 + i] != m * 1440 + (n & ~1u) * 2;
      }
    EXPECT_EQ(differing, 0u) << (b ? "B" : "A");
  }
}

TEST(LutTest, MethodBTakesThePairWhoseCentreIsNearest) {
  lens_view_t view = view_of(LENS_STEREOGRAPHIC, 150);
  view.pair_method = PAIR_CENTRE;
  lens_t lens;
  ASSERT_EQ(lens_init(&lens, &view, 64, 48), LENS_OK);
  const auto lut = build(view, 64, 48, 128);
  for (unsigned v = 0; v < 48; ++v)
    for (unsigned i = 0; i < 32; ++i) {
      const lens_point_t p = lens_source(&lens, 2 * i + 0.5, v);
      const unsigned pair = lut[v * 32 + i] % 128 / 4;
      EXPECT_LE(std::abs(2 * pair + 0.5 - p.column), 1.0 + 1e-9);
    }
}

// Whatever symmetry the builder uses, its entries are those of single evaluation.
TEST(LutTest, SymmetricBuildEqualsEntryByEntry) {
  for (std::uint32_t mapping = LENS_NONE; mapping <= LENS_TABLE; ++mapping)
    for (unsigned variant = 0; variant < 16; ++variant) {
      SCOPED_TRACE(testing::Message() << "mapping " << mapping << " variant " << variant);
      lens_view_t view = view_of(mapping, 130);
      if (variant & 1) view.pair_method = PAIR_CENTRE;
      if (variant & 2) view.shift_x = 3.25;
      if (variant & 4) view.shift_y = -1.75;
      if (variant & 8) {
        view.centre_x = 2.125;
        view.centre_y = -4.5;
        view.in_aspect = 1.06;
        view.out_aspect = 0.93;
        view.out_focal_px = 21;
      }
      view.table_count = 17;
      view.theta_max = mapping == LENS_TABLE ? 1.3 : 0;
      for (unsigned i = 0; i < 17; ++i) view.table_r[i] = 30 * std::sin(i / 16.0 * 1.3);
      const unsigned width = 60, height = 45, pitch = 128;
      lens_t lens;
      ASSERT_EQ(lens_init(&lens, &view, width, height), LENS_OK);
      const auto lut = build(view, width, height, pitch);
      unsigned differing = 0;
      for (unsigned v = 0; v < height; ++v)
        for (unsigned i = 0; i < width / 2; ++i)
          differing += lut[v * 30 + i] !=
                       lens_lut_entry(&lens, lens_source(&lens, 2 * i + (variant & 1 ? 0.5 : 0), v),
                                      pitch, lens_black_offset(height, pitch));
      EXPECT_EQ(differing, 0u);
    }
}

TEST(LutTest, CentredMethodBIsSymmetric) {
  lens_view_t view = view_of(LENS_EQUISOLID, 160);
  view.pair_method = PAIR_CENTRE;
  const unsigned w = 64, h = 48, pitch = 128;
  const auto lut = build(view, w, h, pitch);
  unsigned asymmetric = 0;
  for (unsigned v = 0; v < h; ++v)
    for (unsigned i = 0; i < w / 2; ++i) {
      const std::uint32_t e = lut[v * 32 + i], mirrored = lut[(h - 1 - v) * 32 + (w / 2 - 1 - i)];
      asymmetric += e / pitch + mirrored / pitch != h - 1 ||
                    e % pitch / 4 + mirrored % pitch / 4 != w / 2 - 1;
    }
  // Positions on half-integers round up on both sides; there are none in general position.
  EXPECT_EQ(asymmetric, 0u);
}

TEST(LutTest, PitchMovesRowsOnly) {
  const lens_view_t view = view_of(LENS_LINEAR, 170);
  const auto narrow = build(view, 640, 480, 1280), wide = build(view, 640, 480, 1472);
  for (std::size_t i = 0; i < narrow.size(); ++i) {
    EXPECT_EQ(narrow[i] / 1280, wide[i] / 1472);
    EXPECT_EQ(narrow[i] % 1280, wide[i] % 1472);
  }
}

TEST(LutTest, TouchesTheDocumentedPartOfTheSource) {  // columns 126..593, rows 78..497
  const auto lut = build(view_of(LENS_EQUISOLID, 180), 720, 576, 1440);
  unsigned left = 719, right = 0, top = 575, bottom = 0;
  for (std::uint32_t e : lut) {
    const unsigned row = e / 1440, column = e % 1440 / 2;
    left = std::min(left, column);
    right = std::max(right, column);
    top = std::min(top, row);
    bottom = std::max(bottom, row);
  }
  EXPECT_EQ(left, 126u);
  EXPECT_EQ(right + 1, 593u);  // the word of an odd rightmost column begins one before it
  EXPECT_EQ(top, 78u);
  EXPECT_EQ(bottom, 497u);
}

}  // namespace
