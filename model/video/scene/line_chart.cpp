#include "model/video/scene/line_chart.h"

#include <algorithm>
#include <cmath>

namespace fovea::video {
namespace {

constexpr SceneColour kBright{kChartBright, kChartBright, kChartBright}, kDark{kChartDark, kChartDark, kChartDark};
constexpr unsigned kPoints = 3;  ///< of a pixel, in each direction

/// Whether a point at `across` from the middle of a line is on it, where the line reaches as far as `along`.
bool on_side(double across, double along) {
  const double n = std::round(std::abs(across) / kChartPitch);
  return n >= 1 && n <= kChartSquares && std::abs(std::abs(across) - n * kChartPitch) < kChartLine / 2 &&
         std::abs(along) <= chart_half_side(static_cast<unsigned>(n));
}

}  // namespace

SceneColour line_chart_colour(double x, double y) { return on_side(x, y) || on_side(y, x) ? kBright : kDark; }

Picture line_chart_view(const PinholeView& view) {
  return mean_picture(view.width, view.height, kPoints, [&](double u, double v) {
    return line_chart_colour((u - (view.width - 1) / 2.0 + view.shift_x) / view.focal,
                             (v - (view.height - 1) / 2.0 + view.shift_y) / (view.focal * view.aspect));
  });
}

LineChartSource::LineChartSource(const Raster& raster, const LensModel& lens)
    : StampedSource(raster, {lens.cx(), lens.cy()}) {
  picture_ = mean_picture(raster.width, raster.height, kPoints, [&](double u, double v) {
    Ray ray;
    if (!lens.unproject({u, v}, ray)) return SceneColour{};
    return ray.z > 0 ? line_chart_colour(ray.x / ray.z, ray.y / ray.z) : kDark;
  });
}

}  // namespace fovea::video
