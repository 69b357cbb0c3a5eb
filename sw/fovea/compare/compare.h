// `fovea compare A B`: which figures of two runs differ, by how much, and where the clocks went.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/compare/blame.h"
#include "sw/fovea/compare/tolerance.h"
#include "sw/fovea/results/run_figures.h"

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

/// What differs in the circumstances of two results, as lines: "key: a -> b", sentences about inputs.
struct SettingChanges {
  std::vector<std::string> both;      ///< what both have
  std::vector<std::string> one_only;  ///< parameters that only one of them has
};

struct Comparison {
  const RunFigures *before = nullptr, *after = nullptr;
  std::size_t compared = 0;           ///< figures of either run that the pattern selects
  std::vector<MetricChange> changes;  ///< beyond the tolerance; sorted by name
  SettingChanges settings;
  std::optional<Difference> difference;
  std::vector<Difference> startup;    ///< of the parts before the window whose time changed
};

/// What differs in the circumstances of two results: simulator, parameters, inputs; and the same as one list.
/// Parameters that one simulator does not have are told apart from those that were set otherwise.
SettingChanges setting_changes(const RunFigures& before, const RunFigures& after);
std::vector<std::string> differences_of_settings(const RunFigures& before, const RunFigures& after);
Circumstances circumstances_of(const RunFigures& before, const RunFigures& after);
/// True if the same simulator made both: version, commit, no modification.
bool same_simulator(const RunFigures& a, const RunFigures& b);
/// Refuses results of different simulators. @throws UserError
void refuse_other_simulator(const RunFigures& a, const RunFigures& b);

/// @param only part of a name or a pattern with `*` and `?`; empty: all figures
Comparison compare_runs(const RunFigures& before, const RunFigures& after,
                        const Tolerance& tolerance, const std::string& only);

/// A change with its size as a share of the time: of the frame period for the figures of a frame, of the window for its
/// sums. Clocks, times, bytes (of what the memory's bus can carry), ratios and lost frames have one; other counts not.
struct SharedChange {
  const MetricChange* change = nullptr;
  std::optional<double> share;
};
/// The changes, the largest share first; then those without one, by their relative change; last those that only one
/// result has.
std::vector<SharedChange> by_share_of_time(const Comparison& comparison);

/// A window that begins at power-up holds the boot at a slower clock, and so the mean length of its clocks depends on
/// the program. If the keys of the clocks are equal and both windows begin there, both attributions get one length.
void level_clocks(const RunFigures& before, const RunFigures& after, Attribution& a, Attribution& b);

std::string comparison_text(const Comparison& comparison, const Tolerance& tolerance, bool all);
std::string comparison_csv(const Comparison& comparison);
std::string comparison_json(const Comparison& comparison);

/// "+1.2 ms", "+3.1 %": a change for people; empty texts where there is none.
std::string change_text(const MetricChange& change);
std::string percent_text(std::optional<double> share);
/// The part of a report about clocks, several lines. `rows` limits the table.
std::string difference_text(const Difference& difference, std::size_t rows);

}  // namespace fovea::regression
