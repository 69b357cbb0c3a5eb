#include "sw/fovea/probes/run_profile.h"

#include <algorithm>
#include <utility>

namespace fovea::app {

void add_stacks(ProfileData& data, const cpu::CallStacks& stacks) {
  data.stacks = stacks.paths();
  for (const auto& c : stacks.calls()) data.calls.push_back({c.from, c.to, c.count, c.clocks});
  data.ranges = stacks.ranges();
}

RunProfile::RunProfile(board::Board& board, bool whole_run,
                       std::span<const ElfImage* const> programs)
    : board_(board), core_(board.dm365.arm.core()), whole_run_(whole_run) {
  cpu::ClockProfile& profile = core_.start_profile();
  profile.stacks.set_functions(program_functions(programs));
  if (whole_run) profile.count_stacks_of({kBoot});
  else profile.count_stacks_of({kFrames, kRemap});
  interrupts_ = profile.observe_interrupts([this](bool, std::uint64_t cycle) { interrupt(cycle); });
  phases_ = board.observe_phases([this](board::Phase p, Picoseconds at) { phase(p, at); });
}

/// Until the window opens; a reset begins with the first phase again.
void RunProfile::phase(board::Phase phase, Picoseconds at) {
  if (phase == board::Phase::kRemapStart || phase == board::Phase::kRemapEnd) {
    core_.mark_snapshot(at);
    remaps_now_ = phase == board::Phase::kRemapStart;
    if (!whole_run_ && reached_ == kFrames) core_.mark_section(at, remaps_now_ ? kRemap : kFrames);
  }
  if (whole_run_ || reached_ >= kFrames) return;
  Section next;
  switch (phase) {
    case board::Phase::kReset:
    case board::Phase::kBoot: next = kBoot; break;
    case board::Phase::kLut: next = kLut; break;
    case board::Phase::kIdle: next = kLock; break;
    default: return;
  }
  if (next == reached_) return;
  reached_ = next;
  core_.mark_section(at, next);
}

/// The controller may be ahead of the core, which is at its boundary, or behind it: the interrupt is for the
/// most urgent input of those that were latched when the handler begins.
void RunProfile::interrupt(std::uint64_t cycle) {
  if (!std::as_const(core_).profile()->counts_stacks()) return;
  const Picoseconds begun = core_.time(cycle);
  board_.dm365.end_of_instant.at(std::max(begun, kernel_time()), InstantRank::kObservers, [this, begun] {
    const periph::Aintc& aintc = board_.dm365.aintc;
    std::uint64_t latched = 0;
    for (unsigned n = 0; n < periph::kInterruptCount; ++n)
      if (aintc.latched_at(n) <= begun) latched |= std::uint64_t{1} << n;
    const auto input = aintc.core().most_urgent(latched);
    if (!input) return;
    delays_[board_.dm365.interrupt_source(*input).name].push_back(begun - aintc.latched_at(*input));
  });
}

void RunProfile::window(bool open) {
  if (whole_run_ && open) return;
  opened_ = opened_ || open;
  reached_ = open ? kFrames : kAfter;
  core_.mark_section(kernel_time(), open && remaps_now_ ? kRemap : reached_);
}

ProfileData RunProfile::finish(const cpu::Counts& end, const std::string& program) {
  core_.finish_profile(end);
  ProfileData data;
  data.program = program;
  data.regions = core_.regions().names();
  const cpu::ClockProfile& p = *core_.profile();
  add_stacks(data, p.stacks);
  data.masked = p.mask.longest();
  data.interrupts = delays_;
  for (const auto& s : p.snapshots()) remaps_[s.at] = s;
  if (whole_run_) {
    data.phases = {{"run", true, p.rows(kBoot), p.stacks.paths_of(kBoot)}};
    return data;
  }
  const bool opened = opened_;
  data.phases = {{"boot", !opened, p.rows(kBoot), p.stacks.paths_of(kBoot)},
                 {"lut", !opened, p.rows(kLut), p.stacks.paths_of(kLut)},
                 {"lock", !opened, p.rows(kLock), p.stacks.paths_of(kLock)},
                 {"frames", true, p.rows(kFrames), p.stacks.paths_of(kFrames)},
                 {"remap", true, p.rows(kRemap), p.stacks.paths_of(kRemap)}};
  return data;
}

}  // namespace fovea::app
