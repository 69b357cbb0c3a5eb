#include "model/video/scene/pixel_remap.h"

#include <cmath>

namespace fovea::video {
namespace {

/// From the middle of the view, shifted, to a position in the picture; nothing beyond the lens's largest angle.
std::optional<Point> source_of(const Picture& taken, const PinholeView& view, const std::optional<TakingLens>& lens,
                               double x, double y) {
  if (!lens) return Point{(taken.width - 1) / 2.0 + x, (taken.height - 1) / 2.0 + y};
  x /= view.focal;
  y /= view.focal * view.aspect;
  const double r = std::hypot(x, y);
  if (r == 0) return lens->centre;
  const double theta = std::atan(r);
  if (theta > lens->theta_max) return std::nullopt;
  const double stretch = lens->focal * lens->model.radius(theta) / r;
  return Point{lens->centre.x + stretch * x, lens->centre.y + lens->aspect * stretch * y};
}

}  // namespace

Picture remap_pixels(const Picture& taken, const PinholeView& view, const std::optional<TakingLens>& lens) {
  Picture out(view.width, view.height);
  for (unsigned v = 0; v < view.height; ++v)
    for (unsigned u = 0; u < view.width; ++u) {
      const auto at = source_of(taken, view, lens, u - (view.width - 1) / 2.0 + view.shift_x,
                                v - (view.height - 1) / 2.0 + view.shift_y);
      if (!at) continue;
      const double column = std::floor(at->x + 0.5), row = std::floor(at->y + 0.5);
      if (!(column >= 0 && row >= 0 && column < taken.width && row < taken.height)) continue;
      const auto from = static_cast<unsigned>(column);
      const std::uint8_t* source = taken.row(static_cast<unsigned>(row));
      std::uint8_t* shown = out.row(v);
      shown[2 * u + 1] = source[2 * from + 1];
      if (u % 2) continue;
      shown[2 * u] = source[2 * (from & ~1u)];
      shown[2 * u + 2] = source[2 * (from & ~1u) + 2];
    }
  return out;
}

}  // namespace fovea::video
