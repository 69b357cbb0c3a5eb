// The synthetic car park: what mounted cameras see, traced back to the ground by the oracle, is the plan. And the
// score of a mosaic.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>

#include "model/common/check.h"
#include "model/video/scene/car_park.h"
#include "model/video/scene/plan_score.h"
#include "model/video/scene/quad.h"
#include "tb/oracle/view_oracle.h"

namespace fovea::video {
namespace {

constexpr GroundPicture kGround{320, 256, 12, 9.6};
constexpr double kCarLength = 4.8, kCarWidth = 2;

std::array<Mount, 4> mounts() {
  return {{{2.3, 0, 0.7, 0, 40, 0}, {0.5, -1, 1, -88, 55, 3}, {-2.3, 0.1, 0.9, 178, 45, 0}, {0.5, 1, 1, 90, 55, -2}}};
}

LensModel lens_of(unsigned width, unsigned height) {
  return LensModel::closed_form(LensKind::kEquisolid, 180, width, height);
}

oracle::Views views_of(const std::array<Mount, 4>& mount) {
  oracle::Views views;
  views.birds_eye = true;
  views.ground_width = kGround.metres_across;
  views.ground_height = kGround.metres_along;
  views.car_length = kCarLength;
  views.car_width = kCarWidth;
  for (unsigned n = 0; n < 4; ++n) {
    views.lens[n].width = kGround.width;
    views.lens[n].height = kGround.height;
    views.lens[n].pitch_bytes = kGround.width * 2;
    const Mount& m = mount[n];
    views.mount[n] = {m.x, m.y, m.height, m.yaw, m.pitch, m.roll};
  }
  return views;
}

/// The mosaic of four pictures by the oracle alone: each displayed luma is that of the nearest pixel.
Picture mosaic(const std::array<Picture, 4>& seen, const oracle::Views& views) {
  Picture out(kGround.width, kGround.height);
  for (unsigned v = 0; v < out.height; ++v)
    for (unsigned u = 0; u < out.width; ++u) {
      const oracle::Shown s = oracle::shown_at(views, u, v);
      if (s.camera < 0 || !s.ahead) continue;
      const double column = std::floor(s.at.x + 0.5), row = std::floor(s.at.y + 0.5);
      const Picture& in = seen[static_cast<unsigned>(s.camera)];
      if (column < 0 || row < 0 || column >= in.width || row >= in.height) continue;
      out.row(v)[2 * u + 1] = in.row(static_cast<unsigned>(row))[2 * static_cast<unsigned>(column) + 1];
    }
  return out;
}

std::array<Picture, 4> seen_by(const std::array<Mount, 4>& mount) {
  std::array<Picture, 4> out;
  for (unsigned n = 0; n < 4; ++n)
    out[n] = CarParkSource({kGround.width, kGround.height, false, n}, lens_of(kGround.width, kGround.height), mount[n])
                 .field(0);
  return out;
}

TEST(CarPark, SeenByMountedCamerasItIsThePlan) {
  const auto seen = seen_by(mounts());
  const PlanScore score(kGround, kCarLength, kCarWidth);
  const auto right = score(mosaic(seen, views_of(mounts())));
  std::printf("psnr %.2f dB, lines %u, missed %u, error %.3f px\n", right.psnr_y, right.lines, right.missed,
              right.line_error);
  EXPECT_GT(right.psnr_y, 20);
  EXPECT_GT(right.lines, 290u);
  EXPECT_EQ(right.missed, 0u);
  EXPECT_LT(right.line_error, 0.4);
  // A mount that is wrong by two degrees moves the lines.
  auto wrong = mounts();
  wrong[3].pitch += 2;
  wrong[1].yaw += 2;
  const auto off = score(mosaic(seen, views_of(wrong)));
  EXPECT_GT(off.line_error, 2 * right.line_error);
  EXPECT_LT(off.psnr_y, right.psnr_y - 1);
}

// The lines of the bays reach from -2.9 to 2.7 m; near their ends, where other lines cross them, they are not scored.
TEST(CarPark, ItsBayLinesAreScoredAwayFromTheirEnds) {
  EXPECT_FALSE(car_park_has_bay_lines(-2.9 + 0.2));
  EXPECT_TRUE(car_park_has_bay_lines(std::nextafter(-2.9 + 0.2, 0)));
  EXPECT_TRUE(car_park_has_bay_lines(std::nextafter(2.7 - 0.2, 0)));
  EXPECT_FALSE(car_park_has_bay_lines(2.7 - 0.2));
}

TEST(CarPark, SkyAndGroundMeetAtTheHorizon) {
  // A level camera that looks aside: the ground begins just below the middle row.
  CarParkSource source({320, 256, false, 0}, lens_of(320, 256), {0, 0, 1, 90, 0, 0});
  const Picture& p = source.field(0);
  EXPECT_GT(p.row(120)[2 * 160 + 1], 150);
  EXPECT_LT(p.row(150)[2 * 160 + 1], 120);
}

TEST(PlanScore, IsThatOfThePlanAndOfAPlanThatIsMoved) {
  const PlanScore score(kGround, kCarLength, kCarWidth);
  const Picture plan = car_park_plan(kGround.width, kGround.height, kGround.metres_across, kGround.metres_along);
  const auto same = score(plan);
  EXPECT_TRUE(std::isinf(same.psnr_y));
  EXPECT_NEAR(same.ssim_y, 1, 1e-12);
  EXPECT_EQ(same.line_error, 0);
  EXPECT_EQ(same.missed, 0u);
  Picture moved = plan;
  for (unsigned v = 0; v < plan.height; ++v) std::memmove(moved.row(v) + 4, plan.row(v), plan.row_bytes() - 4);
  const auto by_two = score(moved);
  EXPECT_NEAR(by_two.line_error, 2, 0.2);
  EXPECT_LT(by_two.psnr_y, 30);
  EXPECT_LT(by_two.ssim_y, 0.95);
  // Of the car in the middle, 128 rows of 56 pixels, nothing counts.
  Picture repainted = plan;
  for (unsigned v = 64; v < 192; ++v)
    for (unsigned u = 134; u < 186; ++u) repainted.row(v)[2 * u + 1] = 77;
  EXPECT_TRUE(std::isinf(score(repainted).psnr_y));
  EXPECT_NEAR(score(repainted).ssim_y, 1, 1e-12);
  repainted.row(63)[2 * 160 + 1] = 77;
  EXPECT_FALSE(std::isinf(score(repainted).psnr_y));
  EXPECT_LT(score(repainted).ssim_y, 1);
  // One level in all samples: 20 log10(255).
  Picture brighter = plan;
  for (std::size_t i = 1; i < brighter.uyvy.size(); i += 2) ++brighter.uyvy[i];
  EXPECT_NEAR(score(brighter).psnr_y, 20 * std::log10(255.0), 1e-9);
  // By the definition of the index, of a plan that is brighter by 1.
  EXPECT_GT(score(brighter).ssim_y, 0.99);
  EXPECT_LT(score(brighter).ssim_y, 1);
  const auto none = score(Picture(kGround.width, kGround.height));
  EXPECT_EQ(none.lines, 0u);
  EXPECT_EQ(none.missed, same.lines);
  EXPECT_THROW(score(Picture(kGround.width, kGround.height - 2)), UserError);
}

TEST(Quad, EachSampleIsTheMeanOfFour) {
  std::array<std::unique_ptr<ChartSource>, 4> cameras;
  for (unsigned n = 0; n < 4; ++n) cameras[n] = std::make_unique<ChartSource>(Raster{16, 8, false, n});
  QuadSource quad({cameras[0].get(), cameras[1].get(), cameras[2].get(), cameras[3].get()});
  const Picture out = quad.field(5);
  ASSERT_EQ(out.width, 16u);
  ASSERT_EQ(out.height, 8u);
  for (unsigned v = 0; v < 8; ++v)
    for (unsigned u = 0; u < 16; ++u) {
      const unsigned n = u / 8 + 2 * (v / 4), x = u % 8 * 2, y = v % 4 * 2;
      const Picture& in = cameras[n]->field(5);
      int sum = 0, colour = 0;
      for (unsigned j = 0; j < 2; ++j) {
        for (unsigned i = 0; i < 2; ++i) sum += in.row(y + j)[2 * (x + i) + 1];
        // Cb for even, Cr for odd pixels of the pair, each from the two pairs that it covers.
        for (unsigned pair = 0; pair < 2; ++pair) colour += in.row(y + j)[4 * (x / 4 * 2 + pair) + u % 2 * 2];
      }
      EXPECT_EQ(out.row(v)[2 * u + 1], (sum + 2) / 4) << u << ' ' << v;
      EXPECT_EQ(out.row(v)[2 * u], (colour + 2) / 4) << u << ' ' << v;
    }
}

}  // namespace
}  // namespace fovea::video
