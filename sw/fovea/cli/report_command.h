// The page that `fovea run --report` adds to its results.
#pragma once
#include <string>

#include "sw/fovea/results/run_dir.h"

namespace fovea::app {

/// Adds report.html to the folder of a run whose other files are written. `name` is what the run is
/// called. @throws UserError
void write_report(RunDir& dir, const std::string& name);

}  // namespace fovea::app
