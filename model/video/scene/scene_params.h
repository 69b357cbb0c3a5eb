// The camera's parameters, and the construction of its picture source.
#pragma once
#include <memory>
#include <vector>

#include "model/common/param.h"
#include "model/video/scene/sources.h"

namespace fovea::video {

/// What the camera looks at, and through which lens. The firmware has its own description of the
/// lens, which may be wrong, as on a real board.
struct SceneParams : ParamGroup {
  /// @param rules say which keys matter when; a row of one camera has none, as the keys that it does
  ///        not set are those of all cameras
  explicit SceneParams(std::string prefix = "camera", bool rules = true);

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

  /// Whether `lens` takes part in the picture.
  bool bends() const;
  /// The lens of a still or flat video of this size, in that picture's pixels. @throws UserError
  LensModel lens_model(unsigned width, unsigned height) const;
  /// Warns about a calibration that cannot belong to a still of this size: one made with a picture
  /// of another aspect ratio or, if its size is unknown, one whose centre lies outside the middle
  /// third.
  void check_calibration(unsigned width, unsigned height) const;
};

/// Creates the source for a raster of width x height pixels. `frames` are the decoded frames of
/// camera.file: one still for `sphere`, at least one frame for `video`, none needed for `chart`.
/// `camera` is the number in the marks. @throws UserError that names the key and what is allowed
std::unique_ptr<StampedSource> make_picture_source(const SceneParams& params,
                                                   std::vector<RgbImage> frames, unsigned width,
                                                   unsigned height, unsigned camera = 0);

}  // namespace fovea::video
