// Monitors a board for the conditions of `run.until` and the limits of a run.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/board/board.h"
#include "model/common/observers.h"
#include "model/cpu/core/debug_control.h"
#include "sw/fovea/config/run_until.h"

namespace fovea::app {

class RunEnd {
 public:
  /// To be constructed before the simulation starts.
  RunEnd(board::Board& board, cpu::DebugMemory& memory, std::vector<EndCondition> conditions);

  bool wants(EndCondition::Kind kind) const;
  /// True if run.frames is the only condition.
  bool only_frames() const { return conditions_.size() == 1 && wants(EndCondition::Kind::kFrames); }

  /// What has ended the run: the first condition that was met, or a limit.
  struct Met {
    std::string what;     ///< the condition as written by the user, or the option of the limit
    bool limit = false;
    Picoseconds at = 0;
    std::uint32_t pc = 0;
  };
  const std::optional<Met>& met() const { return met_; }
  /// True if the core has stopped because of it, so that no further simulated time passes.
  bool core_ended() const { return core_ended_; }

  // To be called by the code that detects these conditions.
  /// To be called on the core's thread; the core stops.
  void program_exited();
  void limit(const std::string& option) { end(option, true, kernel_time()); }

 private:
  void meet(EndCondition::Kind kind);
  void end(const std::string& what, bool limit, Picoseconds at);
  void check_for_halt();
  bool halted();
  void uart_sent();

  board::Board& board_;
  std::vector<EndCondition> conditions_;
  cpu::CoreDebug debug_;
  std::optional<cpu::CoreControl> control_;  // used for kPc
  std::optional<Met> met_;
  bool core_ended_ = false;
  std::optional<std::uint32_t> halted_at_;
  Subscription uart_, reset_;
};

}  // namespace fovea::app
