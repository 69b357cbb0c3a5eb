// The measurement window: copies of the core's counters at its start and its end.
#pragma once
#include "model/common/units.h"
#include "model/cpu/core/stats.h"

namespace fovea::cpu {

class MeasurementWindow {
 public:
  /// Marks the start (first call) or end (second call) at time t. The second mark may be set before
  /// the first one is reached.
  void mark(Picoseconds t) {
    (pending_ ? next_ : at_) = t;
    pending_ = true;
  }
  bool pending() const { return pending_; }
  Picoseconds at() const { return at_; }
  bool due(Picoseconds boundary) const { return pending_ && boundary > at_; }
  /// The pending mark is reached.
  void take(Counts& counts, std::uint64_t cycle) {
    pending_ = next_ != kNever;
    at_ = next_;
    next_ = kNever;
    counts.cycles = cycle;
    if (first_) stats_.from = counts;
    stats_.to = counts;
    first_ = false;
  }
  const CoreStats& stats() const { return stats_; }

 private:
  bool pending_ = false, first_ = true;
  Picoseconds at_ = 0, next_ = kNever;
  CoreStats stats_;
};

}  // namespace fovea::cpu
