// The chart of straight lines: corrected with the right lens its lines are straight, with a wrong one they are as bent
// as geometry says. And the scores of pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "model/common/check.h"
#include "model/video/scene/line_score.h"
#include "model/video/scene/picture_quality.h"
#include "tb/oracle/frame_compare.h"
#include "tb/oracle/lens_oracle.h"

namespace fovea::video {
namespace {

constexpr unsigned kWidth = 720, kHeight = 576;
constexpr double kFov = 180;

/// Focal length of the camera's lens: equisolid, by its definition.
double focal_of(double fov_deg) { return kWidth / (4 * std::sin(fov_deg * M_PI / 180 / 4)); }

oracle::Geometry geometry(double fov_deg, oracle::Mapping mapping = oracle::Mapping::kEquisolid) {
  oracle::Geometry g;
  g.mapping = mapping;
  g.fov_deg = fov_deg;
  g.out_focal_px = focal_of(kFov);  // one view, whatever is believed of the lens
  return g;
}

PinholeView view() { return {kWidth, kHeight, focal_of(kFov), 1, 0, 0}; }

const Picture& chart() {
  static LineChartSource source({kWidth, kHeight, false, 0},
                                LensModel::closed_form(LensKind::kEquisolid, kFov, kWidth, kHeight));
  return source.field(0);
}

/// The displayed picture by the oracle's table.
Picture corrected(const oracle::Geometry& g, const Picture& in = chart()) {
  const oracle::Frame out = oracle::remap({in.width, in.height, in.uyvy}, oracle::build_lut(g), g.pitch_bytes);
  Picture shown(out.width, out.height);
  shown.uyvy = out.uyvy;
  return shown;
}

/// Where on the wall the displayed position lies, for a table of `g` and a camera whose lens is equisolid.
Point on_wall(const oracle::Geometry& g, double u, double v) {
  const oracle::Position at = oracle::source_position(g, u, v);
  const double x = at.x - (kWidth - 1) / 2.0, y = at.y - (kHeight - 1) / 2.0, r = std::hypot(x, y);
  if (r == 0) return {0, 0};
  // Behind the camera: outside of everything on the wall.
  const double tangent = r < 2 * focal_of(kFov) * std::sin(M_PI / 4)
                             ? std::tan(2 * std::asin(r / (2 * focal_of(kFov))))
                             : 1e6;
  return {x / r * tangent, y / r * tangent};
}

/// The score that geometry alone gives: each line is traced through the table's exact positions.
double predicted(const oracle::Geometry& g) {
  double sum = 0;
  std::size_t count = 0;
  for (const bool turned : {false, true}) {
    const double length = turned ? kWidth : kHeight, breadth = turned ? kHeight : kWidth;
    const auto wall = [&](double along, double across) {
      const Point p = turned ? on_wall(g, along, across) : on_wall(g, across, along);
      return turned ? Point{p.y, p.x} : p;
    };
    for (unsigned n = 1; n <= kChartSquares; ++n) {
      std::vector<Point> line;
      for (double along = 0; along < length; ++along) {
        double low = (breadth - 1) / 2, high = breadth - 6;
        if (wall(along, high).x < n * kChartPitch) continue;
        for (int i = 0; i < 60; ++i) {
          const double mid = (low + high) / 2;
          (wall(along, mid).x < n * kChartPitch ? low : high) = mid;
        }
        if (std::abs(wall(along, low).y) <= chart_half_side(n)) line.push_back({along, low});
      }
      double c = 0;
      for (const Point& p : line) c += p.y / static_cast<double>(line.size());
      // A centred lens bends a line symmetrically, so the best straight line is parallel to it.
      for (const Point& p : line) sum += (p.y - c) * (p.y - c);
      count += line.size();
    }
  }
  return std::sqrt(sum / static_cast<double>(count));
}

/// By how many displayed pixels one of the camera's can be away at most: the largest magnification of the view.
double largest_magnification() {
  const double theta = std::atan(std::hypot(kWidth / 2.0, kHeight / 2.0) / focal_of(kFov));
  return 1 / (std::cos(theta / 2) * std::cos(theta) * std::cos(theta));  // F sec² / (f cos(theta / 2)), F = f
}

TEST(LineChart, CorrectedWithTheRightLensItsLinesAreStraight) {
  const LineScore score(view());
  const auto right = score(corrected(geometry(kFov)));
  std::printf("straightness %.3f px of %u places, missed %u, psnr %.2f dB, ssim %.4f\n", right.straightness,
              right.places, right.missed, right.psnr_y, right.ssim_y);
  EXPECT_LT(predicted(geometry(kFov)), 1e-6);
  // A pair of pixels moves as a whole. Its first pixel shows one that is at most 1.5 px left or 0.5 px right, and
  // 0.5 px above or below, of the right place: a root mean square of 1/√3 px about its mean, magnified by the view.
  EXPECT_LT(right.straightness, std::sqrt(1 / 3.0) * largest_magnification());
  EXPECT_GT(right.places, 6500u);
  EXPECT_LT(right.missed, right.places / 100);
}

TEST(LineChart, CorrectedWithAWrongLensItsLinesAreBentAsGeometrySays) {
  const LineScore score(view());
  const auto right = score(corrected(geometry(kFov)));
  double last = right.straightness;
  for (const double fov : {170.0, 155.0, 130.0}) {
    const auto wrong = score(corrected(geometry(fov)));
    const double expected = std::hypot(predicted(geometry(fov)), right.straightness);
    std::printf("fov %.0f: straightness %.3f px, geometry %.3f px, places %u, missed %u, psnr %.2f dB, ssim %.4f\n",
                fov, wrong.straightness, predicted(geometry(fov)), wrong.places, wrong.missed, wrong.psnr_y,
                wrong.ssim_y);
    EXPECT_NEAR(wrong.straightness, expected, 0.1 * expected) << fov;
    EXPECT_GT(wrong.straightness, 1.2 * last);
    EXPECT_LT(wrong.psnr_y, right.psnr_y - 1);
    EXPECT_LT(wrong.ssim_y, right.ssim_y);
    last = wrong.straightness;
  }
  for (const auto mapping : {oracle::Mapping::kOrthographic, oracle::Mapping::kStereographic}) {
    const auto wrong = score(corrected(geometry(kFov, mapping)));
    std::printf("mapping: straightness %.3f px, geometry %.3f px\n", wrong.straightness,
                predicted(geometry(kFov, mapping)));
    EXPECT_GT(wrong.straightness, 2 * right.straightness);
  }
  const auto bent = score(chart());
  const double expected = predicted(geometry(kFov, oracle::Mapping::kNone));
  std::printf("uncorrected: straightness %.3f px, geometry %.3f px, places %u, missed %u, psnr %.2f dB\n",
              bent.straightness, expected, bent.places, bent.missed, bent.psnr_y);
  EXPECT_NEAR(bent.straightness, expected, 0.1 * expected);
  EXPECT_GT(bent.straightness, 1.2 * last);
}

TEST(LineScore, IsThatOfAPinHoleCamerasPictureAndOfOneThatIsMoved) {
  const LineScore score(view());
  const Picture ideal = line_chart_view(view());
  const auto same = score(ideal);
  std::printf("ideal: %u places, missed %u, straightness %.4f\n", same.places, same.missed, same.straightness);
  EXPECT_TRUE(std::isinf(same.psnr_y));
  EXPECT_EQ(same.ssim_y, 1);
  EXPECT_LT(same.straightness, 0.01);
  EXPECT_EQ(same.missed, 0u);
  // A line that is moved as a whole is as straight as before.
  Picture moved = ideal;
  for (unsigned v = 0; v < kHeight; ++v) std::memmove(moved.row(v) + 8, ideal.row(v), ideal.row_bytes() - 8);
  const auto by_four = score(moved);
  EXPECT_LT(by_four.straightness, 0.01);
  EXPECT_LT(by_four.psnr_y, 20);
}

TEST(LineScore, TellsTheDistanceOfABentLine) {
  const LineScore score(view());
  const Picture ideal = line_chart_view(view());
  // All rows below the middle are two pixels further right: of each upright line half the points are a pixel to each
  // side of their mean, and the best straight line is inclined. With x = -1 ... 1 along it, the points are at sign(x),
  // the line at 1.5 x, and what is left has the mean square 1 - 0.75.
  Picture step = ideal;
  for (unsigned v = kHeight / 2; v < kHeight; ++v) std::memmove(step.row(v) + 4, ideal.row(v), ideal.row_bytes() - 4);
  const auto bent = score(step);
  const auto same = score(ideal);
  // Level lines are not bent, but for the middle of those that are moved, of which each half is straight.
  const double upright = bent.straightness * bent.straightness * bent.places;
  EXPECT_NEAR(std::sqrt(upright / (same.places / 2.0)), 0.5, 0.05);
}

// A line is looked for up to four pixels beside its continuation. Here each is five wide, with its middle in the
// middle of a pixel: moved by six, it begins four beside.
TEST(LineScore, FollowsALineThatIsAFewPixelsBeside) {
  PinholeView thin = view();
  thin.focal = 165;
  thin.shift_x = thin.shift_y = 0.5;
  const LineScore score(thin);
  const Picture ideal = line_chart_view(thin);
  EXPECT_EQ(score(ideal).missed, 0u);
  for (const unsigned pixels : {6u, 8u}) {
    Picture step = ideal;
    for (unsigned v = kHeight / 2; v < kHeight; ++v)
      std::memmove(step.row(v) + 2 * pixels, ideal.row(v), ideal.row_bytes() - 2 * pixels);
    if (pixels == 6)
      EXPECT_LT(score(step).missed, 100u);
    else
      EXPECT_GT(score(step).missed, 1000u);
  }
}

TEST(LineScore, CountsWhatIsNotThere) {
  const LineScore score(view());
  const auto same = score(line_chart_view(view()));
  const auto none = score(Picture(kWidth, kHeight));
  EXPECT_EQ(none.places, 0u);
  // Where a line ends, a pixel that is bright by a part is found too.
  EXPECT_NEAR(none.missed, same.places, 2 * 4 * kChartSquares);
  EXPECT_EQ(none.straightness, 0);
  // Rows that are black, as after late data of the display, are missed by upright lines; they are followed across
  // three of them, and four are too many.
  for (const unsigned rows : {3u, 4u}) {
    Picture gap = line_chart_view(view());
    std::memcpy(gap.row(200), Picture(kWidth, rows).row(0), std::size_t{rows} * gap.row_bytes());
    const auto holed = score(gap);
    if (rows == 3)
      EXPECT_LE(holed.missed, rows * 2 * kChartSquares);
    else
      EXPECT_GT(holed.missed, 500u);
  }
  EXPECT_THROW(score(Picture(kWidth, kHeight - 2)), UserError);
  PinholeView aside = view();
  aside.shift_x = 359;
  EXPECT_NO_THROW(LineScore{aside});
  aside.shift_x = 359.5;
  EXPECT_THROW(LineScore{aside}, UserError);
}

// Two dark pixels within a line are bridged, from whichever side it is met. Here lines are six wide, and every second
// row of the upright ones lacks two pixels: of one the middle ones; of another those right of the left three, which
// moves the centre of these rows by half a pixel.
TEST(LineScore, BridgesTwoDarkPixelsWithinALine) {
  PinholeView wide = view();
  wide.focal = 200;
  const LineScore score(wide);
  const Picture ideal = line_chart_view(wide);
  const std::uint8_t dark = ideal.row(kHeight / 2)[2 * (kWidth / 2) + 1];
  for (const int right : {0, 1}) {
    Picture holed = ideal;
    for (int n = -7; n <= 7; ++n) {
      if (n == 0) continue;
      const double half = (std::abs(n) * 0.2 - 0.06) * 200 - 3;
      for (unsigned v = 1; v < kHeight; v += 2)
        if (std::abs(v - (kHeight - 1) / 2.0) < half)
          for (const int u : {359 + 40 * n + right, 360 + 40 * n + right}) holed.row(v)[2 * u + 1] = dark;
    }
    const auto bridged = score(holed);
    EXPECT_EQ(bridged.places, score(ideal).places);
    EXPECT_LT(bridged.straightness, right == 0 ? 0.05 : 0.26);
  }
}

// A line counts if two pixels and one more are free on each side of it. The left side of square 5 is 3 pixels wide and
// 188 long here: from the middle, at row 287.5, 94 in each direction.
TEST(LineScore, ExpectsLinesThatAreWhollyInside) {
  const auto missed = [](double middle_of_line) {
    PinholeView aside = view();
    aside.focal = 100;
    aside.shift_x = 359.5 - 100 - middle_of_line;
    return LineScore(aside)(Picture(kWidth, kHeight)).missed;
  };
  EXPECT_EQ(missed(4.5), missed(4.5 - 1e-9) + 188);
}

TEST(PictureQuality, FollowsItsFormulas) {
  const Picture a(32, 16, 100), b(32, 16, 110);
  EXPECT_NEAR(psnr_y(a, b), 20 * std::log10(25.5), 1e-9);
  const double c1 = 0.01 * 255 * 0.01 * 255;
  EXPECT_NEAR(ssim_y(a, b), (2 * 100 * 110 + c1) / (100 * 100 + 110 * 110 + c1), 1e-9);
  EXPECT_TRUE(std::isinf(psnr_y(a, a)));
  EXPECT_NEAR(ssim_y(a, a), 1, 1e-12);
  EXPECT_THROW(psnr_y(a, Picture(32, 18)), UserError);
  EXPECT_THROW(ssim_y(a, Picture(30, 16)), UserError);
  EXPECT_THROW(ssim_y(Picture(32, 10), Picture(32, 10)), UserError);
  // Colour counts for nothing.
  EXPECT_TRUE(std::isinf(psnr_y(a, Picture(32, 16, 100, 90, 200))));
}

/// By the definition, one window at a time.
double ssim_slowly(const Picture& a, const Picture& b) {
  double sum = 0, weights = 0;
  for (int j = -5; j <= 5; ++j)
    for (int i = -5; i <= 5; ++i) weights += std::exp(-(i * i + j * j) / 4.5);
  unsigned windows = 0;
  for (int y = 5; y + 5 < static_cast<int>(a.height); ++y)
    for (int x = 5; x + 5 < static_cast<int>(a.width); ++x, ++windows) {
      const auto mean = [&](const std::function<double(double, double)>& f) {
        double m = 0;
        for (int j = -5; j <= 5; ++j)
          for (int i = -5; i <= 5; ++i)
            m += std::exp(-(i * i + j * j) / 4.5) / weights *
                 f(a.row(static_cast<unsigned>(y + j))[2 * (x + i) + 1],
                   b.row(static_cast<unsigned>(y + j))[2 * (x + i) + 1]);
        return m;
      };
      const double ma = mean([](double p, double) { return p; }), mb = mean([](double, double q) { return q; });
      const double va = mean([&](double p, double) { return (p - ma) * (p - ma); });
      const double vb = mean([&](double, double q) { return (q - mb) * (q - mb); });
      const double cov = mean([&](double p, double q) { return (p - ma) * (q - mb); });
      const double c1 = 6.5025, c2 = 58.5225;
      sum += (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
    }
  return sum / windows;
}

TEST(PictureQuality, IsThatOfTheDefinition) {
  ChartSource one({32, 24, false, 0}), other({32, 24, false, 1});
  const Picture a = one.field(0), b = other.field(3);
  EXPECT_NEAR(ssim_y(a, b), ssim_slowly(a, b), 1e-9);
  EXPECT_LT(ssim_y(a, b), 0.3);
}

}  // namespace
}  // namespace fovea::video
