// How well a bird's-eye view shows the car park: compared with the plan itself.
#pragma once
#include "model/video/scene/car_park.h"
#include "model/video/scene/picture_quality.h"

namespace fovea::video {

class PlanScore {
 public:
  /// @param car_length, car_width metres: this rectangle in the middle is not compared
  PlanScore(const GroundPicture& ground, double car_length, double car_width);

  struct Result {
    double psnr_y = 0;      ///< dB; infinite if all compared luma samples are equal
    double ssim_y = 0;      ///< of the windows that the car does not touch
    double line_error = 0;  ///< px, root mean square: how far the bays' lines lie from where they are in the plan
    unsigned lines = 0;     ///< places at which a line was found in both; 0: no line_error
    unsigned missed = 0;    ///< places at which the plan has a line and the picture shows none
  };
  /// @throws UserError if the picture is not of the size of the ground's
  Result operator()(const Picture& shown) const;

 private:
  bool in_car(double x, double y) const;

  GroundPicture ground_;
  double car_length_, car_width_;
  Picture plan_;
  PictureMask mask_;  ///< without the car
};

}  // namespace fovea::video
