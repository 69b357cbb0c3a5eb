// What a command says at its end, for a person: at most a screen of 24 lines with 80 columns.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "model/common/units.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/tools/slowest.h"

namespace fovea::app {

/// `fovea run`: the verdict, the frame's budget, the largest waits, the SDRAM and the host. What has no
/// figure is left out. Ends with a line end, as the others do.
std::string run_words(std::span<const StatRow> stats, std::span<const StatRow> host,
                      std::span<const SlowestRow> slowest = {});
/// `fovea replay`.
std::string replay_words(std::span<const StatRow> stats, std::span<const StatRow> host,
                         std::span<const SlowestRow> slowest = {});
/// `fovea exec`: the core alone. @param core_clock stopped: unknown
std::string exec_words(std::span<const StatRow> stats, Frequency core_clock);

/// The parts of `total` in proportion to `shares`, rounded so that they add up to `total` (largest
/// remainder; among equals the first). All 0 if the shares are.
std::vector<std::uint64_t> apportioned(std::uint64_t total, std::span<const std::uint64_t> shares);
/// What the core did in a frame's period, in tenths of a millisecond that add up to the period, and the
/// parts of the remap, which add up to the remap; empty without a remap.
std::string frame_budget(std::span<const StatRow> stats);

}  // namespace fovea::app
