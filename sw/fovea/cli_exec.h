// `fovea exec` on the command line.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/cli.h"
#include "sw/fovea/cli_limits.h"

namespace CLI {
class App;
}

namespace fovea::app {

struct ExecOptions {
  std::string program;
  std::vector<std::string> arguments;  ///< of the program
  std::vector<std::string> sets;
  std::string load, entry, root, out_dir, gdb;
  RegisterLogRequest registers;
  LimitOptions limits;
  bool thumb = false, fast_memory = false, caches = false, strict = false, quiet = false;
  bool board = false, console = false;
};

/// `--log-registers` and its size, of run and exec.
void add_register_log_options(CLI::App& command, RegisterLogRequest& request);
/// @throws UserError: a size without anything that could begin a log
void check_register_log(const RegisterLogRequest& request, const std::string& gdb);

/// Adds the subcommand; its options go to `options`.
CLI::App* add_exec_command(CLI::App& app, ExecOptions& options);

/// Takes the program's own arguments out of a command line that begins with `exec`: whatever follows
/// the program and is no option of this command, and all behind `--`.
std::vector<std::string> take_program_arguments(std::vector<std::string>& args);

int command_exec(const ExecOptions& options, const std::vector<std::string>& args,
                 const CliContext& context);

/// Instructions, clocks, time and where the clocks went, aligned, one per line.
std::string core_table(std::span<const StatRow> stats, Frequency core_clock);

}  // namespace fovea::app
