// Cameras that have no picture of their own take those of the others.
#pragma once
#include <string>

#include "sw/fovea/config/experiment.h"

namespace fovea::app {

/// A camera that shows a picture or film, but for which no file is set, uses the picture of a camera with a file in its
/// own row: the first camera without a file that of the first with one, and so on, cyclically. The keys of picture and
/// lens that this row sets are copied with it, but not those of connection, mounting and clock. Keys that the camera's
/// own row sets stay. To be called last, after calibrations have been applied.
/// @return a sentence for the user that names the cameras; empty: no picture is shared
std::string share_pictures(const ParamSet& params, Experiment& experiment);

}  // namespace fovea::app
