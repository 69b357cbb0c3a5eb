#include "model/video/scene/mount.h"

#include <cmath>
#include <numbers>

namespace fovea::video {
namespace {

Ray turned(const Ray& a, const Ray& b, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * a.x + s * b.x, c * a.y + s * b.y, c * a.z + s * b.z};
}

}  // namespace

MountAxes axes_of(const Mount& mount) {
  const double degree = std::numbers::pi / 180;
  const double yaw = mount.yaw * degree;
  const Ray ahead{std::cos(yaw), std::sin(yaw), 0}, aside{std::sin(yaw), -std::cos(yaw), 0};
  const Ray below{0, 0, -1};
  MountAxes out;
  out.forward = turned(ahead, below, mount.pitch * degree);
  const Ray down = turned(below, ahead, -mount.pitch * degree);
  out.right = turned(aside, down, mount.roll * degree);
  out.down = turned(down, aside, -mount.roll * degree);
  return out;
}

bool meets_ground(const Mount& mount, const MountAxes& axes, const Ray& ray, Point& ground) {
  const auto along = [&](double right, double down, double forward) {
    return ray.x * right + ray.y * down + ray.z * forward;
  };
  const double fall = -along(axes.right.z, axes.down.z, axes.forward.z);
  if (!(fall > 1e-9)) return false;
  const double length = mount.height / fall;
  ground = {mount.x + length * along(axes.right.x, axes.down.x, axes.forward.x),
            mount.y + length * along(axes.right.y, axes.down.y, axes.forward.y)};
  return true;
}

std::array<double, 9> ray_matrix(const GroundPicture& picture, const Mount& mount) {
  // The ground point is x = x0 - v * rise, y = y0 - u * run; the ray to it is that less the camera's position.
  const double run = picture.metres_across / picture.width, rise = picture.metres_along / picture.height;
  const double x0 = (picture.height - 1) / 2.0 * rise, y0 = (picture.width - 1) / 2.0 * run;
  const MountAxes axes = axes_of(mount);
  std::array<double, 9> m{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Ray& axis = i == 0 ? axes.right : i == 1 ? axes.down : axes.forward;
    m[3 * i] = -axis.y * run;
    m[3 * i + 1] = -axis.x * rise;
    m[3 * i + 2] = axis.x * (x0 - mount.x) + axis.y * (y0 - mount.y) - axis.z * mount.height;
  }
  return m;
}

}  // namespace fovea::video
