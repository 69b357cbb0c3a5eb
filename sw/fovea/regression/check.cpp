#include "sw/fovea/regression/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/common/check.h"
#include "sw/fovea/compare/compare.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/regression/check_blame.h"

namespace fovea::regression {
namespace {

/// The value that a limit or an expectation has, in words.
std::string expected_text(const Expectation& e, const Metric& got) {
  Metric m{e.value, e.unit, got.whole && e.value && *e.value == std::floor(*e.value)};
  const char* const what = e.kind == Kind::kBudget     ? "budget "
                           : e.kind == Kind::kAnalytic ? "by calculation "
                                                       : "baseline ";
  return what + figure_text(m);
}

}  // namespace

std::string allowed_text(const Expectation& e) {
  const bool none = e.tolerance.allowed(e.value.value_or(0)) == 0;
  std::string out = none ? "no deviation" : e.tolerance.text(e.unit);
  if (e.worse == Worse::kHigher) out += none ? " upwards" : " higher";
  if (e.worse == Worse::kLower) out += none ? " downwards" : " lower";
  return "allowed: " + out;
}

namespace {

/// What is to be done for function and line; the command is the one that made the run.
std::string advice_text(const RunFigures& run, const Attribution& before, const Attribution& after) {
  if (after.by_function)
    return before.by_function ? ""
                              : "function and line are not known, because the reference has no profile; "
                                "'fovea bless' with a run of --profile gives it one";
  std::string command;
  for (const auto& word : run.command) {
    const bool plain = word.find_first_of(" \t\n'\"\\$*?;&|<>()[]{}~#`!") == word.npos && !word.empty();
    command += (command.empty() ? "" : " ") + (plain ? word : fmt::format("'{}'", word));
  }
  return "function and line are not known, because the run has no profile; run it again with --profile" +
         (command.empty() ? "" : ": " + app::one_line(command, 1000) + " --profile");
}

}  // namespace

void check_circumstances(const RunFigures& run, const Baseline& baseline) {
  const std::string file = app::one_line(baseline.file.string());
  if (run.subject != baseline.subject)
    throw UserError(fmt::format("'{}' is of {}, {} is for {}", app::one_line(run.folder.string()), run.subject.text(),
                                file, baseline.subject.text()));
  for (const auto& [key, value] : baseline.settings) {
    const auto found = run.parameters.find(key);
    if (found == run.parameters.end())
      throw UserError(fmt::format("{}: settings: no parameter '{}'; 'fovea params' lists all keys",
                                  file, app::one_line(key, 60)));
    if (found->second.value != value)
      throw UserError(fmt::format("{} is for {} = {}; '{}' has {}", file, key, value,
                                  app::one_line(run.folder.string()),
                                  app::one_line(found->second.value, 60)));
  }
}

std::size_t CheckResult::failures() const {
  return static_cast<std::size_t>(std::count_if(
      findings.begin(), findings.end(), [](const Finding& f) { return f.verdict == Verdict::kFail; }));
}

double Finding::size() const {
  if (!got || !got->value || !expected->value || got->unit != expected->unit || *expected->value == 0)
    return verdict == Verdict::kPass ? 0 : INFINITY;
  return std::abs((*got->value - *expected->value) / *expected->value);
}

std::vector<const Finding*> findings_by_size(const CheckResult& result) {
  std::vector<const Finding*> out;
  for (const Finding& f : result.findings) out.push_back(&f);
  // What passes stays in the order of the baseline.
  std::stable_sort(out.begin(), out.end(), [](const Finding* a, const Finding* b) {
    if (a->verdict != b->verdict) return a->verdict > b->verdict;
    return a->verdict != Verdict::kPass && a->size() > b->size();
  });
  return out;
}

Finding judge(const Expectation& e, const RunFigures& run, bool hint) {
  Finding out{&e, run.metric(e.name), Verdict::kPass, ""};
  const auto fail = [&out](std::string words) {
    out.verdict = Verdict::kFail;
    out.words = std::move(words);
    return out;
  };
  if (!out.got) {
    const std::string near = hint ? nearest_metric(run, e.name) : "";
    return fail("the run has no such figure" +
                (near.empty() ? std::string() : "; did you mean " + near + "?"));
  }
  const Metric& m = *out.got;
  if (m.unit != e.unit)
    return fail(fmt::format("the unit is {}, in the baseline {}", m.unit, e.unit));
  if (!m.value && !e.value) {
    out.words = "no value, as expected";
    return out;
  }
  if (!m.value || !e.value)
    return fail(fmt::format("{}, expected: {}", figure_text(m),
                            e.value ? expected_text(e, m) : "no value"));
  const bool whole = m.whole && *e.value == std::floor(*e.value);
  const Deviation deviation = deviation_of(*m.value, *e.value, e.tolerance, whole);
  Metric difference = m;
  difference.value = std::abs(*m.value - *e.value);
  out.words = figure_text(m) + ", " + expected_text(e, m);
  if (*m.value != *e.value) {
    out.words += fmt::format(" ({}{}", *m.value < *e.value ? "-" : "+", figure_text(difference));
    if (*e.value != 0)
      out.words += ", " + percent_text((*m.value - *e.value) / std::abs(*e.value));
    out.words += ")";
  }
  if (deviation == Deviation::kWithin) return out;
  const bool worse = e.worse == Worse::kBoth ||
                     (e.worse == Worse::kHigher) == (deviation == Deviation::kHigher);
  // A budget that is not used up is no news.
  if (!worse && e.kind == Kind::kBudget) return out;
  out.verdict = worse ? Verdict::kFail : Verdict::kBetter;
  out.words += "; " + allowed_text(e);
  return out;
}

CheckResult check_run(const RunFigures& run, const Baseline& baseline, bool across_versions) {
  if (!across_versions &&
      (run.version != baseline.version || commit_text(run) != baseline.commit))
    throw UserError(fmt::format(
        "'{}' is of simulator {} (commit {}), {} of {} (commit {}); allowed: results of the "
        "baseline's simulator, or --across-versions, which lists what differs",
        app::one_line(run.folder.string()), run.version, commit_text(run),
        app::one_line(baseline.file.string()), baseline.version, baseline.commit));
  check_circumstances(run, baseline);
  CheckResult out;
  // Each hint compares a name with all others. More unknown names than these are no typing errors.
  constexpr std::size_t kMostHints = 20;
  std::size_t unknown = 0;
  for (const auto& e : baseline.metrics) {
    unknown += run.metric(e.name) == nullptr;
    out.findings.push_back(judge(e, run, unknown <= kMostHints));
  }
  if (baseline.reference.empty()) return out;
  const RunFigures reference = read_reference(baseline);
  out.settings = differences_of_settings(reference, run);
  if (out.failures() == 0) return out;
  Attribution before = attribution_of(reference, true), after = attribution_of(run, true);
  level_clocks(reference, run, before, after);
  if (before.rows.empty() || after.rows.empty()) return out;
  CheckBlame blame = blame_failures(out.findings, before, after, circumstances_of(reference, run));
  out.difference = std::move(blame.difference);
  out.blame = std::move(blame.text);
  out.blamed = std::move(blame.place);
  out.advice = advice_text(run, before, after);
  return out;
}

std::string check_text(const CheckResult& result, const RunFigures& run, const Baseline& baseline,
                       bool all) {
  const std::size_t failures = result.failures();
  std::string out =
      fmt::format("{}: {} against {}: ", failures ? "FAILED" : "passed", run.subject.label(),
                  app::one_line(baseline.file.string()));
  out += failures ? fmt::format("{} of {} figures\n", failures, result.findings.size())
                  : fmt::format("{} figures\n", result.findings.size());
  std::size_t width = 0, better = 0;
  for (const auto& f : result.findings) width = std::max(width, f.expected->name.size());
  for (const Finding* finding : findings_by_size(result)) {
    const Finding& f = *finding;
    better += f.verdict == Verdict::kBetter;
    if (f.verdict == Verdict::kPass && !all) continue;
    const char* const word = f.verdict == Verdict::kFail     ? "FAILED"
                             : f.verdict == Verdict::kBetter ? "better"
                                                             : "ok";
    out += fmt::format("  {:<6}  {:<{}}  {}", word, f.expected->name, width, f.words);
    if (f.verdict == Verdict::kFail && !f.expected->reason.empty())
      out += fmt::format(" [{}]", app::one_line(f.expected->reason));
    out += "\n";
  }
  if (better && !failures && !baseline.text.empty())
    out += fmt::format("  'fovea bless {} --against {} --why TEXT' keeps what became better\n",
                       app::one_line(run.folder.string()), app::one_line(baseline.file.string()));
  if (!result.settings.empty() && (failures || run.version != baseline.version ||
                                   commit_text(run) != baseline.commit)) {
    out += "what was different from the reference:\n";
    for (const auto& line : result.settings) out += "  " + line + "\n";
  }
  if (failures && result.difference && !result.difference->none())
    out += difference_text(*result.difference, 8);
  if (!result.blame.empty()) out += "blamed: " + result.blame + "\n";
  else if (failures && baseline.reference.empty())
    out += "blamed: nothing, because the baseline has no reference\n";
  if (!result.advice.empty()) out += result.advice + "\n";
  return out;
}

}  // namespace fovea::regression
