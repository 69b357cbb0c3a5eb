// Conditions for every run of the rig: the look-up table and all displayed frames are exact.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "tb/e2e/rig.h"

namespace fovea::e2e {

/// The run has given no warning.
void expect_no_warnings(const Rig& rig);

/// Every entry of each table in target memory must equal the oracle's. An entry within 0.02 px of a
/// boundary, where two roundings may both be right, may be the neighbouring one (at most one in
/// 1,000).
void expect_lut_right(Rig& rig);

/// The view whose table made the displayed picture: remap n of a run (from 0) follows table n modulo
/// `firmware.tables`, and the last one of a captured frame is shown. Which one it was is counted on the
/// pins.
unsigned view_of(Rig& rig, const Shown& shown);

/// The number of the camera's frame whose remap the displayed frame is; none: it is wrong, and
/// `difference` says where it differs from the likeliest one. The frame must have been captured.
std::optional<std::uint64_t> sent_as(Rig& rig, const Shown& shown, std::string* difference = nullptr);

/// Every displayed frame must be the host's remap of a frame that the camera sent, byte for byte. A
/// new result on the display must belong to the camera frame `step` after the previous one; with
/// step 0, to the same or a later one.
void expect_frames_right(Rig& rig, std::uint64_t step = 1);

}  // namespace fovea::e2e
