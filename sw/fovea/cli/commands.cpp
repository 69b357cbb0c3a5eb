#include "sw/fovea/cli/command_row.h"

namespace fovea::app {

/// The commands, in the order of the help: for each NAME, `Command add_NAME(CLI::App&)` in a source of its own.
#define FOVEA_COMMANDS(X) \
  X(run)                  \
  X(replay)               \
  X(limits)               \
  X(exec)                 \
  X(trace)                \
  X(report)               \
  X(compare)              \
  X(check)                \
  X(bless)                \
  X(trend)                \
  X(params)               \
  X(version)              \
  X(completion)           \
  X(man)

#define FOVEA_DECLARE(name) Command add_##name(CLI::App& app);
FOVEA_COMMANDS(FOVEA_DECLARE)

std::vector<Command> add_commands(CLI::App& app) {
#define FOVEA_ADD(name) add_##name(app),
  return {FOVEA_COMMANDS(FOVEA_ADD)};
}

}  // namespace fovea::app
