// When an open row is closed though no request needs its bank.
#pragma once
#include <cstdint>

#include "model/mem/core/command_queue.h"
#include "model/mem/core/ddr_timing.h"

namespace fovea::mem {

/// A row is closed when it has been open for too long (T_RASMAX), and with some schedulers after its last
/// access if no queued request wants it.
class RowPolicy {
 public:
  static constexpr std::uint64_t kNoClock = ~std::uint64_t{0};

  void close_after_access(bool closes) { closes_ = closes; }
  bool closes_after_access() const { return closes_; }
  /// The row of this request, which has its last access now, is closed with it.
  bool closes_row_of(const QueueEntry& e, const CommandQueue& queue) const {
    return closes_ && !queue.row_wanted(e);
  }

  /// Clocks that a row may be open; 0: no limit.
  void set_limit(std::uint64_t clocks) { limit_ = clocks; }
  /// Clock at which the row that has been open longest is due; kNoClock if none ever is.
  std::uint64_t first_overdue(const DdrDevice& device) const {
    std::uint64_t first = kNoClock;
    if (limit_ == 0) return first;
    for (unsigned b = 0; b < DdrDevice::kMaxBanks; ++b)
      if (device.row(b) != DdrDevice::kClosed) first = std::min(first, device.opened(b) + limit_);
    return first;
  }
  /// The bank of that row.
  static unsigned longest_open(const DdrDevice& device) {
    unsigned bank = 0;
    std::uint64_t opened = kNoClock;
    for (unsigned b = 0; b < DdrDevice::kMaxBanks; ++b) {
      if (device.row(b) == DdrDevice::kClosed || device.opened(b) >= opened) continue;
      opened = device.opened(b);
      bank = b;
    }
    return bank;
  }

 private:
  std::uint64_t limit_ = 0;
  bool closes_ = false;
};

}  // namespace fovea::mem
