// What a debugger sees of the crossbar.
#include <bit>

#include "model/bus/core/crossbar.h"

namespace fovea::bus {

Crossbar::View Crossbar::view(Picoseconds at) const {
  View v;
  const bool running = scr_.running();
  for (std::size_t m = 0; m < kMasterCount; ++m) {
    const Port& p = ports_[m];
    v.priority[m] = p.priority;
    for (std::uint32_t i = p.head; i != p.tail; ++i) {
      const Port::Item& item = p.queue[i % kQueue];
      const bool known = running && item.crossed != kNotYet;
      v.items.push_back({item.request, known ? scr_.edge(item.crossed) : kNever, i == p.head});
    }
  }
  for (std::size_t k = 0; k < kSlaveCount; ++k) {
    const SlaveState& s = slaves_[k];
    View::SlaveView& out = v.slaves[k];
    out.blocked = s.blocked;
    if (running && s.free > scr_.edge_at_or_after(at)) out.free = scr_.edge(s.free);
    if (s.grants_made) out.granted = static_cast<Master>(s.last);
    if (s.open_to != ~0u) out.locked_by = static_cast<Master>(std::countr_zero(s.open_to));
  }
  v.next_at = next_;
  if (next_ != kNever) v.next = static_cast<Master>(next_port_);
  return v;
}

}  // namespace fovea::bus
