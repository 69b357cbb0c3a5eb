// `fovea compare`: which figures of two runs differ, and why.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <ostream>

#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/cli/shared_options.h"
#include "sw/fovea/compare/compare.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

using namespace regression;

struct CompareOptions {
  std::string a, b, tolerance = "0", only;
  bool csv = false, json = false, all = false, across_versions = false;
};

CLI::App* add_options(CLI::App& app, CompareOptions& c) {
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
  compare->add_flag("--across-versions", c.across_versions, kAcrossVersions);
  compare->footer(
      "Exit status: 0 equal within the tolerance; 1 different; 2 wrong input. With profiles in both "
      "folders (fovea run --profile) the clocks are compared by function and line, otherwise by "
      "cause, region and culprit.");
  return compare;
}

int compare(const CompareOptions& o, const CliContext& context) {
  if (o.csv && o.json) throw UserError("--csv and --json exclude each other; choose one");
  const Tolerance tolerance = parse_tolerance(o.tolerance, "--tolerance");
  const RunFigures a = read_run(o.a), b = read_run(o.b);
  if (!o.across_versions) refuse_other_simulator(a, b);
  const Comparison c = compare_runs(a, b, tolerance, o.only);
  if (c.compared == 0)
    throw UserError(fmt::format("no figure matches --only '{}'; stats.json lists all", one_line(o.only)));
  context.out << (o.csv    ? comparison_csv(c)
                  : o.json ? comparison_json(c)
                           : comparison_text(c, tolerance, o.all))
              << std::flush;
  return c.changes.empty() ? kExitDone : kExitCheckFailed;
}

}  // namespace

Command add_compare(CLI::App& app) {
  const auto o = std::make_shared<CompareOptions>();
  CLI::App* const c = add_options(app, *o);
  return {c, [o](const Call& call) { return compare(*o, call.context); }};
}

}  // namespace fovea::app
