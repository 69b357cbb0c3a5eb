// The remap of each pixel by itself, the flat view of a film, and scores of a part of a picture: against the oracle,
// and against values by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>

#include "model/common/check.h"
#include "model/video/scene/film_score.h"
#include "model/video/scene/pixel_remap.h"
#include "tb/oracle/frame_compare.h"
#include "tb/oracle/lens_oracle.h"

namespace fovea::video {
namespace {

constexpr unsigned kWidth = 64, kHeight = 48;

/// Luma and both chroma samples tell their place.
Picture told_places(unsigned width = kWidth, unsigned height = kHeight) {
  Picture p(width, height);
  for (unsigned v = 0; v < height; ++v)
    for (unsigned u = 0; u < width; ++u) {
      p.row(v)[2 * u + 1] = static_cast<std::uint8_t>(20 + (3 * u + 7 * v) % 200);
      p.row(v)[2 * u] = static_cast<std::uint8_t>(20 + (5 * u + 11 * v) % 200);
    }
  return p;
}

/// The displayed picture by the oracle's table of pairs.
Picture by_pairs(const oracle::Geometry& g, const Picture& in) {
  const oracle::Frame out = oracle::remap({in.width, in.height, in.uyvy}, oracle::build_lut(g), g.pitch_bytes);
  Picture shown(out.width, out.height);
  shown.uyvy = out.uyvy;
  return shown;
}

struct Case {
  const char* name;
  oracle::Mapping mapping;
  LensKind kind;
  double shift_x = 0, shift_y = 0, out_focal = 20, in_aspect = 1, out_aspect = 1, centre_x = 0;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
class PixelRemapTest : public testing::TestWithParam<Case> {};

// The oracle's positions, rounded; positions within 1e-9 px of a boundary may be rounded either way.
TEST_P(PixelRemapTest, TakesEachPixelFromItsOwnNearestOne) {
  const Case& c = GetParam();
  oracle::Geometry g;
  g.mapping = c.mapping;
  g.width = kWidth;
  g.height = kHeight;
  g.pitch_bytes = 2 * kWidth;
  g.focal_px = 22;
  g.out_focal_px = c.out_focal;
  g.shift_x = c.shift_x;
  g.shift_y = c.shift_y;
  g.in_aspect = c.in_aspect;
  g.out_aspect = c.out_aspect;
  g.centre_x = c.centre_x;
  std::optional<TakingLens> lens;
  if (c.mapping != oracle::Mapping::kNone)
    lens = TakingLens{LensModel::closed_form(c.kind, 90, kWidth, kHeight), 22, c.in_aspect,
                      {(kWidth - 1) / 2.0 + c.centre_x, (kHeight - 1) / 2.0}};
  const Picture in = told_places();
  const Picture got = remap_pixels(in, {kWidth, kHeight, c.out_focal, c.out_aspect, c.shift_x, c.shift_y}, lens);
  unsigned compared = 0, black = 0;
  for (unsigned v = 0; v < kHeight; ++v)
    for (unsigned u = 0; u < kWidth; ++u) {
      const oracle::Position at = oracle::source_position(g, u, v);
      const double column = std::floor(at.x + 0.5), row = std::floor(at.y + 0.5);
      if (std::min(std::abs(at.x + 0.5 - std::round(at.x + 0.5)), std::abs(at.y + 0.5 - std::round(at.y + 0.5))) < 1e-9)
        continue;
      ++compared;
      const bool inside = column >= 0 && row >= 0 && column < kWidth && row < kHeight;
      if (!inside) ++black;
      const auto x = static_cast<unsigned>(inside ? column : 0), y = static_cast<unsigned>(inside ? row : 0);
      ASSERT_EQ(got.row(v)[2 * u + 1], inside ? in.row(y)[2 * x + 1] : 16) << u << " " << v;
      if (u % 2) continue;
      EXPECT_EQ(got.row(v)[2 * u], inside ? in.row(y)[x / 2 * 4] : 128) << u << " " << v;
      EXPECT_EQ(got.row(v)[2 * u + 2], inside ? in.row(y)[x / 2 * 4 + 2] : 128) << u << " " << v;
    }
  EXPECT_GT(compared, kWidth * kHeight * 9 / 10);
  EXPECT_LT(black, compared * 4 / 5);  // at half the scale, three quarters of the view
}
INSTANTIATE_TEST_SUITE_P(
    Of, PixelRemapTest,
    testing::Values(Case{"Equisolid", oracle::Mapping::kEquisolid, LensKind::kEquisolid},
                    Case{"Linear", oracle::Mapping::kLinear, LensKind::kLinear, 3.2, -1.7},
                    Case{"Stereographic", oracle::Mapping::kStereographic, LensKind::kStereographic, 0, 0, 15, 1.3},
                    Case{"Orthographic", oracle::Mapping::kOrthographic, LensKind::kOrthographic, 0, 2, 20, 1, 1.2, 4},
                    Case{"Rectilinear", oracle::Mapping::kRectilinear, LensKind::kRectilinear, 0.3, 0.4, 11},
                    Case{"None", oracle::Mapping::kNone, LensKind::kLinear, 5, -2}),
    [](const auto& i) { return i.param.name; });

TEST(PixelRemap, WithoutDistortionItIsTheRemapOfPairs) {
  oracle::Geometry g;
  g.mapping = oracle::Mapping::kRectilinear;
  g.width = kWidth;
  g.height = kHeight;
  g.pitch_bytes = 2 * kWidth;
  g.focal_px = 30;
  const TakingLens lens{LensModel::closed_form(LensKind::kRectilinear, 90, kWidth, kHeight), 30, 1,
                        {(kWidth - 1) / 2.0, (kHeight - 1) / 2.0}};
  const Picture in = told_places();
  for (const double shift : {0.0, 4.0}) {
    g.shift_x = shift;
    const Picture pixels = remap_pixels(in, {kWidth, kHeight, 30, 1, shift, 0}, lens);
    EXPECT_EQ(by_pairs(g, in), pixels) << shift;
    EXPECT_TRUE(std::isinf(psnr_y(by_pairs(g, in), pixels)));
  }
  EXPECT_EQ(remap_pixels(in, {kWidth, kHeight, 30, 1, 0, 0}, lens), in);
}

// At half the scale pixel u shows 2 u - 30. The second pixel of a pair shows the neighbour of what the first one shows,
// one pixel left of its own; the last pair's second one shows pixel 63 where there is nothing more to see.
TEST(PixelRemap, AtHalfTheScaleEverySecondPixelOfAPairIsOffByOne) {
  oracle::Geometry g;
  g.mapping = oracle::Mapping::kRectilinear;
  g.width = kWidth;
  g.height = kHeight;
  g.pitch_bytes = 2 * kWidth;
  g.focal_px = 30;
  g.out_focal_px = 15;
  g.shift_x = 0.75;
  g.shift_y = 0.25;
  Picture ramp(kWidth, kHeight);
  for (unsigned v = 0; v < kHeight; ++v)
    for (unsigned u = 0; u < kWidth; ++u) ramp.row(v)[2 * u + 1] = static_cast<std::uint8_t>(16 + 3 * u);
  const TakingLens lens{LensModel::closed_form(LensKind::kRectilinear, 90, kWidth, kHeight), 30, 1,
                        {(kWidth - 1) / 2.0, (kHeight - 1) / 2.0}};
  const Picture pairs = by_pairs(g, ramp), pixels = remap_pixels(ramp, {kWidth, kHeight, 15, 1, 0.75, 0.25}, lens);
  EXPECT_EQ(pixels.row(20)[2 * 30 + 1], 16 + 3 * 30);
  EXPECT_EQ(pixels.row(20)[2 * 31 + 1], 16 + 3 * 32);
  EXPECT_EQ(pairs.row(20)[2 * 31 + 1], 16 + 3 * 31);
  // Row v shows 2 v - 23: 24 of them.
  const double sum = kHeight / 2 * (15 * 3 * 3 + (3 * 63) * (3 * 63));
  EXPECT_NEAR(psnr_y(pairs, pixels), 10 * std::log10(255.0 * 255.0 * kWidth * kHeight / sum), 1e-9);
}

TEST(PixelRemap, BeyondTheLargestAngleItIsBlack) {
  TakingLens lens{LensModel::closed_form(LensKind::kLinear, 90, kWidth, kHeight), 30, 1,
                  {(kWidth - 1) / 2.0, (kHeight - 1) / 2.0}};
  const Picture grey(kWidth, kHeight, 100);
  lens.theta_max = std::atan(10 / 30.0);  // ten displayed pixels
  const Picture out = remap_pixels(grey, {kWidth, kHeight, 30, 1, -0.5, -0.5}, lens);
  EXPECT_EQ(out.row(24)[2 * (32 + 9) + 1], 100);
  EXPECT_EQ(out.row(24)[2 * (32 + 11) + 1], 16);
  EXPECT_EQ(out.row(24 - 11)[2 * 32 + 1], 16);
}

/// A film whose grey tells its place.
RgbImage ramp_film(unsigned width, unsigned height) {
  RgbImage image{width, height, {}};
  for (unsigned v = 0; v < height; ++v)
    for (unsigned u = 0; u < width; ++u)
      for (unsigned i = 0; i < 3; ++i) image.rgb.push_back(static_cast<std::uint8_t>(2 * u + v));
  return image;
}

TEST(FilmView, ShowsTheFilmWhereItIs) {
  // 90 degrees across 60 pixels: a focal length of 30, shown at 15: half the size, 30 x 20 pixels.
  const FlatView flat = flat_film_view(ramp_film(60, 40), 90, {kWidth, kHeight, 15, 1, 0, 0});
  for (unsigned v = 0; v < kHeight; ++v)
    for (unsigned u = 0; u < kWidth; ++u) {
      const bool inside = u >= 17 && u < 47 && v >= 14 && v < 34;
      ASSERT_EQ(flat.seen[v * kWidth + u] != 0, inside) << u << " " << v;
      // Between film pixels 2 (u - 17) and the next one, and likewise down: their mean grey, as BT.601 has it.
      const double grey = 2 * (2 * (u - 17.0) + 0.5) + 2 * (v - 14.0) + 0.5;
      EXPECT_NEAR(flat.picture.row(v)[2 * u + 1], inside ? 16 + 219 * grey / 255 : 16, 1.6) << u << " " << v;
    }
  const FlatView aside = flat_film_view(ramp_film(60, 40), 90, {kWidth, kHeight, 15, 1, 4, -3});
  for (unsigned v = 3; v < kHeight; ++v)
    for (unsigned u = 0; u + 4 < kWidth; ++u) {
      ASSERT_EQ(aside.picture.row(v)[2 * u + 1], flat.picture.row(v - 3)[2 * (u + 4) + 1]) << u << " " << v;
      ASSERT_EQ(aside.seen[v * kWidth + u], flat.seen[(v - 3) * kWidth + u + 4]) << u << " " << v;
    }
}

// A film reaches half a pixel beyond the centres of its first and last ones.
TEST(FilmView, EndsAtTheEdgesOfTheFilm) {
  const auto seen = [](double shift, unsigned u, unsigned v) {
    return flat_film_view(ramp_film(60, 40), 90, {kWidth, kHeight, 15, 1, shift, shift}).seen[v * kWidth + u] != 0;
  };
  EXPECT_TRUE(seen(-0.45, 17, 20));  // film position 0.5 - 0.9
  EXPECT_FALSE(seen(-0.55, 17, 20));
  EXPECT_TRUE(seen(0.45, 46, 20));
  EXPECT_FALSE(seen(0.55, 46, 20));
  EXPECT_TRUE(seen(-0.45, 30, 14));
  EXPECT_FALSE(seen(-0.55, 30, 14));
  EXPECT_TRUE(seen(0.45, 30, 33));
  EXPECT_FALSE(seen(0.55, 30, 33));
}

TEST(FilmScore, ComparesWhereThereIsFilm) {
  const PinholeView view{kWidth, kHeight, 15, 1, 0, 0};
  const RgbImage film = ramp_film(60, 40);
  const FilmScore score(90, view);
  Picture shown = flat_film_view(film, 90, view).picture;
  EXPECT_TRUE(std::isinf(score(shown, film).psnr_y));
  EXPECT_NEAR(score(shown, film).ssim_y, 1, 1e-12);
  shown.row(0)[1] = 255;  // no film there
  shown.row(13)[2 * 20 + 1] = 255;
  shown.row(20)[2 * 16 + 1] = 255;
  EXPECT_TRUE(std::isinf(score(shown, film).psnr_y));
  EXPECT_NEAR(score(shown, film).ssim_y, 1, 1e-12);
  shown.row(14)[2 * 17 + 1] += 5;  // the film's first pixel
  EXPECT_NEAR(score(shown, film).psnr_y, 10 * std::log10(255.0 * 255.0 * 30 * 20 / 25), 1e-9);
  EXPECT_LT(score(shown, film).ssim_y, 1 - 1e-9);
  EXPECT_THROW(score(Picture(kWidth, kHeight - 2), film), UserError);
}

TEST(PictureMask, ScoresArePartsOfThePicture) {
  const Picture a = told_places(), b = told_places(kWidth, kHeight);
  Picture changed = b;
  for (unsigned v = 0; v < kHeight; ++v)
    for (unsigned u = 40; u < kWidth; ++u) changed.row(v)[2 * u + 1] = static_cast<std::uint8_t>(u + v);
  const auto mask = [](const std::function<bool(unsigned, unsigned)>& in) {
    PictureMask m(kWidth * kHeight);
    for (unsigned v = 0; v < kHeight; ++v)
      for (unsigned u = 0; u < kWidth; ++u) m[v * kWidth + u] = in(u, v);
    return m;
  };
  const PictureMask all = mask([](unsigned, unsigned) { return true; });
  EXPECT_NEAR(psnr_y(a, changed, all), psnr_y(a, changed), 1e-9);
  EXPECT_EQ(ssim_y(a, changed, all), ssim_y(a, changed));
  // The part from column 20 and row 5 on is a picture of its own.
  const auto cut = [](const Picture& p) {
    Picture out(kWidth - 20, kHeight - 5);
    for (unsigned v = 0; v < out.height; ++v) std::copy_n(p.row(v + 5) + 40, out.row_bytes(), out.row(v));
    return out;
  };
  const PictureMask part = mask([](unsigned u, unsigned v) { return u >= 20 && v >= 5; });
  EXPECT_NEAR(psnr_y(a, changed, part), psnr_y(cut(a), cut(changed)), 1e-9);
  EXPECT_NEAR(ssim_y(a, changed, part), ssim_y(cut(a), cut(changed)), 1e-12);
  EXPECT_LT(ssim_y(a, changed, part), ssim_y(a, changed) - 0.01);
  // A hole of a pixel takes away all windows that touch it.
  const PictureMask hole = mask([](unsigned u, unsigned v) { return u != 50 || v != 20; });
  Picture spot = a;
  spot.row(20)[2 * 50 + 1] ^= 0x40;
  EXPECT_TRUE(std::isinf(psnr_y(a, spot, hole)));
  EXPECT_NEAR(ssim_y(a, spot, hole), 1, 1e-12);
  // Of the windows with the pixel beside it, those of one column are without the hole.
  Picture beside = a;
  beside.row(20)[2 * 49 + 1] ^= 0x40;
  EXPECT_FALSE(std::isinf(psnr_y(a, beside, hole)));
  EXPECT_LT(ssim_y(a, beside, hole), 1);
  const PictureMask none = mask([](unsigned, unsigned) { return false; });
  EXPECT_TRUE(std::isnan(psnr_y(a, b, none)));
  EXPECT_TRUE(std::isnan(ssim_y(a, b, none)));
  EXPECT_TRUE(std::isnan(ssim_y(a, b, mask([](unsigned u, unsigned v) { return u < 10 || v < 10; }))));
  EXPECT_FALSE(std::isnan(ssim_y(a, b, mask([](unsigned u, unsigned v) { return u < 11 && v < 11; }))));
  EXPECT_THROW(psnr_y(a, b, PictureMask(5)), UserError);
  EXPECT_THROW(ssim_y(a, b, PictureMask(5)), UserError);
}

}  // namespace
}  // namespace fovea::video
