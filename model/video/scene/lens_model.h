// How a camera lens maps directions to picture positions, and back.
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace fovea::video {

/// A direction: x right, y down, z along the optical axis.
struct Ray {
  double x = 0, y = 0, z = 1;
};

/// A picture position in pixels, pixel centres at integers.
struct Point {
  double x = 0, y = 0;
};

enum class LensKind {
  kRectilinear,
  kLinear,
  kOrthographic,
  kEquisolid,
  kStereographic,
  kKannalaBrandt
};

/// A radially symmetric lens with its own focal length on each axis.
/// x = cx + fx r(theta) cos(phi), y = cy + fy r(theta) sin(phi), r as listed at radius().
class LensModel {
 public:
  /// Kannala–Brandt, as OpenCV `fisheye` without skew. @throws UserError for fx or fy <= 0; it names
  /// `key`, the parameter that the numbers come from
  static LensModel kannala_brandt(double fx, double fy, double cx, double cy,
                                  std::array<double, 4> k, const std::string& key = "camera.kb");
  /// One of the closed forms with square pixels, centred; the full angle `fov_deg` fills the width.
  /// @throws UserError for an angle that the mapping cannot show
  static LensModel closed_form(LensKind kind, double fov_deg, unsigned width, unsigned height);

  /// The same lens in a picture stretched by sx and sy: pixel edges, not centres, stay aligned.
  LensModel scaled(double sx, double sy) const;

  /// Radius in focal lengths: theta (linear), sin theta, 2 sin(theta/2), 2 tan(theta/2), tan theta,
  /// theta + k1 theta^3 + k2 theta^5 + k3 theta^7 + k4 theta^9. theta in radians, up to theta_max.
  double radius(double theta) const;
  /// Inverse of radius(); negative when no angle up to theta_max has this radius.
  double angle(double radius) const;
  /// Where the mapping stops being usable: the domain's end, or where r(theta) stops growing.
  double theta_max() const { return theta_max_; }

  Point project(const Ray& ray) const;
  /// Unit direction seen at `p`. False when the lens images nothing there.
  bool unproject(const Point& p, Ray& ray) const;

  LensKind kind() const { return kind_; }
  double fx() const { return fx_; }
  double fy() const { return fy_; }
  double cx() const { return cx_; }
  double cy() const { return cy_; }

  /// R in x-pixels at theta = i * theta_end / (count - 1): the tabulated form of this lens.
  /// @throws UserError when theta_end exceeds theta_max()
  std::vector<double> table(std::size_t count, double theta_end) const;

 private:
  LensModel(LensKind kind, double fx, double fy, double cx, double cy, std::array<double, 4> k);
  double slope(double theta) const;

  LensKind kind_;
  double fx_, fy_, cx_, cy_;
  std::array<double, 4> k_;
  double theta_max_;
};

}  // namespace fovea::video
