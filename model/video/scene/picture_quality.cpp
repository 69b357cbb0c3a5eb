#include "model/video/scene/picture_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "model/common/check.h"

namespace fovea::video {
namespace {

constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 255 * 0.01 * 255, kC2 = 0.03 * 255 * 0.03 * 255;

using Weights = std::array<double, kSsimWindow>;

void check_sizes(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height)
    throw UserError("two pictures of different sizes cannot be compared");
}

void check_mask(const Picture& a, const PictureMask& mask) {
  if (mask.size() != std::size_t{a.width} * a.height)
    throw UserError("a mask of another size than the pictures that are compared");
}

Weights window_weights() {
  Weights w{};
  double sum = 0;
  for (unsigned i = 0; i < kSsimWindow; ++i) {
    const double d = static_cast<double>(i) - kSsimWindow / 2;
    sum += w[i] = std::exp(-d * d / (2 * kSigma * kSigma));
  }
  for (double& x : w) x /= sum;
  return w;
}

/// Of windows, one beside the other: weighted sums of both pictures, of their squares, and of their product.
struct Moments {
  std::vector<double> a, b, aa, bb, ab;
  explicit Moments(std::size_t n) : a(n), b(n), aa(n), bb(n), ab(n) {}
};
constexpr std::array kMoments{&Moments::a, &Moments::b, &Moments::aa, &Moments::bb, &Moments::ab};

/// to[u] = the sum of weights[i] * from[u + i * step], in the order of i, for n values of u.
void weigh(const Weights& weights, const double* from, std::size_t step, double* to, std::size_t n) {
  for (std::size_t u = 0; u < n; ++u) {
    double sum = 0;
    for (unsigned i = 0; i < kSsimWindow; ++i) sum += weights[i] * from[i * step + u];
    to[u] = sum;
  }
}

/// Sums along each row, for each window of it.
Moments moments_along(const Picture& a, const Picture& b, const Weights& weights, std::size_t columns) {
  Moments along(a.height * columns), pixels(a.width);
  for (unsigned v = 0; v < a.height; ++v) {
    for (unsigned u = 0; u < a.width; ++u) {
      const double x = a.row(v)[2 * u + 1], y = b.row(v)[2 * u + 1];
      pixels.a[u] = x;
      pixels.b[u] = y;
      pixels.aa[u] = x * x;
      pixels.bb[u] = y * y;
      pixels.ab[u] = x * y;
    }
    for (const auto moment : kMoments)
      weigh(weights, (pixels.*moment).data(), 1, (along.*moment).data() + v * columns, columns);
  }
  return along;
}

double similarity(const Moments& m, std::size_t u) {
  const double a = m.a[u], b = m.b[u];
  const double var_a = m.aa[u] - a * a, var_b = m.bb[u] - b * b, cov = m.ab[u] - a * b;
  return (2 * a * b + kC1) * (2 * cov + kC2) / ((a * a + b * b + kC1) * (var_a + var_b + kC2));
}

/// Whether all pixels of the windows of a row are compared, for each window; by sums of those that are not.
class WholeWindows {
 public:
  WholeWindows(const Picture& a, const PictureMask& mask) : width_(a.width), left_out_(a.width), mask_(mask) {
    for (unsigned v = 0; v < kSsimWindow - 1; ++v) count(v, 1);
  }
  /// The row of windows that begins at row v; to be called for each row in turn.
  std::vector<bool> row(unsigned v) {
    count(v + kSsimWindow - 1, 1);
    std::vector<bool> whole(width_ - kSsimWindow + 1);
    unsigned sum = 0;
    for (unsigned u = 0; u < width_; ++u) {
      sum += left_out_[u];
      if (u >= kSsimWindow) sum -= left_out_[u - kSsimWindow];
      if (u + 1 >= kSsimWindow) whole[u + 1 - kSsimWindow] = sum == 0;
    }
    count(v, -1);
    return whole;
  }

 private:
  void count(unsigned v, int by) {
    for (unsigned u = 0; u < width_; ++u)
      if (!mask_[std::size_t{v} * width_ + u]) left_out_[u] += static_cast<unsigned>(by);
  }
  unsigned width_;
  std::vector<unsigned> left_out_;  // of each column, in the rows of the window
  const PictureMask& mask_;
};

/// The mean over the windows that `row(v)` names.
template <class Rows>
double mean_similarity(const Picture& a, const Picture& b, Rows&& row) {
  const Weights weights = window_weights();
  const std::size_t columns = a.width - kSsimWindow + 1, rows = a.height - kSsimWindow + 1;
  const Moments along = moments_along(a, b, weights, columns);
  Moments windows(columns);
  double sum = 0;
  std::uint64_t count = 0;
  for (unsigned v = 0; v < rows; ++v) {
    const std::vector<bool> counted = row(v);
    for (const auto moment : kMoments)
      weigh(weights, (along.*moment).data() + v * columns, columns, (windows.*moment).data(), columns);
    for (std::size_t u = 0; u < columns; ++u) {
      if (!counted[u]) continue;
      sum += similarity(windows, u);
      ++count;
    }
  }
  return count ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
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

double psnr_y(const Picture& a, const Picture& b, const PictureMask& mask) {
  check_sizes(a, b);
  check_mask(a, mask);
  double sum = 0;
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    const double d = a.uyvy[2 * i + 1] - b.uyvy[2 * i + 1];
    sum += d * d;
    ++count;
  }
  if (!count) return std::numeric_limits<double>::quiet_NaN();
  const double mean = sum / static_cast<double>(count);
  return mean > 0 ? 10 * std::log10(255 * 255 / mean) : std::numeric_limits<double>::infinity();
}

double ssim_y(const Picture& a, const Picture& b) {
  check_sizes(a, b);
  if (a.width < kSsimWindow || a.height < kSsimWindow)
    throw UserError("a picture is smaller than the window of its score");
  const std::vector<bool> all(a.width - kSsimWindow + 1, true);
  return mean_similarity(a, b, [&](unsigned) { return all; });
}

double ssim_y(const Picture& a, const Picture& b, const PictureMask& mask) {
  check_sizes(a, b);
  check_mask(a, mask);
  if (a.width < kSsimWindow || a.height < kSsimWindow) return std::numeric_limits<double>::quiet_NaN();
  WholeWindows windows(a, mask);
  return mean_similarity(a, b, [&](unsigned v) { return windows.row(v); });
}

}  // namespace fovea::video
