// `frfcfs`: a master's requests pass each other, and its reads still end in the order of issue.
#include <algorithm>

#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {

/// True if the request must stay behind one of these older ones of its master: one of the two
/// writes to the 64-byte block of the other.
bool DdrController::bound_by(const Entry& younger, Places older) const {
  const Queued& r = younger.request;
  for (; older; older &= older - 1) {
    const Queued& o = entry(oldest(older)).request;
    if ((r.write || o.write) && o.address >> 6 == r.address >> 6) return true;
  }
  return false;
}

/// All that a master may offer, after one of its requests has left.
[[gnu::noinline]] void DdrController::offer_all(Places of_one_master) {
  for (Places rest = of_one_master & ~offered_; rest; rest &= rest - 1) {
    const Places bit = rest & -rest;
    if (!bound_by(entry(oldest(rest)), of_one_master & (bit - 1))) offered_ |= bit;
  }
}

/// A read has its first column. Its outcome is told when its master's older reads have theirs, and
/// then the younger ones that waited for it alone.
[[gnu::noinline]] void DdrController::tell_in_order(const Entry& e, const ReadLane::Span& on_lane) {
  const Queued& r = e.request;
  Held mine{r, 0, on_lane.first, 0, read_waited_};
  const Clock& bus = lane_.left_out() ? ddr_ : scr_;
  mine.edges = bus.edge_at_or_after(on_lane.last) - bus.edge_at_or_after(on_lane.first);
  Places older = places_.of_master(r.master) & ~places_.writes() & ((1u << choice_.place) - 1);
  for (; older; older &= older - 1) mine.behind |= 1u << places_.slot(oldest(older));
  // A read that waits for this one is younger; the others of this master that wait are older.
  const std::uint32_t slot = 1u << (&e - slots_.data());
  const auto younger =
      std::find_if(held_.begin(), held_.end(), [&](const Held& h) { return h.behind & slot; });
  for (auto h = younger; h != held_.end(); ++h) h->behind &= ~slot;
  held_.insert(younger, mine);
  for (;;) {
    const auto due =
        std::find_if(held_.begin(), held_.end(), [](const Held& h) { return h.behind == 0; });
    if (due == held_.end()) return;
    const Held h = *due;
    held_.erase(due);
    tell(h);
  }
}

/// From the buffer a word an edge, behind what its master was told of before; that wait is its own.
void DdrController::tell(const Held& h) {
  const Queued& r = h.request;
  Picoseconds& told = told_[index(r.master)];
  const Clock& bus = lane_.left_out() ? ddr_ : scr_;
  const Picoseconds first = std::max(h.first, bus.next_edge_after(told));
  told = bus.edge(bus.edge_at_or_after(first) + h.edges);
  if (first > h.first) charge(r, culprit(r.master), first - h.first);
  read_waited_ = h.waited + (first - h.first);
  report_read(r.origin, first, told);
}

/// The newest read held of those younger than the queue's read in this slot; null: none.
const MemRequest* DdrController::newest_held(unsigned behind_slot) const {
  const auto newest = std::find_if(held_.rbegin(), held_.rend(),
                                   [&](const Held& h) { return h.behind >> behind_slot & 1u; });
  return newest == held_.rend() ? nullptr : newest->request.origin;
}

}  // namespace fovea::mem
