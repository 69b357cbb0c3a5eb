// The firmware's description of a camera's lens and of the corrected view.
#pragma once
#include <initializer_list>
#include <string>

#include "model/common/param.h"
#include "model/contract/words.h"

namespace fovea::board {

/// The lens description that the loader puts into the parameter page (model/contract).
struct LensParams : ParamGroup {
  EnumParam mapping{*this, "mapping", "equisolid",
                    contract::words(contract::kMappings),
                    "mapping function the firmware corrects; kannala_brandt goes in as a table "
                    "(DIP switches)",
                    Origin::kChoice, ""};
  RealParam fov{*this, "fov", "deg", 180, 10, 359, "full horizontal field of view",
                Origin::kChoice, ""};
  RealParam focal{*this, "focal", "px", 0, 0, 10'000, "lens focal length; 0: from the field of view",
                  Origin::kChoice, ""};
  RealParam out_focal{*this, "out_focal", "px", 0, 0, 10'000,
                      "focal length of the corrected view; 0: that of the lens", Origin::kChoice,
                      ""};
  RealParam centre_x{*this, "centre_x", "px", 0, -720, 720,
                     "optical centre right of the picture's centre", Origin::kChoice, ""};
  RealParam centre_y{*this, "centre_y", "px", 0, -576, 576,
                     "optical centre below the picture's centre", Origin::kChoice, ""};
  RealParam shift_x{*this, "shift_x", "px", 0, -720, 720, "shift of the corrected view",
                    Origin::kChoice, ""};
  RealParam shift_y{*this, "shift_y", "px", 0, -576, 576, "shift of the corrected view",
                    Origin::kChoice, ""};
  ListParam roi{*this, "roi", {0, 0, 0, 0}, {4},
                "region of interest: left, top, width, height in pixels of the corrected picture; it is enlarged "
                "to the display, grown about its centre to the display's shape; all 0: the whole picture",
                Origin::kChoice, ""};
  RealParam in_aspect{*this, "in_aspect", "", 1, 0.1, 10, "y scale / x scale of the lens image",
                      Origin::kChoice, ""};
  RealParam out_aspect{*this, "out_aspect", "", 1, 0.1, 10,
                       "y scale / x scale of the corrected view", Origin::kChoice, ""};
  ListParam kb{*this, "kb", {302.453, 320.746, 496.640, 331.200, -0.0437356, 0.0216925,
                             -0.0263888, 0.0084123}, {8},
               "kannala_brandt: fx, fy, cx, cy in pixels of lens.kb_width x lens.kb_height, k1..k4",
               Origin::kSourced, "front camera of traces/footage/neozhaoliang-surround"};
  RealParam kb_width{*this, "kb_width", "px", 960, 16, 8192, "picture width of the calibration",
                     Origin::kChoice, ""};
  RealParam kb_height{*this, "kb_height", "px", 640, 16, 8192, "picture height of the calibration",
                      Origin::kChoice, ""};
  TextParam calibration{*this, "calibration", "",
                        "OpenCV fisheye calibration (YAML) of the lens that the firmware corrects; "
                        "empty: that of camera.calibration, or else lens.kb"};
  RealParam theta_max{*this, "theta_max", "deg", 95, 1, 120,
                      "kannala_brandt: largest angle of the table; beyond it the view is black",
                      Origin::kChoice, ""};
  BoolParam paper_literal_focal{*this, "paper_literal_focal", false,
                                "equation (10) as the paper prints it", Origin::kChoice,
                                ""};
  EnumParam pair{*this, "pair", "A", contract::words(contract::kPairMethods),
                 "pair method: first pixel's source word (the paper), or the pair's centre",
                 Origin::kChoice, ""};
  /// @param rules say which keys matter when; a row of one camera has none
  explicit LensParams(std::string prefix = "lens", bool rules = true) : ParamGroup(std::move(prefix)) {
    if (!rules) return;
    const auto any = [this] { return !mapping.is("none"); };
    const auto closed = [this] { return !mapping.is("none") && !mapping.is("kannala_brandt"); };
    const auto table = [this] { return mapping.is("kannala_brandt"); };
    for (ParamBase* p : std::initializer_list<ParamBase*>{&out_focal, &centre_x, &centre_y, &out_aspect, &roi})
      p->matters_only("a lens.mapping other than none", {&mapping}, any);
    const char* const kClosed = "a lens.mapping other than none and kannala_brandt";
    focal.matters_only(kClosed, {&mapping}, closed);
    in_aspect.matters_only(kClosed, {&mapping}, closed);
    fov.matters_only(kClosed, {&mapping}, closed);
    fov.matters_only("lens.focal = 0px", {&focal}, [this] { return focal() == 0; });
    // A view of the lens's own focal length is what a rectilinear lens shows anyway.
    for (ParamBase* p : {&fov, &focal})
      p->matters_only("a lens.out_focal above 0px", {&mapping, &out_focal}, [this] {
        return !mapping.is("rectilinear") || out_focal() > 0;
      });
    for (ParamBase* p : std::initializer_list<ParamBase*>{&kb, &kb_width, &kb_height, &theta_max,
                                                          &calibration})
      p->matters_only("lens.mapping = kannala_brandt", {&mapping}, table);
    paper_literal_focal.matters_only("lens.mapping = equisolid", {&mapping},
                                     [this] { return mapping.is("equisolid"); });
    paper_literal_focal.matters_only("lens.focal = 0px", {&focal}, [this] { return focal() == 0; });
  }
};

}  // namespace fovea::board
