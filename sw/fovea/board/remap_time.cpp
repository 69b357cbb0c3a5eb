#include "sw/fovea/board/remap_time.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "sw/fovea/results/names.h"
#include "sw/fovea/results/sleep.h"

namespace fovea::app {
namespace {

/// How far the core may be past a write to the pins when they change: it waits for what its writes to
/// registers do, so this is more than enough. From an event in its future on, its counters are the same
/// in strict and in default mode.
constexpr Picoseconds kAhead = kPsPerUs;

}  // namespace

RemapTime::RemapTime(board::Board& board) : board_(board) {
  pins_ = board.dm365.gpio.observe_outputs([this](unsigned bank, std::uint32_t out, Picoseconds) {
    if (bank != PHASE_BANK) return;
    const board::Phase phase = board::phase_of(out);
    if (phase == board::Phase::kRemapStart) reached(true);
    if (phase == board::Phase::kRemapEnd) reached(false);
    if (phase == board::Phase::kReset || phase == board::Phase::kBoot) {
      begun_.reset();
      given_away(kernel_time(), false);
    }
  });
}

void RemapTime::reached(bool begins) {
  const Picoseconds at = kernel_time() + kAhead;
  if (!begins) ending_ = at;
  board_.dm365.end_of_instant.at(at, InstantRank::kObservers, [this, begins, at] {
    given_away(at, begins);
    board_.dm365.arm.core().sample_counts(
        at, [this, begins](const cpu::Counts& counts) { sampled(begins, of(counts)); });
  });
}

/// A profile tells apart which sleeps are within remaps, from the same instants on.
void RemapTime::given_away(Picoseconds at, bool begins) {
  cpu::Core& core = board_.dm365.arm.core();
  if (core.profile()) core.mark_given_away(at, begins);
}

RemapTime::Clocks RemapTime::of(const cpu::Counts& counts) {
  return {counts.cycles, counts.issue, counts.idle, counts.stall, counts.idle_by};
}

void RemapTime::add(Clocks& sum, const Clocks& from, const Clocks& to) {
  sum.cycles += to.cycles - from.cycles;
  sum.issue += to.issue - from.issue;
  sum.idle += to.idle - from.idle;
  for (std::size_t k = 0; k < cpu::kCauses; ++k) sum.stall[k] += to.stall[k] - from.stall[k];
  for (std::size_t k = 0; k < cpu::kWakeEvents; ++k) sum.idle_by[k] += to.idle_by[k] - from.idle_by[k];
}

void RemapTime::sampled(bool begins, const Clocks& at) {
  const cpu::CoreStats& window = board_.dm365.arm.core().window_stats();
  const bool open = board_.window_open();
  if (!begins) ending_.reset();
  if (begins) {
    if (open || !board_.window_end()) begun_ = at;
    return;
  }
  if (!begun_) return;
  // A remap that reaches over the window's end is left to collect().
  if (board_.window_end() && at.cycles > window.to.cycles) return;
  const Clocks opened = of(window.from);
  if (board_.window_start() && at.cycles > opened.cycles)
    add(sum_, begun_->cycles < opened.cycles ? opened : *begun_, at);
  begun_.reset();
}

void RemapTime::collect(const cpu::Counts& from, const cpu::Counts& to,
                        std::vector<StatRow>& rows) const {
  Clocks all = sum_;
  Clocks end = of(to);
  // A core that has gone to sleep, and does not wake up any more, comes to no copy.
  const auto& arm = board_.dm365.arm;
  if (ending_ && arm.asleep())
    if (const Clocks asleep = of(arm.core().counts_asleep(*ending_)); asleep.cycles < end.cycles) end = asleep;
  if (begun_ && begun_->cycles < end.cycles)
    add(all, begun_->cycles < from.cycles ? of(from) : *begun_, end);
  Clocks rest;
  add(rest, of(from), of(to));
  std::uint64_t spare = rest.idle - all.idle;
  for (const cpu::WakeInfo& info : cpu::kWakeTable)
    if (!is_idle(std::string("idle.") + info.name)) {
      const auto k = static_cast<std::size_t>(info.event);
      spare -= rest.idle_by[k] - all.idle_by[k];
    }
  rows.push_back({names::kCpuSpare, spare, "cycles",
                  "clocks of cpu.idle in which the program has nothing to do: without the sleeps within remaps, and "
                  "without those that the EDMA or the remap engine ended"});
  if (all.cycles == 0) return;
  const auto row = [&](const std::string& name, std::uint64_t clocks, const std::string& sentence) {
    rows.push_back({"cpu.remap." + name, clocks, "cycles", sentence});
  };
  row("cycles", all.cycles, "core clocks during remaps");
  row("issue", all.issue, "clocks during remaps in which instructions issue");
  row("idle", all.idle, "clocks during remaps in wait-for-interrupt");
  for (std::size_t k = 0; k < cpu::kWakeEvents; ++k)
    row(std::string("idle.") + cpu::kWakeTable[k].name, all.idle_by[k],
        std::string("clocks of cpu.remap.idle that ended with an interrupt of the ") +
            cpu::kWakeTable[k].blocks);
  for (const cpu::CauseInfo& info : cpu::kCauseTable)
    row("stall." + std::string(info.name), all.stall[index(info.cause)],
        "during remaps: " + std::string(info.sentence));
}

}  // namespace fovea::app
