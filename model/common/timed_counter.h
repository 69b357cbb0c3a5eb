// A statistic of a block that works ahead of the kernel.
#pragma once
#include <cstdint>
#include <deque>

#include "model/common/stats.h"
#include "model/common/timer.h"

namespace fovea {

/// Counts events that each have a time of their own, which may lie ahead of the kernel's: an event is part
/// of the count, and of the measurement window, from that time on.
class TimedCounter : public StatBase {
 public:
  using StatBase::StatBase;
  /// @param at not before that of an earlier call
  void add(Picoseconds at, std::uint64_t n) {
    if (!ahead_.empty()) settle();
    ahead_.push_back({at, n});
  }
  std::uint64_t count() const {
    settle();
    return count_;
  }
  Value value() const override { return count(); }
  void reset() override {
    settle();
    count_ = 0;
  }
  /// For a reset of the block: the events that lie ahead will not happen.
  void drop_ahead() {
    settle();
    ahead_.clear();
  }

 private:
  struct Event {
    Picoseconds at;
    std::uint64_t n;
  };
  void settle() const {
    for (const Picoseconds now = now_(); !ahead_.empty() && ahead_.front().at <= now; ahead_.pop_front())
      count_ += ahead_.front().n;
  }
  KernelNow now_;
  mutable std::uint64_t count_ = 0;
  mutable std::deque<Event> ahead_;
};

}  // namespace fovea
