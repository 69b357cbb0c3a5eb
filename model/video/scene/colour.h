// Colour conversion and sampling of scene pictures, in integer arithmetic.
#pragma once
#include <cstdint>
#include <vector>

#include "model/video/core/picture.h"
#include "model/video/scene/rgb_image.h"

namespace fovea::video {

struct YCbCr {
  std::uint8_t y = 16, cb = 128, cr = 128;
  friend bool operator==(const YCbCr&, const YCbCr&) = default;
};

/// ITU-R BT.601, limited range (Y 16 to 235, C 16 to 240), in the usual 8-bit integer form:
/// Y = 16 + (66 R + 129 G + 25 B + 128 >> 8), Cb = 128 + (-38 R - 74 G + 112 B + 128 >> 8),
/// Cr = 128 + (112 R - 94 G - 18 B + 128 >> 8).
YCbCr to_ycbcr(std::uint8_t r, std::uint8_t g, std::uint8_t b);

/// A 4:4:4 picture that can be sampled between pixels. A pixel is one 64-bit word with Y, Cb and Cr
/// in its 16-bit lanes 0, 1 and 2, so that one multiplication interpolates all three.
class SampledImage {
 public:
  /// Converts an RGB picture. @throws UserError if it is empty or its size does not match its data
  explicit SampledImage(const RgbImage& image) { assign(image); }
  /// Replaces the picture by another one, reusing the memory.
  void assign(const RgbImage& image);

  unsigned width() const { return width_; }
  unsigned height() const { return height_; }

  /// Bilinear sample at (x, y) in pixels, with pixel centres at integers and weights in steps of
  /// 1/256. Positions up to half a pixel outside repeat the edge; beyond, the result is black.
  std::uint64_t sample(float x, float y) const {
    // Also false for NaN. This must come first: a float outside the range of int must not be
    // converted.
    if (!(x >= -0.5f && y >= -0.5f && x <= max_x_ && y <= max_y_)) return kBlackLanes;
    const int fx = static_cast<int>((x + 1.0f) * 256.0f);
    const int fy = static_cast<int>((y + 1.0f) * 256.0f);
    const std::uint64_t* p =
        lanes_.data() + static_cast<std::size_t>(fy >> 8) * stride_ + (fx >> 8);
    const std::uint64_t upper = lerp(p[0], p[1], fx & 255);
    const std::uint64_t lower = lerp(p[stride_], p[stride_ + 1], fx & 255);
    return lerp(upper, lower, fy & 255);
  }

  static std::uint64_t lanes(const YCbCr& c) {
    return c.y | std::uint64_t{c.cb} << 16 | std::uint64_t{c.cr} << 32;
  }
  static constexpr std::uint64_t kBlackLanes = 16 | 128ull << 16 | 128ull << 32;

 private:
  static std::uint64_t lerp(std::uint64_t a, std::uint64_t b, unsigned weight) {
    constexpr std::uint64_t kHalf = 0x0000'0080'0080'0080;
    constexpr std::uint64_t kMask = 0x0000'00ff'00ff'00ff;
    return (a * (256 - weight) + b * weight + kHalf) >> 8 & kMask;
  }

  unsigned width_ = 0, height_ = 0;
  std::size_t stride_ = 0;  ///< width + 2: the edge pixel is repeated on each side
  float max_x_ = 0, max_y_ = 0;
  std::vector<std::uint64_t> lanes_;
};

/// Writes one row of 4:4:4 samples as UYVY. Chroma is taken at the even pixels, filtered with
/// weights 1-2-1 over the neighbours (the first and last pixel are repeated). `width` must be even.
void pack_row(const std::uint64_t* lanes, unsigned width, std::uint8_t* uyvy);

/// Converts a picture of the size of the raster. @throws UserError as SampledImage does, and if the
/// width is odd
Picture to_picture(const RgbImage& image);

}  // namespace fovea::video
