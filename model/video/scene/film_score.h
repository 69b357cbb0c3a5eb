// How well a displayed picture shows a flat film that the camera's lens has bent: compared with the film itself.
#pragma once
#include "model/video/scene/line_chart.h"
#include "model/video/scene/picture_quality.h"

namespace fovea::video {

/// What a pin-hole camera sees of a flat frame.
struct FlatView {
  Picture picture;
  PictureMask seen;  ///< where there is film; elsewhere it is black
};

/// The film stands at right angles to the optical axis with its middle on it, and has square pixels; `fov_deg` is its
/// horizontal angle. Sampled between its pixels as the camera's own picture of it is.
FlatView flat_film_view(const RgbImage& frame, double fov_deg, const PinholeView& view);

/// Knows the film and the view that is meant to be displayed, and nothing of lenses.
class FilmScore {
 public:
  FilmScore(double fov_deg, const PinholeView& view) : fov_deg_(fov_deg), view_(view) {}

  struct Result {
    double psnr_y = 0;  ///< dB, where there is film; infinite if all samples are equal, not a number without film
    double ssim_y = 0;  ///< of the windows that are full of film; not a number without any
  };
  /// @throws UserError if the picture is not of the size of the view
  Result operator()(const Picture& shown, const RgbImage& frame) const;

 private:
  double fov_deg_;
  PinholeView view_;
};

}  // namespace fovea::video
