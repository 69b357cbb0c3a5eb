// Views that are composed of four cameras: where the cameras are on the car, and what part of the ground is shown.
#pragma once
#include <array>
#include <string>

#include "model/common/param.h"
#include "model/contract/view_page.h"
#include "model/contract/words.h"
#include "model/video/scene/mount.h"

namespace fovea::board {

/// The words of firmware.view.
#define FOVEA_VIEW(constant, code, word) contract::Word{word, code},
inline constexpr std::array kViews = {PARAM_VIEWS(FOVEA_VIEW)};
#undef FOVEA_VIEW

struct BirdsEyeParams : ParamGroup {
  RealParam width{*this, "width", "m", 16, 1, 200, "width of the ground that is shown, across the car",
                  Origin::kChoice, ""};
  RealParam height{*this, "height", "m", 12, 1, 200, "length of the ground that is shown, along the car",
                   Origin::kChoice, ""};
  RealParam car_length{*this, "car_length", "m", 4.8, 0, 30,
                       "of the rectangle in the middle that no camera shows; the seams begin at its corners",
                       Origin::kChoice, ""};
  RealParam car_width{*this, "car_width", "m", 2, 0, 30, "of that rectangle", Origin::kChoice, ""};
  BirdsEyeParams() : ParamGroup("birds_eye") {}
};

/// camera.N.mount.*: truth of a synthetic scene, and what the firmware's bird's-eye view is made for.
struct MountParams : ParamGroup {
  explicit MountParams(unsigned camera) : MountParams(camera, default_of(camera)) {}
  RealParam x, y, height, yaw, pitch, roll;
  video::Mount mount() const { return {x(), y(), height(), yaw(), pitch(), roll()}; }

 private:
  /// Front, right, rear and left of a car of the default size.
  static video::Mount default_of(unsigned camera) {
    constexpr std::array<video::Mount, VIEW_CAMERAS> kSides{{{2.3, 0, 0.7, 0, 40, 0},
                                                             {0.5, -1, 1, -90, 55, 0},
                                                             {-2.3, 0, 0.9, 180, 45, 0},
                                                             {0.5, 1, 1, 90, 55, 0}}};
    return kSides.at(camera);
  }
  MountParams(unsigned camera, const video::Mount& m)
      : ParamGroup("camera." + std::to_string(camera) + ".mount"),
        x(*this, "x", "m", m.x, -20, 20, "of the camera ahead of the middle of the car", Origin::kChoice, ""),
        y(*this, "y", "m", m.y, -20, 20, "of the camera to the left of the middle of the car", Origin::kChoice, ""),
        height(*this, "height", "m", m.height, 0.1, 20, "above the ground", Origin::kChoice, ""),
        yaw(*this, "yaw", "deg", m.yaw, -180, 180, "of its axis: 0 forward, 90 to the left", Origin::kChoice, ""),
        pitch(*this, "pitch", "deg", m.pitch, -90, 90, "of its axis below the horizon", Origin::kChoice, ""),
        roll(*this, "roll", "deg", m.roll, -180, 180, "clockwise, seen from behind the camera", Origin::kChoice,
             "") {}
};

}  // namespace fovea::board
