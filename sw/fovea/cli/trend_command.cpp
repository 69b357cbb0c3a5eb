// `fovea trend`: lines are added, jumps are named, and a picture is drawn.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>

#include "model/common/check.h"
#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/compare/compare.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/child_process.h"
#include "sw/fovea/files/output_file.h"
#include "sw/fovea/regression/trend.h"
#include "sw/fovea/results/names.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using namespace regression;

struct TrendOptions {
  std::vector<std::string> folders, figures;
  std::string database, commit, plot, experiment, tolerance = "1%";
  bool replace = false;
  double host_instructions = 0;
};

CLI::App* add_options(CLI::App& app, TrendOptions& t) {
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
  return trend;
}

/// Figures that a plot shows if none are asked for.
const std::vector<std::string> kPlotted = {
    names::kRemapTimeMean, names::kLatencyMean,     names::kRate,           names::kStartupLutTime,
    names::kCpuCycles,     names::kCpuInstructions, names::kDdrUtilisation, kHostInstructions};

/// Behind the line of a run whose host has no counter of instructions, as virtual machines often have none.
constexpr const char* kNotCounted =
    ", without the simulator's host instructions: the host did not count them; --host-instructions gives them";

/// The commit of the repository in which the current folder lies, with "-modified" if its files differ from it; empty:
/// there is none. @throws UserError: git hangs @throws Stopped
std::string current_commit(const CliContext& context) {
  std::optional<ChildProcess> git;
  try {
    git.emplace(std::vector<std::string>{"git", "describe", "--always", "--abbrev=12", "--dirty=-modified",
                                         "--exclude=*"},
                ChildProcess::Stream::kOutput, "the current folder's commit, which --commit would give",
                Patience{context.stop});
  } catch (const UserError&) {
    return "";  // no git
  }
  std::string out;
  while (git->read_some(out)) {
  }
  if (git->finish() != 0) return "";
  return out.erase(out.find_last_not_of('\n') + 1);
}

std::string commit_of(const TrendOptions& o, const CliContext& context) {
  if (!o.commit.empty()) return o.commit;
  std::string out = current_commit(context);
  if (out.empty())
    throw UserError(
        "--commit is missing: the current folder is in no git repository with a commit; name the state of the "
        "program");
  return out;
}

/// What jumps between a line and the one before, and who is to blame.
std::string jump_words(const std::vector<TrendLine>& lines, const TrendLine& added, const Tolerance& tolerance,
                       const std::vector<std::string>& figures) {
  const TrendLine *before = nullptr, *after = nullptr;
  std::string out;
  for (const Jump& j : jumps_of(lines, figures, tolerance)) {
    if (j.after->commit != added.commit || j.after->experiment != added.experiment) continue;
    before = j.before;
    after = j.after;
    const auto a = trend_figure(*before, j.figure), b = trend_figure(*after, j.figure);
    const bool alike = figure_text(*a) == figure_text(*b);
    const auto text = [alike](const Metric& m) {
      return alike ? fmt::format("{:.6g} {}", *m.value, m.unit) : figure_text(m);
    };
    out += fmt::format("  {} jumps from {} of commit {} to {}{}\n", j.figure, text(*a), before->commit,
                       text(*b), std::isinf(j.relative) ? "" : " (" + percent_text(j.relative) + ")");
  }
  return out.empty() ? "" : out + fmt::format("  blamed: {}\n", blame_of_jump(*before, *after));
}

int add_to_trend(const TrendOptions& o, const CliContext& context) {
  if (o.folders.empty() && o.plot.empty())
    throw UserError("nothing to do; allowed: folders of results to add, --plot FILE, or both");
  if (o.database.empty()) throw UserError("--database '': a file name is needed");
  const Tolerance tolerance = parse_tolerance(o.tolerance, "--tolerance");
  std::vector<RunFigures> runs;
  for (const auto& folder : o.folders) runs.push_back(read_run(folder));
  const std::string commit = runs.empty() ? "" : commit_of(o, context);
  std::unique_ptr<OutputFile> plot;
  if (!o.plot.empty())
    plot = std::make_unique<OutputFile>(o.plot, "--plot", "a picture of 'fovea trend'",
                                        [](std::string_view text) { return text.find("<svg") != text.npos; });
  std::error_code error;
  if (runs.empty() && !fs::exists(o.database, error))
    throw UserError(fmt::format("--database '{}': there is no such file", one_line(o.database)));
  const std::vector<std::string>& figures = o.figures.empty() ? kPlotted : o.figures;
  TrendFile file(o.database);
  for (const auto& run : runs) {
    TrendLine line{commit,
                   run.subject.label(),
                   run.simulator(),
                   run.host_instructions,
                   run.metrics,
                   run.input_hash(),
                   fs::absolute(run.folder, error).string()};
    if (o.host_instructions > 0) line.host_instructions = o.host_instructions;
    file.add(line, o.replace);
    context.out << fmt::format("{}: {} of commit {}{}{}\n", o.database, line.experiment, line.commit,
                               o.commit.empty() ? ", the current folder's" : "",
                               line.host_instructions ? "" : kNotCounted)
                << jump_words(file.lines(line.experiment), line, tolerance, figures);
  }
  if (plot) {
    plot->write(trend_svg(file.lines(o.experiment), figures, tolerance));
    plot->commit();
    context.out << fmt::format("picture in {}\n", o.plot);
  }
  context.out << std::flush;
  return kExitDone;
}

}  // namespace

Command add_trend(CLI::App& app) {
  const auto o = std::make_shared<TrendOptions>();
  CLI::App* const c = add_options(app, *o);
  return {c, [o](const Call& call) { return add_to_trend(*o, call.context); }};
}

}  // namespace fovea::app
