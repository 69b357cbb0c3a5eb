// `fovea limits`: how far an experiment can be stretched, and what binds.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/machine/command.h"

namespace CLI {
class App;
}

namespace fovea::limits {

struct LimitsOptions {
  std::string experiment;
  std::vector<std::string> sets;
  std::string out_dir;
  unsigned jobs = 0;  ///< 0: one for each processor
  std::string find, binds;
  std::vector<std::string> over, require, relax, ports, priorities;
  bool load = false, retry_failed = false, larger_is_better = false;
  unsigned probes = 2;
  unsigned load_bytes = 64, load_slots = 4;
  std::string load_kind = "read", load_pattern = "sequential";
  double load_step = 20, load_most = 1400;
};

void add_limits_command(CLI::App& app, LimitsOptions& options);
/// @return the exit status: 0 found, 1 not met at any value, 2 a run had wrong input, 3 the guest failed
/// where a figure was asked for, 4 a run met a defect; 128 + the signal if stopped
int command_limits(const LimitsOptions& options, const app::CliContext& context);

}  // namespace fovea::limits
