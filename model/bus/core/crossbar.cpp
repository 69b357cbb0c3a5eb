#include "model/bus/core/crossbar.h"

#include <bit>

#include "model/common/check.h"

namespace fovea::bus {

Crossbar::Crossbar(const CrossbarParams& params, XbarHost& host)
    : host_(host), interval_(params.timeline_interval()) {
  for (std::size_t i = 0; i < kMasterCount; ++i) {
    stats[i] = std::make_unique<MasterStats>(static_cast<Master>(i));
    ports_[i].request_latency = static_cast<std::uint8_t>(params.ports[i]->request_latency());
    ports_[i].response_latency = static_cast<std::uint8_t>(params.ports[i]->response_latency());
  }
}

void Crossbar::set_clock(Frequency scr, Picoseconds at) {
  if (scr == scr_.frequency()) return;
  const bool stood = !scr_.running();
  scr_.restart(scr, at);
  if (scr_.running()) {
    const std::uint64_t first = scr_.edge_at_or_after(at);  // edges before have no times any more
    for (SlaveState& s : slaves_) s.grants_made = 0;
    for (Port& p : ports_)
      for (std::uint32_t i = p.head; i != p.tail; ++i) {
        Port::Item& item = p.queue[i % kQueue];
        // Requests that come after the change see the new edges.
        if (item.request->issued > at)
          item.visible = item.crossed = scr_.edge_after(item.request->issued) + p.request_latency;
        else if (stood) {  // not later than if it came with the restart
          const std::uint64_t limit = scr_.edge_after(at) + p.request_latency;
          item.visible = std::min(item.visible, limit);
          item.crossed = std::min(item.crossed, limit);
        }
        item.crossed = std::max(item.crossed, first);
      }
  }
  plan();
}

void Crossbar::set_priority(Master m, unsigned priority) {
  Port& p = ports_[index(m)];
  if (p.priority == (priority & 7u)) return;
  p.priority = static_cast<std::uint8_t>(priority & 7u);
  plan();  // the winner chosen for the next edge may be another one now
}

void Crossbar::submit(MemRequest& request, Slave slave) {
  Port& p = ports_[index(request.master)];
  FOVEA_CHECK(p.tail - p.head < kQueue, "a master exceeds the crossbar's queue");
  request.slave = static_cast<std::uint8_t>(slave);
  request.slave_waited = 0;
  if (observer_) [[unlikely]]
    observer_->submitted(request, slave == Slave::kDdr);
  const bool head = p.empty();
  Port::Item& item = p.queue[p.tail++ % kQueue];
  if (!scr_.running()) {  // set_clock() says when
    item = {&request, kNotYet, kNotYet};
    waiting_ |= 1u << index(request.master);
    return;
  }
  const std::uint64_t crossed = scr_.edge_after(request.issued) + p.request_latency;
  item = {&request, crossed, crossed};
  if (!head) return;  // competes when those before it are gone
  const std::uint32_t others = waiting_;
  waiting_ |= 1u << index(request.master);
  const SlaveState& s = slave_of(request);
  if (barred(s, static_cast<unsigned>(index(request.master)))) return;
  // An arbitration planned for an earlier edge stands; at an equal one the winner may change.
  const std::uint64_t edge = std::max(item.visible, s.free);
  if (next_ != kNever && edge > next_edge_) return;
  if (others && next_ != kNever && edge == next_edge_) return plan();
  next_edge_ = edge;
  next_port_ = static_cast<std::uint8_t>(index(request.master));
  next_ = scr_.edge(edge);
}

/// Finds the earliest arbitration and its winner: highest priority, then round robin. Only heads of
/// queues compete; the winner depends on arrivals strictly before the edge.
void Crossbar::plan() {
  next_ = kNever;
  if (waiting_ == 0 || !scr_.running()) return;
  std::uint64_t edge = ~std::uint64_t{0};
  if ((waiting_ & (waiting_ - 1)) == 0) {  // nobody competes
    const auto m = static_cast<unsigned>(std::countr_zero(waiting_));
    const Port::Item& item = ports_[m].front();
    const SlaveState& s = slave_of(*item.request);
    if (barred(s, m)) return;
    next_edge_ = std::max(item.visible, s.free);
    next_port_ = static_cast<std::uint8_t>(m);
    next_ = scr_.edge(next_edge_);
    return;
  }
  for (std::uint32_t set = waiting_; set; set &= set - 1) {
    const auto m = static_cast<unsigned>(std::countr_zero(set));
    const Port::Item& item = ports_[m].front();
    const SlaveState& s = slave_of(*item.request);
    if (!barred(s, m)) edge = std::min(edge, std::max(item.visible, s.free));
  }
  if (edge == ~std::uint64_t{0}) return;
  int best = -1;
  unsigned best_rank = 0;
  for (std::uint32_t set = waiting_; set; set &= set - 1) {
    const auto m = static_cast<unsigned>(std::countr_zero(set));
    const Port& p = ports_[m];
    const SlaveState& s = slave_of(*p.front().request);
    if (barred(s, m) || std::max(p.front().visible, s.free) > edge) continue;
    const unsigned turn = (m + kMasterCount - s.last - 1) % kMasterCount;
    const unsigned rank = p.priority * 64u + turn;
    if (best < 0 || rank < best_rank) {
      best = static_cast<int>(m);
      best_rank = rank;
    }
  }
  next_edge_ = edge;
  next_port_ = static_cast<std::uint8_t>(best);
  next_ = scr_.edge(edge);
}

/// A locked request keeps the slave for its master until that one's next request is granted (the
/// read and the write of an SWP).
void Crossbar::set_lock(SlaveState& s, const MemRequest& r) {
  const bool second = s.open_to != ~0u;
  s.open_to = r.locked && !second ? 1u << index(r.master) : ~0u;
}

void Crossbar::attribute(SlaveState& s, const MemRequest& r, std::uint64_t crossed,
                         std::uint64_t edge) {
  Waits& w = waits_of(r);
  const Picoseconds start = scr_.edge(crossed);
  w.add(Culprit::kBridge, start - r.issued);
  // From the newest grant back. Where nobody had the lane the request stood behind its own master's
  // last one.
  Picoseconds until = next_;
  std::uint64_t at = edge;
  const auto take = [&](std::uint64_t from, Culprit c) {
    if (from >= at) return;
    const Picoseconds t = from <= crossed ? start : scr_.edge(from);
    w.add(c, until - t);
    until = t;
    at = from;
  };
  const std::uint32_t oldest =
      s.grants_made > SlaveState::kGrants ? s.grants_made - SlaveState::kGrants : 0;
  for (std::uint32_t n = s.grants_made; n-- > oldest && at > crossed;) {
    const Grant& g = s.grant(n);
    take(std::max(g.end, crossed), culprit(r.master));
    take(std::max(g.start, crossed), static_cast<Culprit>(g.master));
  }
  take(crossed, culprit(r.master));
}

void Crossbar::slave_accepted(MemRequest& request, Picoseconds at) {
  SlaveState& s = slaves_[request.slave];
  s.blocked = false;
  // s.free is when the request's last beat is at the slave: it is not acknowledged before.
  // A faster clock since the grant does not bring it there before the time that was announced.
  s.free = std::max({s.free, scr_.edge_after(at), scr_.edge_at_or_after(request.taken)});
  if (s.grants_made) s.grant(s.grants_made - 1).end = s.free;
  const Picoseconds taken = scr_.edge(s.free);
  if (request.slave == static_cast<std::uint8_t>(Slave::kDdr))
    waits_of(request).add(culprit(request.door_opener), taken - request.taken);
  request.taken = taken;
  if (request.write && request.slave == static_cast<std::uint8_t>(Slave::kDdr))
    acknowledge_write(host_, request, s.free);
  plan();
}

void Crossbar::slave_done(MemRequest& request, Picoseconds first, Picoseconds last, bool error) {
  const std::uint64_t latency = ports_[index(request.master)].response_latency;
  const bool ddr = request.slave == static_cast<std::uint8_t>(Slave::kDdr);
  // Nor does a faster clock bring data before the command was there.
  if (ddr) first = std::max(first, request.taken + request.slave_waited);
  const Picoseconds begin = scr_.edge(scr_.edge_at_or_after(first) + latency);
  const Picoseconds end =
      last <= first ? begin : scr_.edge(scr_.edge_at_or_after(last) + latency);
  request.error = error;
  if (ddr) {
    set_outcome(request, begin, end);
    waits_of(request).add(Culprit::kBridge, request.first - first);
    waits_of(request).add(Culprit::kService, first - request.taken - request.slave_waited);
  } else {
    request.first = begin;
    request.last = end;
  }
  if (error && request.locked) {  // its master gives up
    slaves_[request.slave].open_to = ~0u;
    plan();
  }
  if (observer_) [[unlikely]]
    ddr ? observer_->responded(request) : observer_->register_done(request);
  host_.respond(request);
}

}  // namespace fovea::bus
