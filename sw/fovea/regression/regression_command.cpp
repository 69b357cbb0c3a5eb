#include "sw/fovea/regression/regression_command.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <ctime>
#include <ostream>

#include "sw/fovea/checked_file.h"
#include "sw/fovea/output_file.h"
#include "sw/fovea/regression/attribution.h"
#include "sw/fovea/regression/check.h"
#include "sw/fovea/regression/compare.h"
#include "sw/fovea/regression/trend.h"
#include "sw/fovea/run_files.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using namespace regression;

constexpr std::array<const char*, 4> kCommands = {"compare", "check", "bless", "trend"};
constexpr const char* kAcross = "Also take results of different simulators, and list what differs";

/// Figures that a plot shows if none are asked for.
const std::vector<std::string> kPlotted = {"frame.remap_time.mean", "frame.latency.mean", "frame.rate",
                                           "startup.lut_time",      "cpu.cycles",         "cpu.instructions",
                                           "ddr.utilisation",       kHostInstructions};

/// Behind the line of a run whose host has no counter of instructions, as virtual machines often have none.
constexpr const char* kNotCounted =
    ", without the simulator's host instructions: the host did not count them; --host-instructions gives them";

/// Date and time of a file in UTC, as JUnit XML wants it.
std::string time_of(const fs::path& file) {
  struct stat info {};
  const std::time_t seconds = ::stat(file.c_str(), &info) == 0 ? info.st_mtime : 0;
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts)};
}

int compare(const RegressionOptions& options, const CliContext& context) {
  const auto& o = options.compare;
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

int check(const RegressionOptions& options, const CliContext& context) {
  const auto& o = options.check;
  const Baseline baseline = read_baseline(o.against);
  const RunFigures run = read_run(o.folder);
  std::optional<OutputFile> junit;
  if (!o.junit.empty())
    junit.emplace(o.junit, "--junit", "JUnit XML",
                  [](std::string_view text) { return text.find("<testsuite") != text.npos; });
  const CheckResult result = check_run(run, baseline, o.across_versions);
  if (junit) {
    junit->write(junit_xml(result, run, baseline, time_of(run.folder / "stats.json")));
    junit->commit();
  }
  context.out << check_text(result, run, baseline, o.all) << std::flush;
  return result.failures() ? kExitCheckFailed : kExitDone;
}

/// Puts a complete text in place of a baseline, without a moment in which it is half written.
void replace_file(const fs::path& file, const std::string& text) {
  OutputFile out(file, "--against", "a baseline", [](std::string_view first) {
    return first.find(kBaselineFormat) != first.npos;
  });
  out.write(text);
  out.commit();
}

/// Writes the reference of a baseline if it is missing, belongs to other figures, or can become one
/// by function. @return whether it was written
bool write_reference(const fs::path& folder, const RunFigures& run, const Baseline& baseline, bool changed) {
  std::error_code error;
  if (folder.empty()) return false;
  const bool complete = fs::exists(folder / "figures.csv", error);
  if (!changed && complete) {
    const Attribution had = attribution_of(read_reference(baseline), true), has = attribution_of(run, true);
    if (had.by_function >= has.by_function && had.places.empty() <= has.places.empty() &&
        had.startup.empty() <= has.startup.empty())
      return false;
  }
  if (is_run_folder(folder) || (!complete && fs::is_directory(folder, error) && !fs::is_empty(folder, error)))
    throw UserError(fmt::format("'{}' would be the reference, but it holds something else; give the baseline another "
                                "name, or another 'reference'",
                                one_line(folder.string())));
  const auto files = reference_files(run);
  fs::create_directories(folder, error);
  for (const auto& [name, text] : files) write_file(folder / name, text);
  return true;
}

int bless(const RegressionOptions& options, const CliContext& context) {
  const auto& o = options.bless;
  if (o.why.find_first_not_of(" \t") == std::string::npos)
    throw UserError("--why '': say in a sentence why the figures may change");
  const RunFigures run = read_run(o.folder);
  const fs::path file = o.against;
  std::error_code error;
  std::string before, after;
  if (fs::exists(fs::symlink_status(file, error))) {
    const Baseline baseline = read_baseline(file);
    check_circumstances(run, baseline);
    before = baseline.text;
    after = blessed_text(run, baseline, o.why);
  } else {
    after = new_baseline(run, file.stem().string(), o.why);
  }
  const std::string diff = unified_diff(file.string(), before, after);
  // What was made must be readable, or the file stays as it was.
  const Baseline now = parse_baseline(file, after);
  const bool referred = write_reference(now.reference, run, now, !diff.empty());
  if (!diff.empty()) replace_file(file, after);
  context.out << (diff.empty() ? fmt::format("{} is as this run; nothing to bless\n", file.string()) : diff);
  if (referred) context.out << fmt::format("reference in {}\n", now.reference.string());
  context.out << std::flush;
  std::size_t failures = 0;
  for (const auto& e : now.metrics)
    if (const Finding f = judge(e, run); f.verdict == Verdict::kFail) {
      ++failures;
      context.err << fmt::format("fovea: {} still fails: its kind is {}, which is changed by hand: {}\n",
                                 e.name, kind_name(e.kind), f.words);
    }
  return failures ? kExitCheckFailed : kExitDone;
}

int trend(const RegressionOptions& options, const CliContext& context) {
  const auto& o = options.trend;
  if (o.folders.empty() && o.plot.empty())
    throw UserError("nothing to do; allowed: folders of results to add, --plot FILE, or both");
  std::vector<RunFigures> runs;
  for (const auto& folder : o.folders) runs.push_back(read_run(folder));
  std::optional<OutputFile> plot;
  if (!o.plot.empty())
    plot.emplace(o.plot, "--plot", "a picture of 'fovea trend'",
                 [](std::string_view text) { return text.find("<svg") != text.npos; });
  std::error_code error;
  if (runs.empty() && !fs::exists(o.database, error))
    throw UserError(fmt::format("--database '{}': there is no such file", one_line(o.database)));
  TrendFile file(o.database);
  for (const auto& run : runs) {
    TrendLine line{o.commit.empty() ? commit_text(run) : o.commit, run.experiment, run.simulator(),
                   run.host_instructions, run.metrics};
    if (o.host_instructions > 0) line.host_instructions = o.host_instructions;
    file.add(line);
    context.out << fmt::format("{}: {} of commit {}{}\n", o.database, line.experiment, line.commit,
                               line.host_instructions ? "" : kNotCounted);
  }
  if (plot) {
    plot->write(trend_svg(file.lines(o.experiment), o.figures.empty() ? kPlotted : o.figures));
    plot->commit();
    context.out << fmt::format("picture in {}\n", o.plot);
  }
  context.out << std::flush;
  return kExitDone;
}

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
  CLI::App* check = app.add_subcommand("check", "Compare a run with a baseline, and blame what is worse");
  check->add_option("dir", k.folder, "Folder of results")->required()->type_name("DIR");
  check->add_option("--against", k.against, "Baseline (YAML), required; 'fovea bless' makes one")
      ->required()
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
  bless->footer("Prints the change as a diff. Comments and order stay; analytic values and budgets are "
                "never replaced (exit status 1 if one of them fails). The reference for blame, in the "
                "folder that the baseline names, becomes this run's.");
}

void add_trend(CLI::App& app, RegressionOptions::Trend& t) {
  CLI::App* trend = app.add_subcommand("trend", "Keep the figures of each commit, and plot them");
  trend->add_option("dir", t.folders, "Folders of results to add")->type_name("DIR");
  trend->add_option("--database", t.database, "SQLite file, required; made if it is not there")
      ->required()
      ->type_name("FILE");
  trend->add_option("--commit", t.commit, "Name of the line")->type_name("TEXT")->default_str("the simulator's commit");
  trend->add_option("--host-instructions", t.host_instructions,
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

bool is_regression_command(const std::string& name) {
  return std::find(kCommands.begin(), kCommands.end(), name) != kCommands.end();
}

int command_regression(const std::string& name, const RegressionOptions& options,
                       const CliContext& context) {
  if (name == "compare") return compare(options, context);
  if (name == "check") return check(options, context);
  if (name == "bless") return bless(options, context);
  return trend(options, context);
}

}  // namespace fovea::app
