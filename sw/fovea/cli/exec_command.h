// The command line of `fovea exec`.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/cli/shared_options.h"
#include "sw/fovea/cli/tool_options.h"
#include "sw/fovea/machine/command.h"

namespace CLI {
class App;
}

namespace fovea::app {

struct ExecOptions {
  std::string program;
  std::vector<std::string> arguments;  ///< arguments of the program
  std::vector<std::string> sets;
  std::string load, entry, root, out_dir, gdb;
  ToolOptions tools;
  LimitOptions limits;
  bool thumb = false, fast_memory = false, caches = false, strict = false, quiet = false;
  bool board = false, console = false;
};

/// Adds the subcommand, whose options are stored in `options`.
CLI::App* add_exec_command(CLI::App& app, ExecOptions& options);

/// Removes the program's own arguments from a command line that begins with `exec`, and returns
/// them: all that follow the program and are not options of the subcommand, and all after `--`.
std::vector<std::string> take_program_arguments(const CLI::App& exec,
                                                std::vector<std::string>& args);

}  // namespace fovea::app
