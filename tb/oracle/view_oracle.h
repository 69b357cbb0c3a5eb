// Independent oracle of composed views: which camera each displayed pair shows, and which of its pixels. Written from
// the description in sw/lens/README.md; shares no code with the firmware's tables, the host's page or the scenes.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tb/oracle/frame_compare.h"
#include "tb/oracle/lens_oracle.h"

namespace fovea::oracle {

/// A camera on the car; metres and degrees, as the keys camera.N.mount.* have them.
struct CarCamera {
  double x = 0, y = 0, height = 1, yaw = 0, pitch = 0, roll = 0;
};

struct Views {
  bool birds_eye = false;  ///< else the four-way view
  bool quad = false;       ///< cameras' pictures are quarters of one frame
  std::array<Geometry, 4> lens;
  std::array<CarCamera, 4> mount;
  double ground_width = 16, ground_height = 12, car_length = 4.8, car_width = 2;  ///< metres
};

/// What the displayed position (u, v) shows.
struct Shown {
  int camera = -1;   ///< -1: black
  Position at;       ///< in the camera's whole picture
  bool ahead = true; ///< the direction is less than 90 degrees from the axis
};
Shown shown_at(const Views& views, double u, double v);

/// Compares a whole table of a view with the exact positions: an entry is right if it is that of a position within
/// the tolerance, and of a camera that is shown within it (`seam_px` of display pixels for that).
LutCheck check_view(std::span<const std::uint32_t> lut, const Views& views, double tolerance_px = 0.02,
                    double seam_px = 1e-6);

/// The camera of each displayed pair; -1: black.
std::vector<int> cameras_of(const Views& views);

/// The displayed picture from a frame of each camera by a table; with a quad processor from the one frame in all
/// places. A camera without a frame is black.
Frame compose(const std::array<const Frame*, 4>& frames, std::span<const std::uint32_t> lut,
              std::span<const int> cameras, std::uint32_t pitch_bytes);

}  // namespace fovea::oracle
