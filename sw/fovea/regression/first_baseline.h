// The first baseline of a result: its figures that are costs, with the tolerance that layout needs.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/compare/tolerance.h"
#include "sw/fovea/results/run_figures.h"

namespace fovea::regression {

/// The tolerance of a first baseline for which no noise was measured: several times what unused code, another link
/// order, longer strings or moved sections do to a figure (decision 0022).
inline constexpr std::string_view kFirstTolerance = "1%";

struct FirstBaseline {
  const RunFigures* run = nullptr;
  /// Results of the same program at other addresses; with these, a figure's tolerance is twice its largest
  /// deviation in them.
  std::vector<RunFigures> layouts = {};
  Tolerance tolerance = {};    ///< without `layouts`
  std::string reference, why;  ///< name of the folder beside the baseline; a sentence
};

/// The text of the baseline. @throws UserError: the result has no figure that is a cost or names nothing that ran; a
/// layout is of something else, has other settings, or is the same program
std::string new_baseline(const FirstBaseline& first);

}  // namespace fovea::regression
