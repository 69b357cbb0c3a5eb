// The clocks of a replay: both come from one PLL of the chip.
#pragma once
#include <string>
#include <vector>

#include "model/trace/core/trace.h"
#include "sw/fovea/config/experiment.h"
#include "sw/fovea/replay/replay_params.h"

namespace fovea::app {

/// Sets `ddr.clock` as `clocks.preset` says, unless it came from the command line.
void apply_clock_preset(const ReplayParams& params, Experiment& experiment);

/// After apply_clock_preset() and apply_ddr_preset(): the crossbar's clock follows a changed SDRAM
/// clock, as half of it, unless `bus.clock` came from the command line.
/// @return what the user should know, a line each
std::vector<std::string> follow_clocks(const ReplayParams& params, const trace::TraceInfo& recorded,
                                       Experiment& experiment);

}  // namespace fovea::app
