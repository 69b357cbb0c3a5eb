// SDRAM timing by preset: `ddr.preset = data_sheet` gives what the sheet of `ddr.part` asks for.
#pragma once
#include "model/common/units.h"
#include "sw/fovea/experiment.h"
#include "sw/fovea/replay_params.h"

namespace fovea::app {

/// Sets clock, CL, RL, timings, banks and page of the part, but no key that came from the command
/// line. Nothing happens with `as_recorded`. `recorded` is the trace's SDRAM clock: exact, where the
/// key is in whole hertz; it may be stopped. `params` are those of `experiment`.
/// @throws UserError for a grade or a clock that the part does not come in
void apply_ddr_preset(const ReplayParams& params, Frequency recorded, Experiment& experiment);

}  // namespace fovea::app
