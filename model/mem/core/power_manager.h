// The SDRAM part's low-power modes: what CKE does, and for how long.
#pragma once
#include <algorithm>
#include <cstdint>

#include "model/common/units.h"
#include "model/mem/core/ddr_config.h"
#include "model/mem/core/ddr_stats.h"

namespace fovea::mem {

/// Keeps whether CKE is low, from when on it may move again, and the clocks spent in each mode. The
/// controller decides when the part falls asleep and issues the commands.
class PowerManager {
 public:
  /// `restart`: clocks from the restart of a stopped memory clock to CKE.
  PowerManager(unsigned restart, DdrStats& stats) : restart_(restart), stats_(stats) {}

  LowPower mode() const { return mode_; }
  bool asleep() const { return mode_ != LowPower::kOff; }
  /// Clock from which CKE may move again (tCKE).
  std::uint64_t cke_free() const { return cke_free_; }

  /// CKE falls at `clock`, which is at time `at`.
  void enter(LowPower mode, std::uint64_t clock, Picoseconds at, unsigned tCKE) {
    mode_ = mode;
    counted_to_ = clock;
    entered_ = at;
    cke_free_ = clock + tCKE;
    ++(refreshes_itself(mode) ? stats_.self_refreshes : stats_.power_downs);
  }
  /// Clock at which CKE rises for something that comes at `clock`.
  std::uint64_t exit_clock(std::uint64_t clock) const {
    return std::max(mode_ == LowPower::kClockStop ? clock + restart_ : clock, cke_free_);
  }
  /// CKE rises at `clock`.
  void leave(std::uint64_t clock, bool all_rows_closed, unsigned tCKE) {
    count(clock, all_rows_closed);
    mode_ = LowPower::kOff;
    cke_free_ = clock + tCKE;
  }
  /// Time at which CKE fell last.
  Picoseconds entered() const { return entered_; }
  /// From self-refresh with the memory's clock to that without, or back: the part sleeps on.
  void change(LowPower to, std::uint64_t clock) {
    count(clock, true);
    if (mode_ == LowPower::kClockStop) cke_free_ = std::max(cke_free_, clock + restart_);
    mode_ = to;
  }
  /// Counts the clocks asleep before `until` that were not counted yet.
  void count(std::uint64_t until, bool all_rows_closed) {
    if (mode_ != LowPower::kOff && until > counted_to_) count_asleep(until, all_rows_closed);
  }

 private:
  void count_asleep(std::uint64_t until, bool all_rows_closed) {
    const std::uint64_t clocks = until - counted_to_;
    counted_to_ = until;
    (refreshes_itself(mode_) ? stats_.self_refresh_clocks : stats_.power_down_clocks) += clocks;
    if (mode_ == LowPower::kClockStop) stats_.clock_stop_clocks += clocks;
    if (mode_ == LowPower::kPowerDown && !all_rows_closed)
      stats_.active_power_down_clocks += clocks;
  }

  unsigned restart_;
  DdrStats& stats_;
  LowPower mode_ = LowPower::kOff;
  std::uint64_t counted_to_ = 0, cke_free_ = 0;
  Picoseconds entered_ = 0;
};

}  // namespace fovea::mem
