// The command line of `fovea`.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/machine/command.h"

namespace fovea::app {

/// Runs one command and reports every error. `args` does not contain the program's name. @return
/// the exit status
int run_cli(const std::vector<std::string>& args, const CliContext& context);

/// Installs signal handlers: SIGINT and SIGTERM set the flags (a second one ends the program at
/// once); SIGPIPE and SIGXFSZ are ignored, so that they become write errors.
void install_signals(CliContext& context);

}  // namespace fovea::app
