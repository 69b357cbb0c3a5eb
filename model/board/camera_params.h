// The cameras of the board: how many, what each one is, and on which input of the decoder.
#pragma once
#include <array>
#include <memory>

#include "model/board/lens_params.h"
#include "model/contract/param_page.h"
#include "model/video/camera_signal.h"
#include "model/video/params.h"
#include "model/video/scene/scene_params.h"

namespace fovea::board {

inline constexpr unsigned kCamerasMax = PARAM_CAMERAS_MAX;

struct CamerasParams : ParamGroup {
  IntParam count{*this, "count", IntParam::Unit::kCount, 1, 1, kCamerasMax,
                 "cameras on the decoder's inputs; with several, the firmware captures a frame of each "
                 "in turn and corrects it by the camera's own table",
                 Origin::kChoice, ""};
  BoolParam genlocked{*this, "genlocked", true,
                      "the syncs of all cameras are those of tvp5146.phase; false: each camera runs "
                      "by its own clock from its own phase",
                      Origin::kChoice, ""};
  BoolParam quad{*this, "quad", false,
                 "a quad processor joins the signals of four genlocked cameras to one, that of camera 0: "
                 "each at half width and half height",
                 Origin::kChoice, ""};
  EnumParam multiplexer{*this, "multiplexer", "decoder", {"decoder", "gpio"},
                        "what changes between several cameras: the decoder, on whose inputs they are; or an analogue "
                        "multiplexer in front of it, whose select lines are GPIO pins 40 to 42 and whose output is on "
                        "the input of camera 0",
                        Origin::kChoice, ""};
  CamerasParams() : ParamGroup("cameras") {
    genlocked.matters_only("cameras.count of 2 or more", {&count}, [this] { return count() > 1; });
  }
};

/// What a camera's row says of its signal. What it does not set is that of all cameras.
struct CameraWireParams : ParamGroup {
  /// @param input default, a word of the list of inputs
  CameraWireParams(std::string prefix, std::string input);
  EnumParam input;
  BoolParam connected;
  EnumParam standard;
  BoolParam genlocked;
  IntParam phase;
  RealParam clock_offset;
};

/// The keys of one camera: camera.N.*, camera.N.lens.*. A key that is not set has the value of
/// camera.*, lens.*, cameras.genlocked, tvp5146.standard or tvp5146.phase.
struct CameraRow {
  /// Declares the row's keys, which matter if `count` says that there is such a camera.
  CameraRow(ParamTree& tree, const IntParam& count, unsigned number);
  CameraWireParams wire;
  video::SceneParams scene;
  LensParams lens;
};

/// Everything that is set of a camera. The keys in messages are those of its row if it has one.
struct CameraSetup {
  std::unique_ptr<video::SceneParams> scene;
  std::unique_ptr<LensParams> lens;
  video::CameraWiring wiring;  ///< without its source
  bool genlocked = true;
};

/// The code of register 00 (TI SLES084C, composite inputs) for a word of camera.N.input.
std::uint8_t decoder_input(const EnumParam& input);

}  // namespace fovea::board
