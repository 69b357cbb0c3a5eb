// Names of figures, checked before anything long is run.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/limits/session.h"

namespace fovea::limits {

/// A figure that the user has asked for, and by which option.
struct AskedFigure {
  std::string name, option;
};

/// Checks the names by the figures of a run that ends a microsecond after power-up; those that come only with frames
/// are known here. The runner has nothing else to do yet. If that run fails, nothing is said: a longer one will.
/// @throws UserError for a name that no run of this experiment can have
void check_figures(Session& session, const Settings& settings, const std::vector<AskedFigure>& asked);

/// "; did you mean 'frame.rate'?", or where the names stand.
std::string names_hint(std::string_view name, const points::PointResult& result);

}  // namespace fovea::limits
