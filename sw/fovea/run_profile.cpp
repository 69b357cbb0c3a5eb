#include "sw/fovea/run_profile.h"

namespace fovea::app {

RunProfile::RunProfile(board::Board& board, bool whole_run)
    : board_(board), core_(board.dm365.arm.core()), whole_run_(whole_run) {
  core_.start_profile();
  if (!whole_run)
    board.on_phase = [this](board::Phase p, Picoseconds at) { phase(p, at); };
}

/// A phase is entered once: after the look-up table the firmware is idle between frames too.
void RunProfile::phase(board::Phase phase, Picoseconds at) {
  const Section next = phase == board::Phase::kLut ? kLut : phase == board::Phase::kIdle ? kLock : kBoot;
  if (next <= reached_) return;
  reached_ = next;
  core_.mark_section(at, next);
}

void RunProfile::window(bool open) {
  if (whole_run_ && open) return;
  reached_ = open ? kFrames : kAfter;
  core_.mark_section(kernel_time(), reached_);
}

ProfileData RunProfile::finish(const cpu::Counts& end, const std::string& program) {
  core_.finish_profile(end);
  ProfileData data;
  data.program = program;
  data.regions = core_.regions().names();
  const cpu::ClockProfile& p = *core_.profile();
  if (whole_run_) {
    data.phases = {{"run", true, p.rows(kBoot)}};
    return data;
  }
  const bool opened = reached_ >= kFrames;
  data.phases = {{"boot", !opened, p.rows(kBoot)},
                 {"lut", !opened, p.rows(kLut)},
                 {"lock", !opened, p.rows(kLock)},
                 {"frames", true, p.rows(kFrames)}};
  return data;
}

}  // namespace fovea::app
