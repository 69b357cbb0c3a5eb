// A quad processor: an external device that puts the pictures of four genlocked cameras into one.
#pragma once
#include <array>
#include <cstdint>

#include "model/video/core/picture.h"

namespace fovea::video {

/// Cameras 0 and 1 above, 2 and 3 below, each at half width and half height: a sample is the mean of the four that it
/// covers, of one instant. No delay is modelled; a real device that stores fields adds its own.
class QuadSource : public PictureSource {
 public:
  /// @param cameras of one size, its width a multiple of 4, its height of 2
  explicit QuadSource(const std::array<PictureSource*, 4>& cameras);
  unsigned width() const override { return out_.width; }
  unsigned height() const override { return out_.height; }
  const Picture& field(std::uint64_t k) override;

 private:
  std::array<PictureSource*, 4> cameras_;
  Picture out_;
};

}  // namespace fovea::video
