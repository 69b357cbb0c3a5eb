// Plain findings about a run, each with the figures that it rests on.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/results/outputs.h"

namespace fovea::explain {

/// One sentence or two about a run.
struct Finding {
  std::string rule;  ///< name of the rule that found it, such as "largest_wait"
  std::string text;
  std::vector<std::string> evidence;  ///< figures and files that show it, such as "cpu.cycles"
};

/// A function's clocks in the frames of a run, from profile.csv.
struct FunctionClocks {
  std::string name;
  double clocks = 0;
  std::map<std::string, double> causes;  ///< clocks by cause; "issue" and "idle..." are among them
};

/// What the rules look at. All of it may be missing; then the rules that need it are silent.
struct Inputs {
  std::span<const app::StatRow> stats;
  std::span<const app::StallRow> stalls;
  std::span<const video::FrameTimes> frames;
  std::span<const FunctionClocks> functions = {};
  /// Values of parameters as text ("3 cycles"); empty for an unknown key.
  std::function<std::string(std::string_view key)> parameter = {};
};

/// The findings, the most important one first. They name the largest wait; which resource limits
/// the run cannot be told from one run, only from others in which something is relaxed.
std::vector<Finding> explain(const Inputs& run);

/// What is different in `b` from `a`, which are called so in the sentences.
std::vector<Finding> explain_difference(const Inputs& a, std::string_view name_a, const Inputs& b,
                                        std::string_view name_b);

}  // namespace fovea::explain
