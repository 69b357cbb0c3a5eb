// The commands compare, check, bless and trend.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/machine/command.h"

namespace CLI {
class App;
}

namespace fovea::app {

struct RegressionOptions {
  struct Compare {
    std::string a, b, tolerance = "0", only;
    bool csv = false, json = false, all = false, across_versions = false;
  } compare;
  struct Check {
    std::vector<std::string> what, sets;  ///< a folder, or an experiment and two programs
    std::string against, junit, markdown, out, tolerance;
    bool all = false, across_versions = false;
  } check;
  struct Bless {
    std::string folder, against, why, tolerance;
    std::vector<std::string> layouts;
  } bless;
  struct Trend {
    std::vector<std::string> folders, figures;
    std::string database, commit, plot, experiment, tolerance = "1%";
    bool replace = false;
    double host_instructions = 0;
  } trend;
};

void add_regression_commands(CLI::App& app, RegressionOptions& options);
/// True if `name` is one of these commands.
bool is_regression_command(const std::string& name);
/// `fovea bless`. @throws UserError
int command_bless(const RegressionOptions::Bless& options, const CliContext& context);
/// `fovea trend`. @throws UserError
int command_trend(const RegressionOptions::Trend& options, const CliContext& context);
/// Runs it. @return 0, or 1 if a comparison failed. @throws UserError
int command_regression(const std::string& name, const RegressionOptions& options,
                       const CliContext& context);

}  // namespace fovea::app
