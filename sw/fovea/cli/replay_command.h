// `fovea replay`: a bus trace played on crossbar and SDRAM.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/machine/command.h"

namespace fovea::app {

struct ReplayOptions {
  std::string trace;
  std::vector<std::string> sets;
  std::string out_dir;
  bool out_given = false;
  bool memory_only = false;
  std::string command_trace;  ///< file; empty: none
  std::string around;         ///< a time, for requests.csv; empty: none
  bool wrap = false;  ///< addresses beyond ddr.part are taken modulo its size
  std::vector<std::string> without;  ///< labels of masters whose requests are left out
};

int command_replay(const ReplayOptions& options, const std::vector<std::string>& args,
                   const CliContext& context);

}  // namespace fovea::app
