// Conditions for every run of the rig: the look-up table and all displayed frames are exact.
#pragma once
#include <cstdint>

#include "tb/e2e/rig.h"

namespace fovea::e2e {

/// Every entry of the table in target memory must equal the oracle's. An entry within 0.02 px of a
/// boundary, where two roundings may both be right, may be the neighbouring one (at most one in
/// 1,000).
void expect_lut_right(Rig& rig);

/// Every displayed frame must be the host's remap of a frame that the camera sent, byte for byte. A
/// new result on the display must belong to the camera frame `step` after the previous one; with
/// step 0, to the same or a later one.
void expect_frames_right(Rig& rig, std::uint64_t step = 1);

}  // namespace fovea::e2e
