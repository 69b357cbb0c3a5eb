// Camera lens: mapping between directions and picture positions.
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

/// A radially symmetric lens with separate focal lengths for x and y:
/// x = cx + fx r(theta) cos(phi), y = cy + fy r(theta) sin(phi), with r as listed at radius().
class LensModel {
 public:
  /// Kannala–Brandt model, as in OpenCV `fisheye` without skew; fx, fy, cx, cy in pixels. @throws
  /// UserError if fx or fy <= 0; it names `key`, the parameter with these numbers
  static LensModel kannala_brandt(double fx, double fy, double cx, double cy,
                                  std::array<double, 4> k, const std::string& key = "camera.kb");
  /// A closed-form lens with square pixels, centred; the full angle `fov_deg` (degrees) spans the
  /// width. @throws UserError for an angle that the mapping cannot represent
  static LensModel closed_form(LensKind kind, double fov_deg, unsigned width, unsigned height);

  /// The same lens for a picture stretched by sx and sy; pixel edges, not centres, stay aligned.
  LensModel scaled(double sx, double sy) const;

  /// Radius in focal lengths: theta (linear), sin theta, 2 sin(theta/2), 2 tan(theta/2), tan theta,
  /// or theta + k1 theta^3 + k2 theta^5 + k3 theta^7 + k4 theta^9. theta in radians, at most
  /// theta_max().
  double radius(double theta) const;
  /// Inverse of radius(); negative if no angle up to theta_max() has this radius.
  double angle(double radius) const;
  /// Largest usable angle in radians: the end of the domain, or where r(theta) stops growing.
  double theta_max() const { return theta_max_; }

  Point project(const Ray& ray) const;
  /// Computes the unit direction seen at `p`. Returns false if the lens images nothing there.
  bool unproject(const Point& p, Ray& ray) const;

  LensKind kind() const { return kind_; }
  double fx() const { return fx_; }
  double fy() const { return fy_; }
  double cx() const { return cx_; }
  double cy() const { return cy_; }

  /// Radii in pixels of the x axis at theta = i * theta_end / (count - 1): this lens as a table.
  /// @throws UserError if theta_end exceeds theta_max()
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
