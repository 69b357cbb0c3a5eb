#include "model/video/scene/quad.h"

#include "model/common/check.h"

namespace fovea::video {

QuadSource::QuadSource(const std::array<PictureSource*, 4>& cameras)
    : cameras_(cameras), out_(cameras[0]->width(), cameras[0]->height()) {
  FOVEA_CHECK(out_.width % 4 == 0 && out_.height % 2 == 0, "quarters of whole pairs and rows");
  for (const PictureSource* c : cameras)
    FOVEA_CHECK(c->width() == out_.width && c->height() == out_.height, "a quad processor joins pictures of one size");
}

const Picture& QuadSource::field(std::uint64_t k) {
  for (unsigned n = 0; n < 4; ++n) {
    const Picture& in = cameras_[n]->field(k);
    for (unsigned y = 0; y < out_.height / 2; ++y) {
      const std::uint8_t *a = in.row(2 * y), *b = in.row(2 * y + 1);
      std::uint8_t* to = out_.row(y + n / 2 * (out_.height / 2)) + n % 2 * out_.width;
      // Eight bytes Cb Y Cr Y Cb Y Cr Y of two rows make one pair.
      for (unsigned x = 0; x < out_.width / 4; ++x, a += 8, b += 8, to += 4) {
        const auto chroma = [&](unsigned i) { return (a[i] + a[i + 4] + b[i] + b[i + 4] + 2) / 4; };
        const auto luma = [&](unsigned i) { return (a[i] + a[i + 2] + b[i] + b[i + 2] + 2) / 4; };
        to[0] = static_cast<std::uint8_t>(chroma(0));
        to[1] = static_cast<std::uint8_t>(luma(1));
        to[2] = static_cast<std::uint8_t>(chroma(2));
        to[3] = static_cast<std::uint8_t>(luma(5));
      }
    }
  }
  return out_;
}

}  // namespace fovea::video
