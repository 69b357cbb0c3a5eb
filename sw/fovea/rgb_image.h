// A picture as files hold it, and the conversion of displayed video to it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "model/video/scene/rgb_image.h"

namespace fovea::app {

using video::RgbImage;

/// Pictures wider or higher than this are refused: far above any camera of this system, and small
/// enough that a damaged header cannot ask for all memory.
inline constexpr unsigned kMaxPictureSide = 8192;

/// Converts 4:2:2 video (bytes Cb Y0 Cr Y1, even width, no padding) to RGB.
///
/// BT.601 with limited range (Y 16..235, C 16..240), in integers with 16 fraction bits, rounded:
///   R = 1.164384 (Y-16) + 1.596027 (Cr-128)
///   G = 1.164384 (Y-16) - 0.391762 (Cb-128) - 0.812968 (Cr-128)
///   B = 1.164384 (Y-16) + 2.017232 (Cb-128)
/// clamped to 0..255; both pixels of a pair use the pair's chroma as it is.
RgbImage uyvy_to_rgb(unsigned width, unsigned height, std::span<const std::uint8_t> uyvy);

}  // namespace fovea::app
