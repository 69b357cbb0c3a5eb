// Pictures of scenes that are a formula: each pixel is the mean of points of its area.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "model/video/scene/colour.h"

namespace fovea::video {

struct SceneColour {
  double r = 0, g = 0, b = 0;  ///< 0 to 255
};

/// The mean of side * side points of a pixel; `colour` takes a position relative to the pixel's centre, in pixels.
template <class Colour>
SceneColour mean_colour(unsigned side, Colour&& colour) {
  SceneColour sum;
  for (unsigned j = 0; j < side; ++j)
    for (unsigned i = 0; i < side; ++i) {
      const SceneColour c = colour((i + 0.5) / side - 0.5, (j + 0.5) / side - 0.5);
      sum.r += c.r;
      sum.g += c.g;
      sum.b += c.b;
    }
  const double n = side * side;
  return {sum.r / n, sum.g / n, sum.b / n};
}

/// A picture of such means; `colour` takes a position in pixels.
template <class Colour>
Picture mean_picture(unsigned width, unsigned height, unsigned side, Colour&& colour) {
  RgbImage image{width, height, {}};
  image.rgb.reserve(std::size_t{width} * height * 3);
  for (unsigned v = 0; v < height; ++v)
    for (unsigned u = 0; u < width; ++u) {
      const SceneColour c = mean_colour(side, [&](double du, double dv) { return colour(u + du, v + dv); });
      for (const double level : {c.r, c.g, c.b})
        image.rgb.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L)));
    }
  return to_picture(image);
}

}  // namespace fovea::video
