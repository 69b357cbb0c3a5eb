// How many refreshes of the SDRAM are owed, and how urgent they are.
#pragma once
#include <cstdint>

#include "model/common/check.h"
#include "model/mem/core/ddr_stats.h"

namespace fovea::mem {

/// Counts the refresh intervals that end and the refreshes that are issued. The level of the backlog
/// decides what a refresh goes before; the controller issues the commands.
///
/// Once a refresh has closed the banks (PREA), its REF follows before anything else. Otherwise requests
/// that come between the two would reopen their rows and find them closed again at the next idle clock,
/// and a read that ranks first only while all rows are closed and one that does only while its row is open
/// could take turns in putting it off.
class RefreshManager {
 public:
  static constexpr std::uint64_t kNoClock = ~std::uint64_t{0};
  /// What a refresh goes before: nothing, writes, everything.
  enum class Urgency { kMay, kNeed, kMust };
  /// Levels of the backlog, in refreshes. `gap`: intervals without a refresh above which four are
  /// issued before anything else.
  struct Levels {
    unsigned release, need, must, gap;
  };
  RefreshManager(const Levels& levels, DdrStats& stats, const DiagnosticsRef& diagnostics)
      : levels_(levels), stats_(stats), diagnostics_(diagnostics) {}

  /// Length of an interval in clocks; 0: no refresh. Another length starts to count at `now`.
  void set_interval(unsigned clocks, std::uint64_t now);
  std::uint64_t interval() const { return interval_; }
  /// Clock at which the present interval ends; kNoClock without refresh.
  std::uint64_t next_expiry() const { return next_expiry_; }
  unsigned owed() const { return owed_; }
  /// PREA was issued, or all rows are closed since a self-refresh; REF was not yet.
  bool cycle_begun() const { return cycle_begun_; }
  /// A refresh goes before something now, whatever the clock.
  bool urgent() const { return urgent_; }
  Urgency urgency() const { return urgency_; }
  /// The same at an edge by which more intervals may have ended.
  Urgency urgency(std::uint64_t edge) const {
    return edge < next_expiry_ ? urgency_ : urgency_after(edge);
  }

  /// Counts the intervals that end at or before `clock`; only if next_expiry() is not after it.
  void count_expired(std::uint64_t clock);
  /// A refresh cycle begins while requests wait. After too long a gap it is the first of four.
  void begin_cycle();
  /// The same while none waits.
  void begin_idle_cycle();
  /// A REF was issued.
  void refreshed();
  /// So many intervals passed in which the refresh came as soon as it was owed.
  void pass_over(std::uint64_t intervals);
  /// The part refreshed itself until `clock`: nothing is owed, and a new interval begins (assumed).
  void restart(std::uint64_t clock);

 private:
  Urgency urgency_after(std::uint64_t edge) const;
  void update();

  Levels levels_;
  DdrStats& stats_;
  std::uint64_t interval_ = 0;
  std::uint64_t next_expiry_ = 0;
  unsigned owed_ = 0;
  unsigned forced_ = 0;           // still to come of four in a row
  unsigned gap_ = 0;              // intervals that ended since the last REF
  bool cycle_begun_ = false;
  bool catching_up_ = false;      // the backlog was above `must` and is not down to `release` yet
  bool urgent_ = false;
  Urgency urgency_ = Urgency::kMay;  // before next_expiry_
  DiagnosticsRef diagnostics_;
};

}  // namespace fovea::mem
