// A decoded still or video frame, as the loaders of the host program deliver it.
#pragma once
#include <cstdint>
#include <vector>

namespace fovea::video {

/// 8-bit R G B, rows top to bottom, no padding.
struct RgbImage {
  unsigned width = 0;
  unsigned height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3 bytes

  const std::uint8_t* pixel(unsigned x, unsigned y) const {
    return rgb.data() + (std::size_t{y} * width + x) * 3;
  }
};

}  // namespace fovea::video
