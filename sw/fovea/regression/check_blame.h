// Who is to blame for the figures of a check that failed: for each part of the run, by what the figures need.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "sw/fovea/compare/blame.h"
#include "sw/fovea/regression/check.h"

namespace fovea::regression {

struct CheckBlame {
  std::optional<Difference> difference;  ///< of the first part that a failed figure measures
  std::string place;                     ///< what the first sentence names: function, file and line; may be empty
  std::string text;                      ///< a sentence for each part, with "\nblamed: " between them
};

/// A failed figure is blamed in its own part of the run, and only on what makes at least a tenth of a time that is
/// worse (a fiftieth of a latency or a start, which the camera's pace prolongs), or changes the part's clocks by more
/// than the figure's tolerance.
CheckBlame blame_failures(std::span<const Finding> findings, const Attribution& before, const Attribution& after,
                          const Circumstances& circumstances);

}  // namespace fovea::regression
