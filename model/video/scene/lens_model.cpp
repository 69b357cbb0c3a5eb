#include "model/video/scene/lens_model.h"

#include <cmath>
#include <numbers>
#include <string>

#include "model/common/check.h"

namespace fovea::video {
namespace {

constexpr double kPi = std::numbers::pi;
/// Rectilinear and stereographic radii grow without bound; larger angles are of no use.
constexpr double kRectilinearLimit = 89.0 * kPi / 180;
constexpr double kStereographicLimit = 170.0 * kPi / 180;
/// Kannala–Brandt polynomials are fitted up to the edge of the image circle, about 100 degrees.
constexpr double kPolynomialLimit = 120.0 * kPi / 180;

}  // namespace

LensModel::LensModel(LensKind kind, double fx, double fy, double cx, double cy,
                     std::array<double, 4> k)
    : kind_(kind), fx_(fx), fy_(fy), cx_(cx), cy_(cy), k_(k) {
  switch (kind) {
    case LensKind::kRectilinear:
      theta_max_ = kRectilinearLimit;
      break;
    case LensKind::kOrthographic:
      theta_max_ = kPi / 2;
      break;
    case LensKind::kStereographic:
      theta_max_ = kStereographicLimit;
      break;
    case LensKind::kLinear:
    case LensKind::kEquisolid:
      theta_max_ = kPi;
      break;
    case LensKind::kKannalaBrandt: {
      // The first angle at which the curve stops growing, to a hundredth of a degree.
      const double step = kPi / 18000;
      theta_max_ = 0;
      for (int i = 1; i * step <= kPolynomialLimit && slope(i * step) > 0; ++i)
        theta_max_ = i * step;
      break;
    }
  }
}

LensModel LensModel::kannala_brandt(double fx, double fy, double cx, double cy,
                                    std::array<double, 4> k, const std::string& key) {
  if (!(fx > 0 && fy > 0))
    throw UserError("key '" + key + "': fx and fy are focal lengths in pixels; allowed: above 0");
  LensModel lens(LensKind::kKannalaBrandt, fx, fy, cx, cy, k);
  if (lens.theta_max_ < 10 * kPi / 180)
    throw UserError("key '" + key +
                    "': with these k1..k4 the radius falls within 10 degrees of the "
                    "axis; allowed: a radius that grows with the angle");
  return lens;
}

LensModel LensModel::closed_form(LensKind kind, double fov_deg, unsigned width, unsigned height) {
  FOVEA_CHECK(kind != LensKind::kKannalaBrandt, "not a closed form");
  LensModel lens(kind, 1, 1, (width - 1) / 2.0, (height - 1) / 2.0, {});
  const double half = fov_deg / 2 * kPi / 180;
  if (!(half > 0) || half > lens.theta_max_ + 1e-12)
    throw UserError("camera.fov: " + std::to_string(fov_deg) +
                    " deg cannot be shown by this camera.lens; allowed: above 0 up to " +
                    std::to_string(lens.theta_max_ * 360 / kPi) + " deg");
  lens.fx_ = lens.fy_ = width / 2.0 / lens.radius(half);
  return lens;
}

LensModel LensModel::scaled(double sx, double sy) const {
  LensModel lens = *this;
  lens.fx_ *= sx;
  lens.fy_ *= sy;
  lens.cx_ = (cx_ + 0.5) * sx - 0.5;
  lens.cy_ = (cy_ + 0.5) * sy - 0.5;
  return lens;
}

double LensModel::radius(double t) const {
  switch (kind_) {
    case LensKind::kRectilinear:
      return std::tan(t);
    case LensKind::kLinear:
      return t;
    case LensKind::kOrthographic:
      return std::sin(t);
    case LensKind::kEquisolid:
      return 2 * std::sin(t / 2);
    case LensKind::kStereographic:
      return 2 * std::tan(t / 2);
    case LensKind::kKannalaBrandt:
      break;
  }
  const double q = t * t;
  return t * (1 + q * (k_[0] + q * (k_[1] + q * (k_[2] + q * k_[3]))));
}

double LensModel::slope(double t) const {
  const double q = t * t;
  return 1 + q * (3 * k_[0] + q * (5 * k_[1] + q * (7 * k_[2] + q * 9 * k_[3])));
}

double LensModel::angle(double r) const {
  if (r < 0 || r > radius(theta_max_)) return -1;
  switch (kind_) {
    case LensKind::kRectilinear:
      return std::atan(r);
    case LensKind::kLinear:
      return r;
    case LensKind::kOrthographic:
      return std::asin(r);
    case LensKind::kEquisolid:
      return 2 * std::asin(r / 2);
    case LensKind::kStereographic:
      return 2 * std::atan(r / 2);
    case LensKind::kKannalaBrandt:
      break;
  }
  // Newton's method within a shrinking interval: the curve grows from 0 to theta_max, but may be
  // flat.
  double low = 0, high = theta_max_, t = std::min(r, high);
  for (int i = 0; i < 60; ++i) {
    const double error = radius(t) - r;
    (error > 0 ? high : low) = t;
    double next = t - error / slope(t);
    if (!(next > low && next < high)) next = (low + high) / 2;
    if (std::abs(next - t) < 1e-13) return next;
    t = next;
  }
  return t;
}

Point LensModel::project(const Ray& ray) const {
  const double sine = std::hypot(ray.x, ray.y);
  if (sine == 0) return {cx_, cy_};
  const double scale = radius(std::atan2(sine, ray.z)) / sine;
  return {cx_ + fx_ * scale * ray.x, cy_ + fy_ * scale * ray.y};
}

bool LensModel::unproject(const Point& p, Ray& ray) const {
  const double x = (p.x - cx_) / fx_;
  const double y = (p.y - cy_) / fy_;
  const double r = std::hypot(x, y);
  const double theta = angle(r);
  if (theta < 0) return false;
  const double scale = r > 0 ? std::sin(theta) / r : 1;
  ray = {x * scale, y * scale, std::cos(theta)};
  return true;
}

std::vector<double> LensModel::table(std::size_t count, double theta_end) const {
  FOVEA_CHECK(count >= 2, "a lens table has two points at least");
  if (!(theta_end > 0 && theta_end <= theta_max_ + 1e-12))
    throw UserError("lens table up to " + std::to_string(theta_end * 180 / kPi) +
                    " deg: the lens is described only up to " +
                    std::to_string(theta_max_ * 180 / kPi) + " deg");
  std::vector<double> r(count);
  for (std::size_t i = 0; i < count; ++i)
    r[i] = fx_ * radius(static_cast<double>(i) * theta_end / static_cast<double>(count - 1));
  return r;
}

}  // namespace fovea::video
