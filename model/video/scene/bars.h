// Colour bars, as a test generator in a camera's place sends them.
#pragma once
#include <array>

#include "model/video/scene/sources.h"

namespace fovea::video {

/// Eight upright bars of equal width, 100/0/75/0 in the words of ITU-R BT.471: white at full level, then yellow, cyan,
/// green, magenta, red, blue at 75 %, and black. A still. At the edge of two bars no sample is a mixture.
class BarsSource : public StampedSource {
 public:
  static constexpr unsigned kBars = 8;
  /// Y, Cb, Cr by ITU-R BT.601, as ITU-R BT.801 lists them for 8 bits.
  static const std::array<YCbCr, kBars> kColours;
  explicit BarsSource(const Raster& raster);

 protected:
  const Picture& view(std::uint64_t) override { return picture_; }

 private:
  Picture picture_;
};

}  // namespace fovea::video
