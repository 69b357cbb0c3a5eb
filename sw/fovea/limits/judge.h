// Whether a run kept up: conditions on its figures.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/points/point.h"

namespace fovea::limits {

/// `metric` at most, or at least, `bound`. It also holds for the figure of the same name of each
/// camera (`camera.N.METRIC`), where there is one.
struct Condition {
  std::string metric;
  bool at_least = false;
  double bound = 0;
  /// What more than the bound is, in words, such as "frame(s) dropped"; empty: the metric's name.
  std::string words = {};
  /// A figure that is taken from `metric` first, where a run has it; empty: none.
  std::string without = {};
};

/// No frame dropped, none shown again but for the syncs' sake, no capture overflow, no display underflow.
std::vector<Condition> default_conditions();
/// The same with those that the user asked for, "METRIC<=NUMBER" or "METRIC>=NUMBER". One on a metric
/// that has a condition by default takes its place. @throws UserError
std::vector<Condition> conditions_with(const std::vector<std::string>& required);
/// The conditions as text, such as "frame.dropped <= 0".
std::string text_of(const Condition& condition);

struct Verdict {
  enum class Kind {
    kGood,
    kBad,      ///< a condition is not met, or the guest failed
    kUnknown,  ///< the run says nothing about it: wrong input (2), a defect (4), no such figure
  };
  Kind kind = Kind::kUnknown;
  std::string why;  ///< not met, or the message of the run that failed; empty if good
  int status = 2;   ///< for kUnknown: what the command ends with
  bool good() const { return kind == Kind::kGood; }
};

/// Good if all conditions are met and a remap takes no longer than a frame period on average.
Verdict judge(const points::PointResult& result, const std::vector<Condition>& conditions);

}  // namespace fovea::limits
