#include "model/video/scene/picture_quality.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "model/common/check.h"

namespace fovea::video {
namespace {

constexpr unsigned kWindow = 11;
constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 255 * 0.01 * 255, kC2 = 0.03 * 255 * 0.03 * 255;

void check_sizes(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height)
    throw UserError("two pictures of different sizes cannot be compared");
}

std::array<double, kWindow> window_weights() {
  std::array<double, kWindow> w{};
  double sum = 0;
  for (unsigned i = 0; i < kWindow; ++i) {
    const double d = static_cast<double>(i) - kWindow / 2;
    sum += w[i] = std::exp(-d * d / (2 * kSigma * kSigma));
  }
  for (double& x : w) x /= sum;
  return w;
}

/// Sums in a window: of both pictures, of their squares, and of their product.
struct Moments {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  void add(double weight, const Moments& m) {
    a += weight * m.a;
    b += weight * m.b;
    aa += weight * m.aa;
    bb += weight * m.bb;
    ab += weight * m.ab;
  }
};

double similarity(const Moments& m) {
  const double var_a = m.aa - m.a * m.a, var_b = m.bb - m.b * m.b, cov = m.ab - m.a * m.b;
  return (2 * m.a * m.b + kC1) * (2 * cov + kC2) / ((m.a * m.a + m.b * m.b + kC1) * (var_a + var_b + kC2));
}

}  // namespace

double psnr_y(const Picture& a, const Picture& b) {
  check_sizes(a, b);
  double sum = 0;
  for (std::size_t i = 1; i < a.uyvy.size(); i += 2) {
    const double d = a.uyvy[i] - b.uyvy[i];
    sum += d * d;
  }
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * a.width * a.height / sum);
}

double ssim_y(const Picture& a, const Picture& b) {
  check_sizes(a, b);
  if (a.width < kWindow || a.height < kWindow) throw UserError("a picture is smaller than the window of its score");
  const auto weights = window_weights();
  const unsigned columns = a.width - kWindow + 1, rows = a.height - kWindow + 1;
  // Row by row: sums along each row first, then down the columns.
  std::vector<Moments> along(std::size_t{a.height} * columns);
  for (unsigned v = 0; v < a.height; ++v)
    for (unsigned u = 0; u < columns; ++u)
      for (unsigned i = 0; i < kWindow; ++i) {
        const double x = a.row(v)[2 * (u + i) + 1], y = b.row(v)[2 * (u + i) + 1];
        along[std::size_t{v} * columns + u].add(weights[i], {x, y, x * x, y * y, x * y});
      }
  double sum = 0;
  for (unsigned v = 0; v < rows; ++v)
    for (unsigned u = 0; u < columns; ++u) {
      Moments m;
      for (unsigned i = 0; i < kWindow; ++i) m.add(weights[i], along[std::size_t{v + i} * columns + u]);
      sum += similarity(m);
    }
  return sum / (static_cast<double>(rows) * columns);
}

}  // namespace fovea::video
