// Where a figure of `fovea trend` jumps, and who is to blame.
#include <fmt/format.h>

#include <cmath>

#include "model/common/check.h"
#include "sw/fovea/compare/blame.h"
#include "sw/fovea/compare/compare.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/regression/trend.h"

namespace fovea::regression {
namespace {

/// The results of a line, if its folder still has them. @throws UserError that says why not
RunFigures results_of(const TrendLine& line) {
  if (line.folder.empty())
    throw UserError(fmt::format("the line of commit {} does not say where its results are", line.commit));
  RunFigures run = read_run(line.folder);
  // The next run may have gone to the same folder.
  for (const auto& [name, m] : line.figures)
    if (const Metric* const now = run.metric(name); !now || now->value != m.value)
      throw UserError(
          fmt::format("'{}' no longer has the results of commit {}", app::one_line(line.folder), line.commit));
  if (!has_profile(run))
    throw UserError(fmt::format("'{}' has no profile ('fovea run --profile')", app::one_line(line.folder)));
  return run;
}

}  // namespace

std::optional<Metric> trend_figure(const TrendLine& line, const std::string& name) {
  if (name == kHostInstructions) {
    if (!line.host_instructions) return std::nullopt;
    return Metric{line.host_instructions, "per guest instruction", false};
  }
  const auto found = line.figures.find(name);
  if (found == line.figures.end() || !found->second.value) return std::nullopt;
  return found->second;
}

std::vector<Jump> jumps_of(const std::vector<TrendLine>& lines, const std::vector<std::string>& figures,
                           const Tolerance& tolerance) {
  std::vector<Jump> out;
  std::map<std::string, const TrendLine*> last;  // of each experiment
  for (const TrendLine& line : lines) {
    const TrendLine* const before = std::exchange(last[line.experiment], &line);
    if (!before) continue;
    for (const auto& figure : figures) {
      const auto a = trend_figure(*before, figure), b = trend_figure(line, figure);
      if (figure == kHostInstructions || !a || !b || a->unit != b->unit) continue;
      if (deviation_of(*b->value, *a->value, tolerance, a->whole && b->whole) == Deviation::kWithin) continue;
      const double relative = *a->value == 0 ? INFINITY : (*b->value - *a->value) / std::abs(*a->value);
      out.push_back({before, &line, figure, relative});
    }
  }
  return out;
}

std::string blame_of_jump(const TrendLine& before, const TrendLine& after) {
  try {
    const RunFigures a = results_of(before), b = results_of(after);
    Attribution before_clocks = attribution_of(a, true), after_clocks = attribution_of(b, true);
    level_clocks(a, b, before_clocks, after_clocks);
    const Difference d = difference_of(before_clocks, after_clocks, circumstances_of(a, b));
    const std::string text = blame_text(d, blame_of(d, d.busy.change() >= 0));
    return text.empty() ? "no function, because none has other clocks" : text;
  } catch (const UserError& e) {
    return fmt::format("not known, because {}", e.what());
  }
}

}  // namespace fovea::regression
