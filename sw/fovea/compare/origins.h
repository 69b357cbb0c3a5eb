// Which function's change a change of clocks comes from: the one with other code that is nearest to where they are
// spent, up its callers and the functions that hold it inlined.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "sw/fovea/compare/attribution.h"

namespace fovea::regression {

using CauseKey = std::tuple<std::string, std::string, std::string>;  ///< cause, region, culprit

/// What a function's change has done to its clocks and those of what it calls.
struct ClockOrigin {
  FunctionKey function;
  double change = 0;        ///< of clocks
  double instructions = 0;  ///< change of their number
  std::map<CauseKey, double> causes;
  std::vector<FunctionKey> path;  ///< to the function that changed most in the same direction; empty: itself
  std::vector<FunctionKey> with;  ///< functions that code was moved to or from, counted here
  bool polls = false;             ///< in loops that only wait
  double largest = 0;             ///< change at the end of `path`
};

/// The rows of one run to be compared, and what a clock and an instruction of them count as.
struct Part {
  std::vector<const AttributionRow*> rows;
  std::vector<const CallPath*> paths;
  double scale = 1, count = 1;
};

/// Origins of the changes that come from other code, largest change first. What has none is left out: it waits.
/// `before` has the names of `after` (matching.h). A change belongs to
/// - an inlined function if its lines changed by other factors than one, or if it changed wherever it is inlined;
/// - otherwise the next function that holds it, and in the end the one whose code it is part of, if that has other
/// code;
/// - otherwise, if it executes more or less, its callers, by how much they did so, up to one that has other code.
/// Functions of one file that have other code and of which one gained what another one lost are one origin.
std::vector<ClockOrigin> origins_of(const Attribution& before, const Part& a, const Attribution& after, const Part& b);

}  // namespace fovea::regression
