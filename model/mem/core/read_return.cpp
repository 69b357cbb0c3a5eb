#include "model/mem/core/read_return.h"

#include <algorithm>

namespace fovea::mem {

[[gnu::noinline]] void ReadReturn::send_in_order(const QueueEntry& e, std::uint32_t slot, std::uint32_t older_slots,
                                                 const WaitAttribution::Column& column, ReadOutcomes& outcomes) {
  const ReturnChannel::Span data = send(e, column.clock);
  const Clock& bus = this->clock();
  const OutOfOrderRead mine{e.request,           older_slots,
                            data.first,          bus.edge_at_or_after(data.last) - bus.edge_at_or_after(data.first),
                            attribution_.waited, column};
  // A read that waits for this one is younger; the others of this master that wait are older.
  const auto younger = std::find_if(waiting_.begin(), waiting_.end(),
                                    [&](const OutOfOrderRead& h) { return h.behind & slot; });
  for (auto h = younger; h != waiting_.end(); ++h) h->behind &= ~slot;
  waiting_.insert(younger, mine);
  for (;;) {
    const auto due = std::find_if(waiting_.begin(), waiting_.end(),
                                  [](const OutOfOrderRead& h) { return h.behind == 0; });
    if (due == waiting_.end()) return;
    const OutOfOrderRead h = *due;
    waiting_.erase(due);
    report(h, outcomes);
  }
}

/// The data leave the buffer one word an edge, behind those reported to the master before; that wait
/// counts as the master's own.
void ReadReturn::report(const OutOfOrderRead& h, ReadOutcomes& outcomes) {
  const QueuedRequest& r = h.request;
  Picoseconds& reported = reported_until_[index(r.master)];
  const Clock& bus = clock();
  const Picoseconds first = std::max(h.first, bus.next_edge_after(reported));
  reported = bus.edge(bus.edge_at_or_after(first) + h.edges);
  if (first > h.first) attribution_.charge(r, culprit(r.master), first - h.first);
  outcomes.add({r.origin, first, reported, h.waited + (first - h.first), h.column});
}

const MemRequest* ReadReturn::newest_behind(unsigned slot) const {
  const auto newest = std::find_if(waiting_.rbegin(), waiting_.rend(), [&](const OutOfOrderRead& h) {
    return h.behind >> slot & 1u;
  });
  return newest == waiting_.rend() ? nullptr : newest->request.origin;
}

}  // namespace fovea::mem
