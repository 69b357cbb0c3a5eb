// The options of the tools, for every command that runs a machine.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "sw/fovea/config/experiment.h"
#include "sw/fovea/results/run_dir.h"
#include "sw/fovea/tools/tool.h"

namespace CLI {
class App;
class Option;
}

namespace fovea::app {

class ToolOptions {
 public:
  /// Adds the options of these rows, which outlive the command.
  void add_to(CLI::App& command, std::span<const ToolRow> rows);
  /// Those of which an option was given. @param provided by the machine @throws UserError
  std::vector<AskedTool> asked(ToolNeeds provided, bool debugger) const;
  /// Sets the keys that some options stand for. @throws UserError
  void set_keys(const ParamSet& params, Experiment& experiment) const;
  /// A file that a tool writes must not lie among the results. @throws UserError
  void refuse_inside(const RunDir& dir) const;

 private:
  struct Added {
    const ToolRow* row;
    const ToolOption* option;
    const CLI::Option* given;
  };
  static bool given(const Added& added);
  static std::string text_of(const Added& added);
  std::vector<Added> added_;
};

}  // namespace fovea::app
