// An up-counter whose value and next match are computed instead of simulated step by step. No
// SystemC.
#pragma once
#include <cstdint>

#include "model/common/units.h"

namespace fovea::periph {

/// Counts ticks, divided by a prescaler, up to a period. It matches when it reaches PRD and
/// restarts from 0 one count later, so a periodic timer matches every (PRD + 1) counts (SPRUH82C
/// ch. 30: the match is the interrupt). A counter that is set above PRD first runs to its maximum
/// and wraps. PRD = 0 never matches (assumed: 0 is the reset value of a timer that is not
/// programmed). In one-shot mode the counter stops at PRD (assumed).
class TimerCounter {
 public:
  /// @param bits width of the counter, 32 or 64
  explicit TimerCounter(unsigned bits) : top_(bits == 64 ? ~0ull : (1ull << bits) - 1) {}

  /// Starts at tick `now`; the first count is at tick now + prescale - phase.
  /// @param phase prescaler counts that are already done, < prescale
  void start(std::uint64_t now, bool once, std::uint64_t prescale = 1, std::uint64_t phase = 0);
  void stop(std::uint64_t now);
  bool running() const { return running_; }

  std::uint64_t value(std::uint64_t now) const;
  std::uint64_t phase(std::uint64_t now) const;  ///< prescaler counts done since the last count
  void set_value(std::uint64_t value, std::uint64_t now);
  void set_period(std::uint64_t period, std::uint64_t now);
  std::uint64_t period() const { return period_; }
  /// Tick of the first match after `now`; kNever if there is none.
  std::uint64_t next_match(std::uint64_t now) const;

 private:
  std::uint64_t counts(std::uint64_t now) const { return (now - base_tick_ + phase_) / prescale_; }
  /// A one-shot counter that starts at its period has nothing to count.
  bool already_there() const { return once_ && base_value_ == period_; }
  std::uint64_t counts_to_first_match() const;
  void rebase(std::uint64_t now);

  std::uint64_t top_;
  std::uint64_t period_ = 0;
  std::uint64_t base_value_ = 0, base_tick_ = 0, phase_ = 0, prescale_ = 1;
  bool running_ = false, once_ = false, done_ = false;
};

}  // namespace fovea::periph
