// `--profile` of a run on the board: the phases of the run, and what its profile says.
#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "model/board/board.h"
#include "sw/fovea/program/elf_image.h"
#include "sw/fovea/tools/frame_parts.h"
#include "sw/fovea/tools/profile_report.h"

namespace fovea::app {

/// Puts what a core's profile counted of call stacks into `data`.
void add_stacks(ProfileData& data, const cpu::CallStacks& stacks);

/// Phases are those that the firmware shows on its pins, up to the measured window. Of this, the remaps are the phase
/// `remap` and the rest is `frames`. If the window is the whole run, that is one phase, `run`.
class RunProfile {
 public:
  /// Before the first instruction. @param whole_run the window is the whole run
  /// @param programs whose functions are known; null: none
  RunProfile(board::Board& board, bool whole_run, std::span<const ElfImage* const> programs);
  /// The window begins or ends now; as Core::mark_window().
  void window(bool open);
  /// A frame of the window was displayed.
  void frame(const video::FrameTimes& times) { frames_.push_back(times); }
  /// @param end the core's counters at the end of the window, or at the end of the run
  ProfileData finish(const cpu::Counts& end, const std::string& program);
  /// After finish().
  std::string frame_parts() const { return frame_parts_csv(frames_, remaps_); }

 private:
  enum Section : std::size_t { kBoot, kLut, kLock, kFrames, kAfter, kRemap };
  void phase(board::Phase phase, Picoseconds at);
  void interrupt(std::uint64_t cycle);

  board::Board& board_;
  cpu::Core& core_;
  Subscription interrupts_, phases_;
  bool whole_run_;
  Section reached_ = kBoot;
  bool opened_ = false;  // the window
  bool remaps_now_ = false;
  std::map<std::string, std::vector<Picoseconds>> delays_;  // by source of the interrupt
  std::vector<video::FrameTimes> frames_;
  std::map<Picoseconds, cpu::ClockProfile::Snapshot> remaps_;
};

}  // namespace fovea::app
