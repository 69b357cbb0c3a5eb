// Options of `fovea run --perfetto`.
#pragma once
#include <string>

#include "sw/fovea/machine/perfetto_request.h"

namespace CLI {
class App;
}

namespace fovea::app {

/// What was given.
struct PerfettoOptions {
  PerfettoRequest request;
  std::string file, duration;
};
void add_perfetto_options(CLI::App& command, PerfettoOptions& options);
/// @throws UserError that names the option
PerfettoRequest perfetto_of(const PerfettoOptions& options);

}  // namespace fovea::app
