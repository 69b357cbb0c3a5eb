// `fovea run`: options, and the run of one experiment into a folder of results.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/cli/cli_limits.h"
#include "sw/fovea/cli/cli_perfetto.h"
#include "sw/fovea/machine/command.h"

namespace fovea::app {

struct RunOptions {
  std::string experiment;
  std::vector<std::string> sets;
  std::string out_dir;
  bool out_given = false;
  std::string sync = "default";
  bool strict = false, hazards = false, profile = false;
  bool no_frames = false;
  bool mp4 = false;
  std::string bus_trace, command_trace, waves, around;
  std::string gdb;
  RegisterLogRequest registers;
  PerfettoOptions perfetto;
  LimitOptions limits;
  bool console = false;
  bool report = false;
};

/// Runs the experiment and writes its results. `args`: the command line, for host.json.
/// @return the exit status
/// @throws UserError, GuestFailure, NotModelled
int command_run(const RunOptions& options, const std::vector<std::string>& args, const CliContext& context);

}  // namespace fovea::app
