// SDRAM timings by preset: `ddr.preset = data_sheet` uses the figures of the data sheet of
// `ddr.part`. A trace in which nothing was programmed has them whenever part, grade or clock is set.
#pragma once
#include <string>
#include <vector>

#include "model/common/units.h"
#include "sw/fovea/config/experiment.h"
#include "sw/fovea/replay/replay_params.h"

namespace fovea::app {

/// For a trace without recorded settings, in which no firmware has programmed timings: if part, grade or clock are set
/// and no preset, the timings of the data sheet are chosen. @return what is to be said about it
std::vector<std::string> choose_ddr_preset(const ReplayParams& params, bool recorded, Experiment& experiment);

/// Sets clock, CL, RL, timings, banks and page size of the part, except keys that were set on the
/// command line. Does nothing with `as_recorded`. `recorded` is the exact SDRAM clock of the trace
/// (the key is in whole hertz); it may be stopped. `params` must be those of `experiment`. @throws
/// UserError for a speed grade or clock that the part does not have
void apply_ddr_preset(const ReplayParams& params, Frequency recorded, Experiment& experiment);

}  // namespace fovea::app
