// Copies of the core's counters at given times: at the edges of the measurement window, and for others
// who ask.
#pragma once
#include <algorithm>
#include <deque>
#include <functional>
#include <utility>

#include "model/common/units.h"
#include "model/cpu/core/stats.h"

namespace fovea::cpu {

class MeasurementWindow {
 public:
  /// Receives the counters; must not change anything.
  using Sample = std::function<void(const Counts&)>;
  /// Marks the start (first call) or end (second call) at time t. The second mark may be set before
  /// the first one is reached.
  void mark(Picoseconds t) {
    add({t, nullptr});
    ++edges_;
  }
  void sample(Picoseconds t, Sample f) { add({t, std::move(f)}); }
  bool pending() const { return at_ != kNever; }
  /// A mark of the window is not reached yet.
  bool edge_pending() const { return edges_ != 0; }
  Picoseconds at() const { return at_; }
  bool due(Picoseconds boundary) const { return boundary > at_; }
  /// The first of the pending marks is reached.
  void take(Counts& counts, std::uint64_t cycle) {
    const Sample f = std::move(marks_.front().second);
    marks_.pop_front();
    at_ = marks_.empty() ? kNever : marks_.front().first;
    counts.cycles = cycle;
    if (f) return f(counts);
    --edges_;
    if (first_) stats_.from = counts;
    stats_.to = counts;
    first_ = false;
  }
  const CoreStats& stats() const { return stats_; }

 private:
  using Mark = std::pair<Picoseconds, Sample>;
  /// Behind those of the same time.
  void add(Mark m) {
    const auto later = std::find_if(marks_.begin(), marks_.end(),
                                    [&](const Mark& other) { return other.first > m.first; });
    marks_.insert(later, std::move(m));
    at_ = marks_.front().first;
  }

  std::deque<Mark> marks_;  // by time
  Picoseconds at_ = kNever;  // of the first
  unsigned edges_ = 0;
  bool first_ = true;
  CoreStats stats_;
};

}  // namespace fovea::cpu
