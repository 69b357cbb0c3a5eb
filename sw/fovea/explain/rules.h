// The rules of explain(): each is a function from the figures of a run to findings.
#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "sw/fovea/explain/explain.h"

namespace fovea::explain {

/// Look-ups that several rules need.
class Run {
 public:
  explicit Run(const Inputs& inputs) : inputs_(inputs) {}

  /// The value of a figure; empty if it has none.
  std::optional<double> value(std::string_view name) const;
  double value_or_zero(std::string_view name) const { return value(name).value_or(0); }
  std::string parameter(std::string_view key) const {
    return inputs_.parameter ? inputs_.parameter(key) : "";
  }
  /// The number at the begin of a parameter's text ("3 cycles").
  std::optional<double> number(std::string_view key) const;
  std::span<const app::StallRow> stalls() const { return inputs_.stalls; }
  std::span<const video::FrameTimes> frames() const { return inputs_.frames; }

  std::span<const FunctionClocks> functions() const { return inputs_.functions; }

  /// Clocks in which the core is awake: all but cpu.idle. 0 if not known.
  double awake() const;
  /// The core's stall causes with their clocks, largest first; none without clocks.
  std::vector<std::pair<std::string, double>> stall_causes() const;
  /// Clocks by culprit, largest first, over all causes or one of them.
  std::vector<std::pair<std::string, double>> culprits(std::string_view cause = {}) const;
  /// Time (s) of all requests of the ports whose names begin with `port`, by culprit, largest first; what
  /// they wait for one another is `own`.
  std::vector<std::pair<std::string, double>> waits_of(std::string_view port) const;
  /// Whether a load generator drives a port whose name begins with `port`.
  bool loaded(std::string_view port) const;
  /// Clocks by region of one cause, largest first, from stalls.csv.
  std::vector<std::pair<std::string, double>> regions(std::string_view cause) const;
  /// The loop remaps without waiting for the camera.
  bool remaps_in_a_row() const;
  /// Time from one displayed frame to the next; 0 if not known.
  double frame_period() const;

 private:
  const Inputs& inputs_;
};

// In the order in which explain() lists them.
void find_rate(const Run& run, std::vector<Finding>& out);
void find_budget(const Run& run, std::vector<Finding>& out);
void find_latency_parts(const Run& run, std::vector<Finding>& out);
void find_mover(const Run& run, std::vector<Finding>& out);
void find_largest_wait(const Run& run, std::vector<Finding>& out);
void find_function(const Run& run, std::vector<Finding>& out);
void find_other_masters(const Run& run, std::vector<Finding>& out);
void find_rows(const Run& run, std::vector<Finding>& out);
void find_sdram_use(const Run& run, std::vector<Finding>& out);

}  // namespace fovea::explain
