// Pictures as in files, and the conversion of displayed video to them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "model/video/scene/rgb_image.h"

namespace fovea::app {

using video::RgbImage;

/// Wider or higher pictures are refused. The limit is far above any camera of this system, and
/// small enough that a damaged header cannot request all memory.
inline constexpr unsigned kMaxPictureSide = 8192;

/// Shape of a pixel on the screen, as a ratio.
struct PixelShape {
  unsigned width = 1, height = 1;
};

/// Converts 4:2:2 video (bytes Cb Y0 Cr Y1, even width, no padding) to RGB.
///
/// BT.601 with limited range (Y 16 to 235, C 16 to 240), in integers with 16 fraction bits,
/// rounded:
///   R = 1.164384 (Y-16) + 1.596027 (Cr-128)
///   G = 1.164384 (Y-16) - 0.391762 (Cb-128) - 0.812968 (Cr-128)
///   B = 1.164384 (Y-16) + 2.017232 (Cb-128)
/// clamped to 0 to 255. Both pixels of a pair use the same chroma, without interpolation.
RgbImage uyvy_to_rgb(unsigned width, unsigned height, std::span<const std::uint8_t> uyvy);

}  // namespace fovea::app
