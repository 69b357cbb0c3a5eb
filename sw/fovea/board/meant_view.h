// What a corrected picture is meant to show, and of what lens, by the keys alone: nothing of the firmware's table.
#pragma once
#include <optional>

#include "model/board/board_params.h"
#include "model/video/scene/pixel_remap.h"

namespace fovea::app {

/// What a pin-hole camera in the place of camera `camera` would have to be to see what the display is to show. Without
/// a correction (lens.mapping none) it has the focal length of the camera's own lens if that is one of a scene with a
/// known truth, else 1 px.
video::PinholeView meant_view(const board::BoardParams& params, unsigned camera);

/// The lens that the firmware is told to correct, in pixels of what is captured of the camera; nothing without one.
std::optional<video::TakingLens> told_lens(const board::BoardParams& params, unsigned camera);

}  // namespace fovea::app
