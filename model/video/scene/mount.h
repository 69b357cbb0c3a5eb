// How a camera is mounted on a car. Ground coordinates: metres from the middle of the car on the ground, x forward,
// y to the left, z up.
#pragma once
#include <array>

#include "model/video/scene/lens_model.h"

namespace fovea::video {

struct Mount {
  double x = 0, y = 0, height = 1;  ///< metres
  double yaw = 0;    ///< degrees; 0: forward, 90: to the left
  double pitch = 0;  ///< degrees of the axis below the horizon
  double roll = 0;   ///< degrees clockwise, seen from behind the camera
};

/// Unit vectors of a camera's axes in ground coordinates.
struct MountAxes {
  Ray right, down, forward;
};
MountAxes axes_of(const Mount& mount);

/// Where a ray of the camera (x right, y down, z along the axis) meets the ground; false if it does not.
bool meets_ground(const Mount& mount, const MountAxes& axes, const Ray& ray, Point& ground);

/// A picture of the ground from above, the middle of the car in its middle, forward is up.
struct GroundPicture {
  unsigned width = 720, height = 576;          ///< pixels
  double metres_across = 16, metres_along = 12;  ///< of the ground
};

/// Row by row a matrix from a pixel (u, v, 1) of that picture to the ray of the camera to the ground point, in the
/// camera's axes right, down, forward; metres.
std::array<double, 9> ray_matrix(const GroundPicture& picture, const Mount& mount);

}  // namespace fovea::video
