#include "model/periph/core/timer_counter.h"

namespace fovea::periph {

void TimerCounter::start(std::uint64_t now, bool once, std::uint64_t prescale,
                         std::uint64_t phase) {
  base_value_ = value(now);
  base_tick_ = now;
  phase_ = phase;
  prescale_ = prescale;
  once_ = once;
  running_ = true;
  done_ = false;
}

void TimerCounter::stop(std::uint64_t now) {
  rebase(now);
  running_ = false;
}

std::uint64_t TimerCounter::counts_to_first_match() const {
  if (base_value_ <= period_) return period_ - base_value_;  // 0: it is there, and continues from 0
  return (top_ - base_value_) + 1 + period_;
}

std::uint64_t TimerCounter::value(std::uint64_t now) const {
  if (!running_ || done_) return base_value_;
  const std::uint64_t n = counts(now);
  if (period_ == 0) return (base_value_ + n) & top_;
  if (already_there()) return base_value_;
  const std::uint64_t first = counts_to_first_match();
  if (n < first) return (base_value_ + n) & top_;
  if (once_) return period_;
  const std::uint64_t beyond = n - first;
  if (period_ == ~0ull) return period_ + beyond;  // wraps by itself
  const std::uint64_t m = beyond % (period_ + 1);
  return m == 0 ? period_ : m - 1;
}

std::uint64_t TimerCounter::phase(std::uint64_t now) const {
  return running_ ? (now - base_tick_ + phase_) % prescale_ : phase_;
}

void TimerCounter::rebase(std::uint64_t now) {
  if (!running_) return;
  const std::uint64_t v = value(now);
  const std::uint64_t p = phase(now);
  done_ = done_ || (once_ && v == period_ && period_ != 0);
  base_value_ = v;
  phase_ = p;
  base_tick_ = now;
}

void TimerCounter::set_value(std::uint64_t value, std::uint64_t now) {
  rebase(now);
  base_value_ = value & top_;
}

void TimerCounter::set_period(std::uint64_t period, std::uint64_t now) {
  rebase(now);
  period_ = period & top_;
}

std::uint64_t TimerCounter::next_match(std::uint64_t now) const {
  if (!running_ || done_ || period_ == 0) return kNever;
  if (already_there()) return kNever;
  const std::uint64_t first = counts_to_first_match();
  const std::uint64_t n = counts(now);
  std::uint64_t match = first;
  if (n >= first) {
    if (once_) return kNever;
    if (period_ == ~0ull) return kNever;  // later than the end of any run
    match = first + ((n - first) / (period_ + 1) + 1) * (period_ + 1);
  }
  if (match > (1ull << 62) / prescale_) return kNever;  // later than the end of any run; keeps
                                                        // products within 64 bits
  return base_tick_ + match * prescale_ - phase_;
}

}  // namespace fovea::periph
