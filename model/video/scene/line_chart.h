// A chart of straight lines on a wall in front of the camera: what a pin-hole camera sees of it is known exactly.
#pragma once
#include "model/video/scene/mean_picture.h"
#include "model/video/scene/sources.h"

namespace fovea::video {

/// The wall is at right angles to the optical axis, and its distance is the unit of length. Square n (1 to
/// kChartSquares) has its middle on the axis and sides at n * kChartPitch from it; their ends are left out, so that no
/// line touches another one.
inline constexpr unsigned kChartSquares = 8;
inline constexpr double kChartPitch = 0.2;
inline constexpr double kChartLine = 0.03;  ///< width of a line
inline constexpr double kChartEnd = 0.06;   ///< of each end of a side
/// Lines and wall, as grey of RGB.
inline constexpr double kChartBright = 225, kChartDark = 60;

/// Half the length of a side of square n.
constexpr double chart_half_side(unsigned n) { return n * kChartPitch - kChartEnd; }

/// The colour at (x, y): x right, y down from the optical axis.
SceneColour line_chart_colour(double x, double y);

/// A pin-hole camera: pixel (u, v) shows x = (u - (width - 1) / 2 + shift_x) / focal and
/// y = (v - (height - 1) / 2 + shift_y) / (focal * aspect).
struct PinholeView {
  unsigned width = 720, height = 576;
  double focal = 1;  ///< px
  double aspect = 1;
  double shift_x = 0, shift_y = 0;  ///< px
};

/// What it sees of the chart; each pixel is the mean of nine points of its area.
Picture line_chart_view(const PinholeView& view);

/// What a camera sees of the chart through its lens: a still, made in the same way. Behind the camera it is dark.
class LineChartSource : public StampedSource {
 public:
  LineChartSource(const Raster& raster, const LensModel& lens);

 protected:
  const Picture& view(std::uint64_t) override { return picture_; }

 private:
  Picture picture_;
};

}  // namespace fovea::video
