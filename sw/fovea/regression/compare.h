// `fovea compare A B`: which figures of two runs differ, by how much, and where the clocks went.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/regression/blame.h"
#include "sw/fovea/regression/run_figures.h"
#include "sw/fovea/regression/tolerance.h"

namespace fovea::regression {

/// A figure that differs, or that only one run has.
struct MetricChange {
  std::string name;
  const Metric *before = nullptr, *after = nullptr;  ///< nullptr: the run does not have it
  bool unit_differs = false;

  /// Difference of the values; empty if one is missing or the units differ.
  std::optional<double> difference() const;
  /// The same as a share of the first value; empty also if that is 0.
  std::optional<double> relative() const;
};

struct Comparison {
  const RunFigures *before = nullptr, *after = nullptr;
  std::size_t compared = 0;           ///< figures of either run that the pattern selects
  std::vector<MetricChange> changes;  ///< beyond the tolerance; sorted by name
  std::vector<std::string> settings;  ///< "key: a -> b", sentences about inputs
  std::optional<Difference> difference;
  std::vector<Difference> startup;    ///< of the parts before the window whose time changed
};

/// Lines about what differs in the circumstances of two results: simulator, parameters, inputs.
/// Parameters that one simulator does not have are told apart from those that were set otherwise.
std::vector<std::string> differences_of_settings(const RunFigures& before, const RunFigures& after);
Circumstances circumstances_of(const RunFigures& before, const RunFigures& after);
/// True if the same simulator made both: version, commit, no modification.
bool same_simulator(const RunFigures& a, const RunFigures& b);
/// Refuses results of different simulators. @throws UserError
void refuse_other_simulator(const RunFigures& a, const RunFigures& b);

/// @param only part of a name or a pattern with `*` and `?`; empty: all figures
Comparison compare_runs(const RunFigures& before, const RunFigures& after,
                        const Tolerance& tolerance, const std::string& only);

std::string comparison_text(const Comparison& comparison, const Tolerance& tolerance, bool all);
std::string comparison_csv(const Comparison& comparison);
std::string comparison_json(const Comparison& comparison);

/// "+1.2 ms", "+3.1 %": a change for people; empty texts where there is none.
std::string change_text(const MetricChange& change);
std::string percent_text(std::optional<double> share);
/// The part of a report about clocks, several lines. `rows` limits the table.
std::string difference_text(const Difference& difference, std::size_t rows);

}  // namespace fovea::regression
