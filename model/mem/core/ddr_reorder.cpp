// `frfcfs`: a master's requests pass each other, and its reads still end in the order of issue.
#include <algorithm>

#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {

/// True if the request must stay behind one of these older ones of its master: one of the two
/// writes to the 64-byte block of the other.
bool DdrController::bound_by(const Entry& younger, Positions older) const {
  const Queued& r = younger.request;
  for (; older; older &= older - 1) {
    const Queued& o = entry(oldest(older)).request;
    if ((r.write || o.write) && o.address >> 6 == r.address >> 6) return true;
  }
  return false;
}

/// All that a master may offer, after one of its requests has left.
[[gnu::noinline]] void DdrController::offer_all(Positions of_one_master) {
  for (Positions rest = of_one_master & ~offered_; rest; rest &= rest - 1) {
    const Positions bit = rest & -rest;
    if (!bound_by(entry(oldest(rest)), of_one_master & (bit - 1))) offered_ |= bit;
  }
}

/// A read has its first column command. Its outcome is reported when its master's older reads have
/// theirs; then follow the younger ones that waited only for this one.
[[gnu::noinline]] void DdrController::report_in_order(const Entry& e, const ReturnChannel::Span& transfer) {
  const Queued& r = e.request;
  OutOfOrderRead mine{r, 0, transfer.first, 0, attribution_.waited};
  const Clock& bus = return_channel_.left_out() ? ddr_ : scr_;
  mine.edges = bus.edge_at_or_after(transfer.last) - bus.edge_at_or_after(transfer.first);
  Positions older = queue_.of_master(r.master) & ~queue_.writes() & ((1u << choice_.position) - 1);
  for (; older; older &= older - 1) mine.behind |= 1u << queue_.slot(oldest(older));
  // A read that waits for this one is younger; the others of this master that wait are older.
  const std::uint32_t slot = 1u << (&e - slots_.data());
  const auto younger =
      std::find_if(out_of_order_.begin(), out_of_order_.end(), [&](const OutOfOrderRead& h) { return h.behind & slot; });
  for (auto h = younger; h != out_of_order_.end(); ++h) h->behind &= ~slot;
  out_of_order_.insert(younger, mine);
  for (;;) {
    const auto due =
        std::find_if(out_of_order_.begin(), out_of_order_.end(), [](const OutOfOrderRead& h) { return h.behind == 0; });
    if (due == out_of_order_.end()) return;
    const OutOfOrderRead h = *due;
    out_of_order_.erase(due);
    report_out_of_order(h);
  }
}

/// The data leave the buffer one word an edge, behind those reported to the master before; that wait
/// counts as the master's own.
void DdrController::report_out_of_order(const OutOfOrderRead& h) {
  const Queued& r = h.request;
  Picoseconds& reported = reported_until_[index(r.master)];
  const Clock& bus = return_channel_.left_out() ? ddr_ : scr_;
  const Picoseconds first = std::max(h.first, bus.next_edge_after(reported));
  reported = bus.edge(bus.edge_at_or_after(first) + h.edges);
  if (first > h.first) attribution_.charge(r, culprit(r.master), first - h.first);
  attribution_.waited = h.waited + (first - h.first);
  report_read(r.origin, first, reported);
}

/// The newest of the out-of-order reads that wait for the queue's read in this slot; null: none.
const MemRequest* DdrController::newest_out_of_order(unsigned behind_slot) const {
  const auto newest = std::find_if(out_of_order_.rbegin(), out_of_order_.rend(),
                                   [&](const OutOfOrderRead& h) { return h.behind >> behind_slot & 1u; });
  return newest == out_of_order_.rend() ? nullptr : newest->request.origin;
}

}  // namespace fovea::mem
