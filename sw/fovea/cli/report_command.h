// `fovea report`: a page of HTML, or plain sentences, about the results of runs.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/machine/command.h"
#include "sw/fovea/results/run_dir.h"

namespace CLI {
class App;
}

namespace fovea::app {

struct ReportOptions {
  std::vector<std::string> folders;
  std::string out, limits;
  bool text = false, partial = false, across_versions = false;
};

void add_report_command(CLI::App& app, ReportOptions& options);
/// @throws UserError
int command_report(const ReportOptions& options, const CliContext& context);

/// Adds report.html to the folder of a run whose other files are written. `name` is what the run is
/// called. @throws UserError
void add_report(RunDir& dir, const std::string& name);

}  // namespace fovea::app
