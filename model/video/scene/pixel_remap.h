// The corrected picture as it would be if each pixel moved by itself: what a remap of pairs is compared with.
#pragma once
#include <limits>
#include <optional>

#include "model/video/scene/lens_model.h"
#include "model/video/scene/line_chart.h"

namespace fovea::video {

/// A lens as a correction is told of it, in pixels of the picture that it corrects.
struct TakingLens {
  LensModel model;    ///< only its radius(theta)
  double focal = 1;   ///< px
  double aspect = 1;  ///< y scale / x scale
  Point centre;
  double theta_max = std::numeric_limits<double>::infinity();  ///< radians; beyond it, it shows nothing
};

/// What `view` shows of a picture that was taken through `lens`, in double precision: each luma sample is that of the
/// nearest pixel, and each pair of chroma samples is that of the pair in which the nearest pixel of its first pixel
/// lies. Black where there is no such pixel. Without a lens, pixel for pixel around the middle, with the view's shift.
Picture remap_pixels(const Picture& taken, const PinholeView& view, const std::optional<TakingLens>& lens);

}  // namespace fovea::video
