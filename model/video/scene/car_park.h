// A synthetic car park, seen by a camera that is mounted on a car: its plan is known exactly.
#pragma once
#include <cstdint>

#include "model/video/scene/mean_picture.h"
#include "model/video/scene/mount.h"
#include "model/video/scene/sources.h"

namespace fovea::video {

/// The plan: colour of the ground at (x, y), in ground coordinates of mount.h.
SceneColour car_park_colour(double x, double y);

/// The lines between the car's row of bays, at y = bay_line(n) along the car; they run where this is true of x, which
/// leaves out their ends.
inline constexpr unsigned kBayLines = 8;
double bay_line(unsigned n);
bool car_park_has_bay_lines(double x);

/// The plan as a picture: a rectangle of `metres_x` across and `metres_y` along the car, forward is up, the car in
/// the middle. Each pixel is the mean of 16 points of its area.
Picture car_park_plan(unsigned width, unsigned height, double metres_x, double metres_y);

/// What a camera sees of it, through the lens; the sky is bright, and the car itself is not there. A still: each pixel
/// is the mean of nine points of its area.
class CarParkSource : public StampedSource {
 public:
  CarParkSource(const Raster& raster, const LensModel& lens, const Mount& mount);

 protected:
  const Picture& view(std::uint64_t) override { return picture_; }

 private:
  Picture picture_;
};

}  // namespace fovea::video
