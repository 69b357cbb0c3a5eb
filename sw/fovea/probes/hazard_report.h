// `--hazards`: the coherency checker of core and DMA on a board, its warnings and its statistics.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/cpu/check/hazard_checker.h"
#include "model/memsys/memory_system.h"
#include "sw/fovea/program/symbols.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::app {

/// The sentence about a hazard, complete in itself; times are since power-up.
std::string hazard_text(const cpu::Hazard& hazard, const Symbols& symbols);

/// Checks from its construction to its end, and warns about each place once: the Diagnostics that were
/// current when it was constructed.
class HazardReport {
 public:
  /// All three outlive it.
  HazardReport(cpu::Core& core, memsys::MemorySystem& memory, const Symbols& symbols);
  HazardReport(const HazardReport&) = delete;
  HazardReport& operator=(const HazardReport&) = delete;

  /// Counts and reports what has happened up to `now`; see HazardChecker::settle().
  void settle(Picoseconds now) { checker_.settle(now); }
  /// Appends `hazard.*`. They cover the whole run, not only the measured window.
  void collect(std::vector<StatRow>& rows) const;
  /// What a run with --strict fails with; empty if there was no hazard.
  std::string failure() const;

 private:
  void command(mem::Cmd cmd);
  memsys::MemorySystem& memory_;
  cpu::HazardChecker checker_;
  Subscription arrivals_, commands_;
};

}  // namespace fovea::app
