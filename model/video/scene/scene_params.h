// The camera's keys, and the picture source they describe.
#pragma once
#include <memory>
#include <vector>

#include "model/common/param.h"
#include "model/video/scene/sources.h"

namespace fovea::video {

/// What the camera looks at and through which lens. The firmware's own lens description is
/// separate: it may be wrong about this lens, as on a real board.
struct SceneParams : ParamGroup {
  SceneParams();

  TextParam file;
  EnumParam kind;
  IntParam motion_period;
  RealParam motion_amplitude;
  BoolParam stamp;
  EnumParam lens;
  RealParam fov;
  ListParam kb;
  RealParam kb_width, kb_height;
  RealParam video_fov;
  TextParam calibration;

  /// The lens of a still or flat video of this size, in its own pixels. @throws UserError
  LensModel lens_model(unsigned width, unsigned height) const;
  /// Warns of a calibration that cannot belong to a still of this size: one of a picture of another
  /// shape or, if the calibration's size is not known, with its centre outside the middle third.
  void check_calibration(unsigned width, unsigned height) const;
};

/// Makes the source for a raster of width x height. `frames`: what camera.file decodes to, one
/// still for `sphere`, at least one frame for `video`, unused for `chart`.
/// @throws UserError naming key and what is allowed
std::unique_ptr<StampedSource> make_picture_source(const SceneParams& params,
                                                   std::vector<RgbImage> frames, unsigned width,
                                                   unsigned height);

}  // namespace fovea::video
