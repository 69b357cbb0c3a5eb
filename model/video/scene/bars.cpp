#include "model/video/scene/bars.h"

namespace fovea::video {

const std::array<YCbCr, BarsSource::kBars> BarsSource::kColours{{{235, 128, 128},
                                                                 {162, 44, 142},
                                                                 {131, 156, 44},
                                                                 {112, 72, 58},
                                                                 {84, 184, 198},
                                                                 {65, 100, 212},
                                                                 {35, 212, 114},
                                                                 {16, 128, 128}}};

BarsSource::BarsSource(const Raster& raster)
    : StampedSource(raster, {(raster.width - 1) / 2.0, (raster.height - 1) / 2.0}),
      picture_(raster.width, raster.height) {
  for (unsigned y = 0; y < raster.height; ++y)
    for (unsigned x = 0; x < raster.width; x += 2) {
      const YCbCr& c = kColours[x * kBars / raster.width];
      std::uint8_t* const pair = picture_.row(y) + 2 * x;
      pair[0] = c.cb;
      pair[1] = pair[3] = c.y;
      pair[2] = c.cr;
    }
}

}  // namespace fovea::video
