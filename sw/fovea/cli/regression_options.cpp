// The options of compare, check, bless and trend.
#include <CLI/CLI.hpp>

#include "sw/fovea/cli/regression_command.h"
#include "sw/fovea/regression/first_baseline.h"

namespace fovea::app {
namespace {

constexpr const char* kAcross = "Also take results of different simulators, and list what differs";

void add_compare(CLI::App& app, RegressionOptions::Compare& c) {
  CLI::App* compare = app.add_subcommand("compare", "Show which figures of two runs differ, and why");
  compare->add_option("a", c.a, "Folder of results")->required()->type_name("DIR");
  compare->add_option("b", c.b, "Folder of results to compare with it")->required()->type_name("DIR");
  compare->add_option("--tolerance", c.tolerance, "Difference that counts as equal: 1%, 2, or '1% or 2'")
      ->type_name("TEXT")
      ->default_str("0");
  compare->add_option("--only", c.only, "Only figures with this part in their names, or a pattern with * and ?")
      ->type_name("TEXT");
  compare->add_flag("--all", c.all, "List all differences");
  compare->add_flag("--csv", c.csv, "Print the figures that differ as CSV");
  compare->add_flag("--json", c.json, "Print everything as JSON");
  compare->add_flag("--across-versions", c.across_versions, kAcross);
  compare->footer(
      "Exit status: 0 equal within the tolerance; 1 different; 2 wrong input. With profiles in both "
      "folders (fovea run --profile) the clocks are compared by function and line, otherwise by "
      "cause, region and culprit.");
}

void add_check(CLI::App& app, RegressionOptions::Check& k) {
  CLI::App* check = app.add_subcommand(
      "check", "Compare a result with a baseline, or a program with an earlier one, and blame what is worse");
  check
      ->add_option("what", k.what,
                   "Folder of results; or an experiment and two programs, of which the second is held "
                   "against the first")
      ->required()
      ->expected(1, 3)
      ->type_name("DIR | EXPERIMENT A B");
  check->add_option("--against", k.against, "Baseline (YAML) for a folder; 'fovea bless' makes one")->type_name("FILE");
  check->add_option("-s,--set", k.sets, "With two programs: set a parameter of both runs; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  check->add_option("-o,--out", k.out, "With two programs: keep their results as a/ and b/ in this folder")
      ->type_name("DIR");
  check->add_option("--tolerance", k.tolerance, "With two programs: what times and amounts may vary by")
      ->type_name("TEXT")
      ->default_str(std::string(regression::kFirstTolerance));
  check
      ->add_option("--markdown", k.markdown,
                   "Also write five lines for a merge request: figure, before, after, who, why; - prints them instead "
                   "of the report")
      ->type_name("FILE");
  check->add_option("--junit", k.junit, "Also write the result as JUnit XML")->type_name("FILE");
  check->add_flag("--all", k.all, "Also list figures that pass");
  check->add_flag("--across-versions", k.across_versions, kAcross);
  check->footer(
      "Exit status: 0 passed; 1 a figure is missing or worse than its tolerance allows; 2 wrong "
      "input. A figure of a baseline has: value; unit; tolerance (1%, 2, '1% or 2'; none: the same "
      "number); worse (higher, lower, both): the direction that fails; kind: exact (from a run, "
      "replaced by bless), analytic (calculated) or budget (a limit); reason.");
}

void add_bless(CLI::App& app, RegressionOptions::Bless& b) {
  CLI::App* bless = app.add_subcommand("bless", "Put the figures of a run into a baseline, or begin one");
  bless->add_option("dir", b.folder, "Folder of results")->required()->type_name("DIR");
  bless->add_option("--against", b.against, "Baseline (YAML), required; a name that is not there makes a new one")
      ->required()
      ->type_name("FILE");
  bless->add_option("--why", b.why, "Reason, required; kept in the baseline")->required()->type_name("TEXT");
  bless->add_option("--tolerance", b.tolerance, "Of a new baseline: what its times and amounts may vary by; 0: nothing")
      ->type_name("TEXT")
      ->default_str(std::string(regression::kFirstTolerance));
  bless
      ->add_option("--layout", b.layouts,
                   "Of a new baseline: results of the program linked in another order or at other addresses; may be "
                   "repeated. Tolerances are then twice the largest deviation")
      ->type_name("DIR")
      ->allow_extra_args(false);
  bless->footer(
      "Prints the change as a diff. Comments and order stay; analytic values and budgets are "
      "never replaced (exit status 1 if one of them fails). The reference for blame, in the "
      "folder that the baseline names, becomes this run's.");
}

void add_trend(CLI::App& app, RegressionOptions::Trend& t) {
  CLI::App* trend = app.add_subcommand("trend", "Keep the figures of each commit, and plot them");
  trend->add_option("dir", t.folders, "Folders of results to add")->type_name("DIR");
  trend->add_option("--database", t.database, "SQLite file, required; made if it is not there")
      ->required()
      ->type_name("FILE");
  trend->add_option("--commit", t.commit, "Name of the line")
      ->type_name("TEXT")
      ->default_str("that of the git repository of the current folder");
  trend->add_flag("--replace", t.replace, "Also replace a line of this commit that is of another program");
  trend->add_option("--tolerance", t.tolerance, "A larger change from one commit to the next is a jump, and is blamed")
      ->type_name("TEXT")
      ->default_str("1%");
  trend
      ->add_option("--host-instructions", t.host_instructions,
                   "The simulator's host instructions for each guest instruction, instead of the run's own figure; "
                   "scripts/host-instructions counts them where the host cannot")
      ->type_name("NUMBER")
      ->check(CLI::PositiveNumber);
  trend->add_option("--plot", t.plot, "Write a picture of the figures over the commits (SVG)")->type_name("FILE");
  trend->add_option("--figure", t.figures, "Figure to plot; may be repeated")
      ->type_name("NAME")
      ->allow_extra_args(false)
      ->default_str("headlines");
  trend->add_option("--experiment", t.experiment, "Plot only this experiment")->type_name("NAME");
}

}  // namespace

void add_regression_commands(CLI::App& app, RegressionOptions& options) {
  add_compare(app, options.compare);
  add_check(app, options.check);
  add_bless(app, options.bless);
  add_trend(app, options.trend);
}

}  // namespace fovea::app
