#include "sw/fovea/regression/first_baseline.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/common/check.h"
#include "sw/fovea/compare/compare.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/regression/baseline.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::regression {
namespace {

/// How a figure of a first baseline is judged.
enum class Rule {
  kCost,   ///< a time or an amount, which varies with the addresses of the program
  kLoss,   ///< a count of what was lost: one more is one too many
  kSpare,  ///< clocks that are left: what the others vary by, it varies by
};
struct Headline {
  const char* name;
  const char* worse;
  Rule rule;
};
/// Instructions and row conflicts are no costs: a program that waits by polling executes fewer of them when it is
/// slower, and what conflicts cost is in the times.
constexpr std::array kOfRun = std::to_array<Headline>({{names::kRate, "lower", Rule::kCost},
                                                       {names::kDropped, "higher", Rule::kLoss},
                                                       {names::kRepeated, "higher", Rule::kLoss},
                                                       {names::kRemapRate, "lower", Rule::kCost},
                                                       {names::kRemapTimeMean, "higher", Rule::kCost},
                                                       {names::kRemapTimeMax, "higher", Rule::kCost},
                                                       {names::kLatencyMean, "higher", Rule::kCost},
                                                       {names::kLatencyMax, "higher", Rule::kCost},
                                                       {names::kStartupFirstFrame, "higher", Rule::kCost},
                                                       {names::kStartupLutTime, "higher", Rule::kCost},
                                                       {names::kCaptureOverflows, "higher", Rule::kLoss},
                                                       {names::kDisplayUnderflows, "higher", Rule::kLoss},
                                                       {names::kCpuSpare, "lower", Rule::kSpare},
                                                       {names::kDdrBusBytes, "higher", Rule::kCost}});
/// A program that runs to its end, on the board or without it.
constexpr std::array kOfProgram =
    std::to_array<Headline>({{names::kCpuCycles, "higher", Rule::kCost}, {names::kDdrBusBytes, "higher", Rule::kCost}});
constexpr std::array kOfReplay = std::to_array<Headline>({{"replay.time", "higher", Rule::kCost},
                                                          {names::kRemapTimeMean, "higher", Rule::kCost},
                                                          {names::kRemapTimeMax, "higher", Rule::kCost},
                                                          {names::kDdrBusBytes, "higher", Rule::kCost}});

std::vector<Headline> headlines_of(const RunFigures& run) {
  const auto list = [](const auto& rows) { return std::vector<Headline>(rows.begin(), rows.end()); };
  if (run.subject.kind == ResultKind::kReplay) return list(kOfReplay);
  // The clocks of a window of frames are those of its time: only without frames they are a cost.
  return run.has_frames() ? list(kOfRun) : list(kOfProgram);
}

/// To a whole number, if it is not one but for the rounding of doubles.
double rounded_up(double value) { return std::ceil(value - 1e-6); }

/// Twice the largest deviation, as a share with one decimal of a per cent, rounded up.
std::string measured_tolerance(const Metric& m, double deviation) {
  if (*m.value == 0 || deviation == 0) return "";
  return fmt::format("{:.1f}%", std::max(1.0, rounded_up(2 * 1000 * deviation / std::abs(*m.value))) / 10);
}

double largest_deviation(const Headline& h, const Metric& m, const std::vector<RunFigures>& layouts) {
  double out = 0;
  for (const RunFigures& layout : layouts)
    if (const Metric* const other = layout.metric(h.name); other && other->value)
      out = std::max(out, std::abs(*other->value - *m.value));
  return out;
}

/// The clocks in which the core was busy; of the clocks that are left, the same share is another one.
double busy_clocks(const RunFigures& run) { return run.value(names::kCpuCycles) - run.value(names::kCpuSpare); }

std::string tolerance_of(const Headline& h, const Metric& m, const FirstBaseline& first) {
  if (h.rule == Rule::kLoss || !m.value) return "";
  const bool measured = !first.layouts.empty();
  if (h.rule == Rule::kSpare) {
    const double deviation =
        measured ? 2 * largest_deviation(h, m, first.layouts) : first.tolerance.allowed(busy_clocks(*first.run));
    return deviation == 0 ? "" : exact_text(rounded_up(deviation), true);
  }
  if (measured) return measured_tolerance(m, largest_deviation(h, m, first.layouts));
  if (*m.value == 0 && first.tolerance.absolute == 0) return "";
  std::vector<std::string> parts;
  if (first.tolerance.relative != 0)
    parts.push_back(fmt::format("{}%", app::number_text(100 * first.tolerance.relative)));
  if (first.tolerance.absolute != 0) parts.push_back(app::number_text(first.tolerance.absolute));
  return fmt::format("{}", fmt::join(parts, " or "));
}

void check_layouts(const FirstBaseline& first) {
  const RunFigures& run = *first.run;
  for (const RunFigures& layout : first.layouts) {
    const std::string name = app::one_line(layout.folder.string());
    refuse_other_simulator(run, layout);
    // A program of `exec` may have another name at each layout.
    if (layout.subject.kind != run.subject.kind ||
        (run.subject.kind == ResultKind::kRun && layout.subject != run.subject))
      throw UserError(
          fmt::format("--layout '{}' is of {}, '{}' of {}; allowed: results that differ in nothing but "
                      "where the program's code lies",
                      name, layout.subject.text(), app::one_line(run.folder.string()), run.subject.text()));
    const Circumstances c = circumstances_of(run, layout);
    if (c.settings_differ)
      throw UserError(fmt::format("--layout '{}' has other settings or inputs than '{}'; 'fovea compare' lists them",
                                  name, app::one_line(run.folder.string())));
    if (!c.program_differs)
      throw UserError(
          fmt::format("--layout '{}' is the same program as '{}'; allowed: the program linked in another "
                      "order or at other addresses",
                      name, app::one_line(run.folder.string())));
  }
}

std::string subject_lines(const Subject& subject) {
  std::string out = fmt::format("{}: {}\n", subject_key(subject.kind), yaml_scalar(subject.name));
  const auto list = [&out](const char* key, const std::vector<std::string>& words) {
    if (words.empty()) return;
    std::vector<std::string> quoted;
    for (const auto& w : words) quoted.push_back(yaml_text(w));
    out += fmt::format("{}: [{}]\n", key, fmt::join(quoted, ", "));
  };
  list("arguments", subject.arguments);
  list("options", subject.options);
  return out;
}

std::string noise_words(const FirstBaseline& first) {
  if (!first.layouts.empty())
    return fmt::format("# Tolerances: twice the largest deviation of {} other layout{} of the program.\n",
                       first.layouts.size(), first.layouts.size() == 1 ? "" : "s");
  if (first.tolerance.allowed(1) == 0) return "";
  return "# The tolerances are for layout: unused code, link order and addresses move a figure by less.\n";
}

}  // namespace

std::string new_baseline(const FirstBaseline& first) {
  const RunFigures& run = *first.run;
  const std::string folder = app::one_line(run.folder.string());
  if (run.subject.name.empty())
    throw UserError(fmt::format("'{}' does not name its {}; run it again with this version of Fovea", folder,
                                subject_key(run.subject.kind)));
  check_layouts(first);
  std::string out = fmt::format(
      "# What the figures of a result should be: 'fovea check DIR --against THIS'. Values of the kind\n"
      "# exact come from a run and are replaced by 'fovea bless'; see 'fovea check --help'.\n{}"
      "format: {}\n{}simulator:\n  version: {}\n  commit: {}\n",
      noise_words(first), kBaselineFormat, subject_lines(run.subject), run.version, commit_text(run));
  if (const auto frames = run.parameters.find("run.frames");
      frames != run.parameters.end() && run.subject.kind == ResultKind::kRun)
    out += fmt::format("settings:\n  run.frames: {}\n", yaml_scalar(frames->second.value));
  out += fmt::format("reference: {}\nmetrics:\n", yaml_scalar(first.reference));
  std::size_t figures = 0;
  for (const Headline& h : headlines_of(run)) {
    const Metric* const m = run.metric(h.name);
    if (!m) continue;
    ++figures;
    out += fmt::format("  {}:\n    value: {}\n    unit: {}\n", h.name,
                       m->value ? exact_text(*m->value, m->whole) : "null", yaml_scalar(m->unit));
    if (const std::string tolerance = tolerance_of(h, *m, first); !tolerance.empty())
      out += fmt::format("    tolerance: {}\n", tolerance);
    out += fmt::format("    worse: {}\n    kind: exact\n", h.worse);
    if (h.rule == Rule::kSpare && first.layouts.empty() && first.tolerance.relative != 0)
      out += fmt::format("    reason: the tolerance is {} of the clocks in which the core was busy\n",
                         first.tolerance.text());
  }
  if (!figures)
    throw UserError(
        fmt::format("'{}' has no figure of a first baseline; write one by hand, with figures of its "
                    "stats.json",
                    folder));
  return out + fmt::format("history:\n  - commit: {}\n    why: {}\n", commit_text(run), yaml_text(first.why));
}

}  // namespace fovea::regression
