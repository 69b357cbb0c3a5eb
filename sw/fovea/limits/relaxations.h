// What is relaxed, one at a time, to find out what binds a figure.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "model/common/param.h"
#include "sw/fovea/points/point.h"

namespace fovea::limits {

/// A resource binds if relaxing it alone improves the figure by more than this share. Being busy says
/// nothing.
inline constexpr double kBinds = 0.02;

/// One resource, made better than it is while everything else stays.
struct Relaxation {
  std::string name;      ///< word for --relax and binds.csv
  std::string resource;  ///< in a sentence: "the bridge of the core's data port"
  std::string how;       ///< what is done: "without its latency"
  /// True: the recorded requests of the plain run are replayed, because no parameter of a run does it.
  bool replay = false;
  std::vector<std::string> settings;  ///< for `fovea run`
  std::vector<std::string> options;   ///< for `fovea replay`
  /// Not empty: why it is not tried, such as that it is as good as it can be.
  std::string idle;
  /// What is believed of the parameters that are set: the weakest origin, and where it is assumed or of the family, the
  /// settings at both ends of their belief intervals.
  Origin origin = Origin::kChoice;
  std::vector<std::string> low = {}, high = {};
  bool believed() const { return origin == Origin::kAssumed || origin == Origin::kFamily; }
};

/// All relaxations of an experiment. `params` are its parameters, `plain` is its run, which tells
/// which masters have any traffic. Keys that the program does not have are left out.
std::vector<Relaxation> relaxations(const ParamSet& params, const points::PointResult& plain);
/// @throws UserError for a name of --relax that is none of these
void check_names(const std::vector<std::string>& names, const std::vector<Relaxation>& among);

}  // namespace fovea::limits
