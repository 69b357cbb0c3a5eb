// What each displayed frame's latency consists of.
#pragma once
#include <map>
#include <span>
#include <string>

#include "model/cpu/core/clock_profile.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::app {

/// frame_parts.csv: `frame,part,time_ns`, the time from a frame's first captured sample to its first
/// displayed one. Parts: `capture` up to its last sample, `wait_for_core` up to the start of the remap,
/// `remap.CAUSE` for the core's clocks until it ends, `wait_for_display`. The parts of a frame add up
/// exactly. A frame whose way is not known in full is left out, and so are parts without time.
/// @param snapshots the core's counters at the beginnings and ends of remaps, by their times
std::string frame_parts_csv(std::span<const video::FrameTimes> frames,
                            const std::map<Picoseconds, cpu::ClockProfile::Snapshot>& snapshots);

}  // namespace fovea::app
