// Whether a run kept up: conditions on its figures.
#pragma once
#include <cstdint>
#include <optional>
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
  /// What the condition asks, in words; empty: its text.
  std::string sentence = {};
  /// One more than the bound may be the slip of a loop that is later from then on, which is no loss.
  bool slip = false;
};

/// No frame dropped, none shown again but for the syncs' sake or a single slip, no capture overflow, no display
/// underflow.
std::vector<Condition> default_conditions();
/// The same with those that the user asked for, "METRIC<=NUMBER" or "METRIC>=NUMBER". One on a metric
/// that has a condition by default takes its place. @throws UserError
std::vector<Condition> conditions_with(const std::vector<std::string>& required);
/// The condition in words, or as text, such as "frame.rate >= 25".
std::string text_of(const Condition& condition);

/// The share of a frame period that the longest remap leaves; negative: that it takes more. Nothing if the run does
/// not say.
std::optional<double> slack(const points::PointResult& result);
/// New frames a second that a loop shows once it has slipped: those of the window, and the one that a slip took.
/// Nothing if the run does not say.
std::optional<double> steady_rate(const points::PointResult& result);

struct Verdict {
  enum class Kind {
    kGood,
    kBad,      ///< a condition is not met, or the guest failed
    kUnknown,  ///< the run says nothing about it: wrong input (2), a defect (4), no such figure
  };
  Kind kind = Kind::kUnknown;
  std::string why;  ///< not met, or the message of the run that failed; empty if good
  int status = 2;   ///< for kUnknown: what the command ends with
  /// A longer window has to tell: bad, but only for a frame that was shown again once, or good although a remap took
  /// longer than a frame period, so that the mean over more frames decides.
  bool longer = false;
  bool good() const { return kind == Kind::kGood; }
};

/// Good if all conditions are met and a remap takes no longer than a frame period on average. `slips` is how often a
/// frame may have been shown again because the loop slipped.
Verdict judge(const points::PointResult& result, const std::vector<Condition>& conditions, unsigned slips = 0);
/// Frames of the window that tells whether what happened once in a window of `frames` happens again.
constexpr std::uint64_t longer_window(std::uint64_t frames) { return frames < 24 ? frames + 24 : 2 * frames; }

}  // namespace fovea::limits
