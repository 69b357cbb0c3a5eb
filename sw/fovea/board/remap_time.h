// What the core's clocks were spent on while it remapped frames.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/board/board.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::app {

/// Watches the pins that show the firmware's phases, and copies the core's counters a microsecond after
/// each beginning and each end of a remap. To be constructed before the simulation starts, and to live as
/// long as the board runs.
class RemapTime {
 public:
  explicit RemapTime(board::Board& board);
  RemapTime(const RemapTime&) = delete;
  RemapTime& operator=(const RemapTime&) = delete;

  /// `cpu.remap.*`: the core's clocks within both remaps and window, by what they were spent on; all
  /// together are `cpu.remap.cycles`. No such rows if there are none. And `cpu.spare`. `from`, `to`: the
  /// core's counters at the window's edges.
  void collect(const cpu::Counts& from, const cpu::Counts& to, std::vector<StatRow>& rows) const;

 private:
  struct Clocks {
    std::uint64_t cycles = 0, issue = 0, idle = 0;
    std::array<std::uint64_t, cpu::kCauses> stall{};
    std::array<std::uint64_t, cpu::kWakeEvents> idle_by{};  // by what ended the sleep; adds up to idle
  };
  static Clocks of(const cpu::Counts& counts);
  static void add(Clocks& sum, const Clocks& from, const Clocks& to);
  void reached(bool begins);
  void given_away(Picoseconds at, bool begins);
  void sampled(bool begins, const Clocks& at);

  board::Board& board_;
  std::optional<Clocks> begun_;  // a remap is under way
  std::optional<Picoseconds> ending_;  // when the counters are to be copied at its end
  Clocks sum_;                   // of those that ended
  Subscription pins_;
};

}  // namespace fovea::app
