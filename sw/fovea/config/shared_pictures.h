// Cameras that have no picture of their own take those of the others.
#pragma once
#include <string>

#include "sw/fovea/config/experiment.h"

namespace fovea::app {

/// Of the cameras that show a picture or film, those for which no file is set take in turn the pictures of those that
/// have one in their row: the first of them that of the first, and so on. With a picture come the other keys that the
/// row sets of it and of the lens, calibrations applied, but not how the camera is connected, mounted or clocked. A key
/// that the camera's own row sets stays. To be called when everything else is set, calibrations included.
/// @return a sentence for people that names the cameras; empty: nothing was taken over
std::string share_pictures(const ParamSet& params, Experiment& experiment);

}  // namespace fovea::app
