// The requests in the controller's FIFOs, and sets of them by what scheduling asks.
#pragma once
#include <array>
#include <cstdint>

#include "model/mem/core/queue_entry.h"
#include "model/mem/core/queue_positions.h"

namespace fovea::mem {

/// Words of 64 bits that a write's data occupies in the FIFO: one touched in part counts as a whole one.
inline unsigned write_words(std::uint32_t address, unsigned bytes) {
  return ((address & 7u) + bytes + 7u) >> 3;
}

/// Requests by age: position 0 is the oldest. Each has a slot that it keeps until it leaves.
///
/// A request that comes while nothing else is queued is *single*. It is kept outside the sets and totals until
/// join_single(), which a second request causes; mostly the single one leaves before that.
class CommandQueue {
 public:
  static constexpr unsigned kMost = QueuePositions::kMost;

  unsigned count() const { return count_; }
  QueueEntry& entry(unsigned position) { return slots_[order_.slot(position)]; }
  const QueueEntry& entry(unsigned position) const { return slots_[order_.slot(position)]; }
  QueueEntry& newest() { return entry(count_ - 1); }
  unsigned slot_of(const QueueEntry& e) const { return static_cast<unsigned>(&e - slots_.data()); }
  /// Sets of positions by master, bank, priority and kind.
  const QueuePositions& order() const { return order_; }
  /// Those whose row is open.
  Positions hits() const { return hits_; }
  /// Those that their master offers to the scheduler.
  Positions competing() const { return competing_; }
  void compete(Positions those) { competing_ |= those; }
  unsigned write_words_held() const { return write_words_; }

  bool single() const { return single_; }
  QueueEntry& begin_single() {
    count_ = 1;
    single_ = true;
    return slots_[0];
  }
  void end_single() {
    single_ = false;
    count_ = 0;
  }
  /// The single request becomes the first of the queue.
  void join_single(bool row_open) {
    single_ = false;
    count_ = 0;
    competing_ = 1;
    add(slots_[0], row_open);
  }

  QueueEntry& free_entry() { return slots_[oldest(free_slots_)]; }
  /// The request in this free entry joins as the newest one. @return its position
  unsigned add(QueueEntry& e, bool row_open) {
    const unsigned slot = slot_of(e), position = count_++;
    const QueuedRequest& r = e.request;
    free_slots_ ^= 1u << slot;
    order_.add(position, slot, r.master, e.bank, r.priority, r.write);
    if (row_open) hits_ |= 1u << position;
    if (r.write) write_words_ += write_words(r.address, r.bytes);
    return position;
  }
  void leave(unsigned position) {
    const QueuedRequest& r = entry(position).request;
    if (r.write) write_words_ -= write_words(r.address, r.bytes);
    free_slots_ |= 1u << order_.slot(position);
    order_.leave(position, r.priority);
    competing_ = QueuePositions::without(position, competing_);
    hits_ = QueuePositions::without(position, hits_);
    --count_;
  }

  void row_opened(unsigned bank, std::uint32_t row) {
    for (Positions set = order_.of_bank(bank); set; set &= set - 1)
      if (entry(oldest(set)).row == row) hits_ |= set & -set;
  }
  void row_closed(unsigned bank) { hits_ &= ~order_.of_bank(bank); }
  void all_rows_closed() { hits_ = 0; }
  /// True if a request other than this one is to the same row.
  bool row_wanted(const QueueEntry& by_others) const {
    if (single_) return false;
    for (unsigned i = 0; i < count_; ++i) {
      const QueueEntry& o = entry(i);
      if (&o != &by_others && o.bank == by_others.bank && o.row == by_others.row) return true;
    }
    return false;
  }

 private:
  std::array<QueueEntry, kMost> slots_;
  QueuePositions order_;
  std::uint32_t free_slots_ = (1u << kMost) - 1;
  unsigned count_ = 0;
  Positions competing_ = 0, hits_ = 0;
  unsigned write_words_ = 0;
  bool single_ = false;
};

}  // namespace fovea::mem
