// What every run of the rig must fulfil: the look-up table and all displayed frames are exact.
#pragma once
#include <cstdint>

#include "tb/e2e/rig.h"

namespace fovea::e2e {

/// Every entry of the table in target memory is the oracle's; one that lies within 0.02 px of a
/// boundary, where two roundings may both be right, may be its neighbour (one in 1,000 at most).
void expect_lut_right(Rig& rig);

/// Every displayed frame is the host's remap of a frame that the camera sent, byte for byte. A result
/// that is new on the display is that of the camera's frame `step` after the one before; with
/// step 0, of that one or a later one.
void expect_frames_right(Rig& rig, std::uint64_t step = 1);

}  // namespace fovea::e2e
