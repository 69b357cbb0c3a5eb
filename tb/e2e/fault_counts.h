// What is displayed of a camera with a fault, and the counts of its frames, against the oracle of its signal.
#pragma once
#include "tb/e2e/cameras_rig.h"

namespace fovea::e2e {

/// One camera of 625/50 with the fault of the run's keys: each displayed frame has the number that the oracle says,
/// by its stamp, and every count of frames and of timing codes is the oracle's.
void expect_exact_counts(CamerasRig& rig);

}  // namespace fovea::e2e
