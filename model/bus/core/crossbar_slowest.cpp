// What passed before the outcome of a request that is slower than all before it. It is found afterwards,
// out of the grants that are remembered, so that other requests cost nothing.
#include <algorithm>

#include "model/bus/core/crossbar.h"

namespace fovea::bus {

/// The steps up to the controller.
void Crossbar::tell_way_to_sdram(const MemRequest& r, Picoseconds granted, SlowRequest& out) {
  constexpr auto kNotKnown = Culprit::kCount;
  SlaveState& s = slaves_[static_cast<std::size_t>(Slave::kDdr)];
  const Port& p = ports_[index(r.master)];
  const std::uint32_t made = s.grants_made;
  const auto known = std::min(made, static_cast<std::uint32_t>(SlaveState::kGrants));
  std::uint32_t own = 1;  // so many grants ago it had its turn
  while (own <= known && (s.grant(made - own).start_at != granted || s.grant(made - own).master != index(r.master)))
    ++own;
  if (own > known) return out.until(r.in_path.accepted_at, RequestPlace::kCrossbar, kNotKnown);
  const Picoseconds crossed = std::min(granted, scr_.edge(scr_.edge_after(r.issued) + p.request_latency));
  out.until(crossed, RequestPlace::kPort, Culprit::kBridge);
  for (std::uint32_t n = known; n > own; --n) {
    const Grant& g = s.grant(made - n);
    if (g.end_at <= crossed) continue;
    const bool forgotten = n == known && made > known && g.start_at > crossed;
    // Without a grant it waited behind an earlier request of its own master.
    out.until(g.start_at, RequestPlace::kCrossbar, forgotten ? kNotKnown : culprit(r.master));
    out.until(g.end_at, RequestPlace::kCrossbar, static_cast<Culprit>(g.master));
  }
  out.until(granted, RequestPlace::kCrossbar, culprit(r.master));
  const Picoseconds arrived = scr_.edge(s.grant(made - own).start + (r.write ? p.beats(r.bytes) : 1u));
  out.until(std::min(arrived, r.in_path.accepted_at), RequestPlace::kCrossbar, Culprit::kService);
  out.until(r.in_path.accepted_at, RequestPlace::kController, static_cast<Culprit>(r.in_path.unblocked_by));
}

[[gnu::noinline]] void Crossbar::note_slowest(const MemRequest& r, Picoseconds granted, Picoseconds on_crossbar,
                                              Picoseconds at_port) {
  PortLatencies& of_port = latencies[index(r.master)];
  SlowRequest& out = r.write ? of_port.slowest_write : of_port.slowest_read;
  out.begin(r);
  tell_way_to_sdram(r, granted, out);
  if (teller_) teller_->tell(out);
  out.until(on_crossbar, RequestPlace::kReturn, Culprit::kService);
  out.until(at_port, RequestPlace::kReturn, Culprit::kBridge);
  out.until(out.end(), RequestPlace::kReturn, culprit(r.master));
}

/// Without the crossbar: how the time divides is not known.
[[gnu::noinline]] void Crossbar::note_slowest(const MemRequest& r) {
  PortLatencies& of_port = latencies[index(r.master)];
  SlowRequest& out = r.write ? of_port.slowest_write : of_port.slowest_read;
  out.begin(r);
  out.until(out.end(), RequestPlace::kController, Culprit::kCount);
}

}  // namespace fovea::bus
