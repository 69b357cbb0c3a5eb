// The core's clock count, and for each clock why it was needed.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>

#include "model/cpu/core/bus_port.h"
#include "model/cpu/core/clock_profile.h"
#include "model/cpu/core/stats.h"

namespace fovea::cpu {

/// Time passes in the core only by a call of this class (and, within a chain of records, in the
/// handlers, which add their clocks when the chain ends).
class StallLedger {
 public:
  std::uint64_t cycle = 0;  // number of the present clock
  Counts counts;
  ClockProfile* profile = nullptr;  // is told of each stalled or idle clock; null: there is no profile
  bool bus_waited = false;  // set when the core has waited for the bus; cleared by InternalRam

  /// Names for the addresses; to be set before the first instruction.
  void set_regions(RegionMap regions) { regions_ = std::move(regions); }
  const RegionMap& regions() const { return regions_; }

  /// `n` clocks in which an instruction issues.
  void spend(unsigned n) {
    cycle += n;
    counts.issue += n;
  }
  /// The clocks up to `until`, in which the core sleeps.
  /// @param by what ends the sleep
  void sleep_to(std::uint64_t until, WakeEvent by) {
    if (profile) profile->slept(by, until - cycle);
    counts.idle += until - cycle;
    counts.idle_by[static_cast<std::size_t>(by)] += until - cycle;
    cycle = until;
  }
  /// Stalls the core for a reason without an address, with the core itself as culprit.
  void stall_to(std::uint64_t until, Cause cause) {
    if (until > cycle) {
      counts.stall[index(cause)] += until - cycle;
      if (cause != Cause::kInterlock)
        counts.stalls.add(cause, RegionMap::kNone, kCore, until - cycle);
      if (profile) [[unlikely]]
        profile->stalled(cause, RegionMap::kNone, kCore, until - cycle);
      cycle = until;
    }
  }
  /// Stalls the core for an access to a physical address. The culprit is one of kStallCulprits.
  void stall_to(std::uint64_t until, Cause cause, std::uint32_t pa, std::size_t culprit) {
    if (until > cycle) charge(until, cause, pa, culprit);
  }
  /// Stalls up to `until` for access `a`, which completed at `outcome` (clock `bus` of the core).
  /// The clocks up to `bus` are attributed in proportion to what the access waited for, even if the
  /// core began to wait later; the clocks after it are attributed to the core itself.
  [[gnu::always_inline]] void stall_on(const BusAccess& a, Picoseconds outcome, std::uint64_t bus,
                                       std::uint64_t until, Cause cause) {
    if (until <= cycle) return;
    bus_waited = true;
    const std::uint8_t region = regions_.find(a.address);
    const std::uint64_t end = std::max(cycle, std::min(bus, until));
    counts.stalls.split(cause, region, end - cycle, a.parts, outcome - a.issued, until - end);
    if (profile) [[unlikely]]
      profile->stalled(cause, region, a, end - cycle, outcome - a.issued, until - end);
    counts.stall[index(cause)] += until - cycle;
    cycle = until;
  }

 private:
  [[gnu::noinline]] void charge(std::uint64_t until, Cause cause, std::uint32_t pa,
                                std::size_t culprit) {
    counts.stall[index(cause)] += until - cycle;
    const std::uint8_t region = regions_.find(pa);
    counts.stalls.add(cause, region, culprit, until - cycle);
    if (profile) [[unlikely]]
      profile->stalled(cause, region, culprit, until - cycle);
    cycle = until;
  }

  RegionMap regions_;
};

}  // namespace fovea::cpu
