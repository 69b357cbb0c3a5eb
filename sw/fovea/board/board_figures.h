// The figures of a run on the board: those of its measured window, and what they cost the host.
#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/board/board.h"
#include "sw/fovea/board/remap_time.h"
#include "sw/fovea/machine/host_instructions.h"
#include "sw/fovea/machine/machine.h"

namespace fovea::app {

inline double to_s(Picoseconds ps) { return static_cast<double>(ps) * 1e-12; }
inline StatRow row(std::string name, StatBase::Value value, std::string unit, std::string sentence) {
  return {std::move(name), value, std::move(unit), std::move(sentence)};
}

/// To be constructed before the simulation starts, and to live as long as the board runs.
class BoardFigures {
 public:
  BoardFigures(board::Board& board, const board::BoardParams& params);

  /// The window begins or ends at the present time; a second end is ignored.
  void open_window();
  void close_window();
  bool opened() const { return opened_; }
  bool closed() const { return closed_; }
  /// True if the window was closed and the core's part of it is known: the core has come to its next
  /// instruction boundary, or sleeps and may not wake up any more.
  bool core_done() const;
  /// True if the core slept when the window was closed.
  bool asleep_at_end() const { return asleep_at_end_.has_value(); }

  /// Puts statistics, latencies, stalls and timeline into `result`, after the simulation.
  /// @return the core's counters at the window's end
  cpu::Counts collect(Result& result);
  /// What goes into host.json, after collect().
  void add_host(Result& result, double wall_seconds, bool strict) const;

 private:
  using Wall = std::chrono::steady_clock;
  void add_frame_stats(std::vector<StatRow>& rows) const;
  cpu::Counts collect_core(Result& result) const;

  board::Board& board_;
  const board::BoardParams& params_;
  RemapTime remaps_;
  std::vector<StatRow> stats_;
  std::vector<LatencyRow> latency_;
  std::vector<SlowestRow> slowest_;
  Wall::time_point window_wall_ = Wall::now();
  double window_wall_s_ = 0;
  HostInstructions host_instructions_;
  std::optional<std::uint64_t> host_at_open_, host_in_window_;
  std::uint64_t direct_at_open_ = 0, queued_at_open_ = 0;
  std::uint64_t direct_ = 0, queued_ = 0;
  bool opened_ = false, closed_ = false;
  std::optional<cpu::Counts> asleep_at_end_;  // of a core that may not wake up any more
};

/// Hands over the rows of the timeline that are final, to a request that wants them as they come.
void take_timeline(board::Board& board, const Request& request);

}  // namespace fovea::app
