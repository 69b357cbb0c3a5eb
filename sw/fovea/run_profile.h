// `--profile` of a run on the board: the phases of the run, and what its profile says.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "model/board/board.h"
#include "sw/fovea/elf_image.h"
#include "sw/fovea/profile_report.h"

namespace fovea::app {

/// Phases are those that the firmware shows on its pins, up to the measured window, which is the phase
/// `frames`. If the window is the whole run, that is one phase, `run`.
class RunProfile {
 public:
  /// Before the first instruction. @param whole_run the window is the whole run
  RunProfile(board::Board& board, bool whole_run);
  /// The window begins or ends now; as Core::mark_window().
  void window(bool open);
  /// @param end the core's counters at the end of the window, or at the end of the run
  ProfileData finish(const cpu::Counts& end, const std::string& program);

 private:
  enum Section : std::size_t { kBoot, kLut, kLock, kFrames, kAfter };
  void phase(board::Phase phase, Picoseconds at);

  board::Board& board_;
  cpu::Core& core_;
  bool whole_run_;
  Section reached_ = kBoot;
};

}  // namespace fovea::app
