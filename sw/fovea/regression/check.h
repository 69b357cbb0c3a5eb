// `fovea check`: a run's figures against a baseline, and `fovea bless`, which updates one.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/compare/blame.h"
#include "sw/fovea/regression/baseline.h"

namespace fovea::regression {

enum class Verdict { kPass, kBetter, kFail };

/// One line of a check.
struct Finding {
  const Expectation* expected = nullptr;
  const Metric* got = nullptr;  ///< nullptr: the run lacks the figure
  Verdict verdict = Verdict::kPass;
  std::string words;            ///< value, expected value, what is allowed

  /// The deviation as a share of what was expected; infinite where there is no such share.
  double size() const;
};

struct CheckResult {
  std::vector<Finding> findings;       ///< in the order of the baseline
  std::vector<std::string> settings;   ///< what differs between the reference and the run
  std::optional<Difference> difference;
  std::string blame;                   ///< one sentence; empty if nothing failed or nothing is known
  std::string blamed;                  ///< the place that the sentence names: function, file and line
  std::string advice;                  ///< how to get a blame by function and line; empty: it is one

  std::size_t failures() const;
};

/// Compares one figure. A kind `exact` with `worse: both` fails on any deviation beyond the
/// tolerance; otherwise only a deviation in the direction that is worse fails, the other one is
/// "better" (of a budget: passes).
Finding judge(const Expectation& expected, const RunFigures& run, bool hint = true);

/// Refuses a run that the baseline is not for. @throws UserError: another experiment or other
/// settings
void check_circumstances(const RunFigures& run, const Baseline& baseline);

/// @throws UserError: the run is of another experiment or has other settings than the baseline, or
/// comes from another simulator (unless `across_versions`), or the reference cannot be read
CheckResult check_run(const RunFigures& run, const Baseline& baseline, bool across_versions);

/// Failures, the largest first; then what became better, the same; then what passes.
std::vector<const Finding*> findings_by_size(const CheckResult& result);
/// "allowed: 1 % higher".
std::string allowed_text(const Expectation& expected);

/// Five lines for a merge request: figure, before, after, who, why.
std::string markdown_text(const CheckResult& result, const RunFigures& run, const Baseline& baseline);
/// The report for people. `all` lists the figures that pass, too.
std::string check_text(const CheckResult& result, const RunFigures& run, const Baseline& baseline,
                       bool all);
/// JUnit XML: a suite with a case for each figure. `when` is a UTC time "2026-11-23T12:00:00".
std::string junit_xml(const CheckResult& result, const RunFigures& run, const Baseline& baseline,
                      const std::string& when);

/// A text in which each changed value of kind `exact` is the run's, with the run's simulator and a
/// new entry of the history. Everything else is the same byte for byte. Equal values (within no
/// tolerance) change nothing; then the text is the baseline's own.
/// @throws UserError: a figure of the baseline is missing in the run or has another unit
std::string blessed_text(const RunFigures& run, const Baseline& baseline, const std::string& why);

/// The lines that differ, in the unified format, with up to three lines around them.
std::string unified_diff(const std::string& name, const std::string& before,
                         const std::string& after);

}  // namespace fovea::regression
