#include "model/bus/core/crossbar.h"

#include <bit>

#include "model/common/check.h"

namespace fovea::bus {

Crossbar::Crossbar(const CrossbarParams& params) : timeline(params.timeline_interval()) {
  for (std::size_t i = 0; i < kStatCount; ++i)
    stats[i] = std::make_unique<MasterStats>(master_of_stat(i));
  for (std::size_t i = 0; i < kMasterCount; ++i) {
    const auto m = static_cast<Master>(i);
    const MasterPortParams& from = params.port(m);
    Port& p = ports_[i];
    p.request_latency = static_cast<std::uint8_t>(from.request_latency());
    p.response_latency = static_cast<std::uint8_t>(from.response_latency());
    p.beat_log2 = static_cast<std::uint8_t>(from.beat_log2());
    p.stats = stats[stat_index(m)].get();
  }
  of_priority_[Port().priority] = (1u << kMasterCount) - 1;
  priorities_ = 1u << Port().priority;
}

void Crossbar::set_clock(Frequency scr, Picoseconds at) {
  if (scr == scr_.frequency()) return;
  const bool stood = !scr_.running();
  scr_.restart(scr, at);
  if (scr_.running()) {
    const std::uint64_t first = scr_.edge_at_or_after(at);  // edges before have no times any more
    for (SlaveState& s : slaves_) s.grants_made = s.summed = s.visible_heads = 0;
    for (std::size_t m = 0; m < kMasterCount; ++m) {
      Port& p = ports_[m];
      for (std::uint32_t i = p.head; i != p.tail; ++i) {
        Port::Item& item = p.queue[i % kQueue];
        item.grants = 0;
        if (i == p.head) item.visible = visible_[m];
        // Requests that come after the change see the new edges.
        if (item.request->issued > at)
          item.visible = item.crossed = scr_.edge_after(item.request->issued) + p.request_latency;
        else if (stood) {  // not later than if it came with the restart
          const std::uint64_t limit = scr_.edge_after(at) + p.request_latency;
          item.visible = std::min(item.visible, limit);
          item.crossed = std::min(item.crossed, limit);
        }
        item.crossed = std::max(item.crossed, first);
        if (i == p.head) visible_[m] = item.visible;
      }
    }
  }
  plan();
}

void Crossbar::set_priority(Master m, unsigned priority) {
  Port& p = ports_[index(m)];
  if (p.priority == (priority & 7u)) return;
  const std::uint32_t bit = 1u << index(m);
  of_priority_[p.priority] &= ~bit;
  if (of_priority_[p.priority] == 0) priorities_ &= ~(1u << p.priority);
  p.priority = static_cast<std::uint8_t>(priority & 7u);
  of_priority_[p.priority] |= bit;
  priorities_ |= 1u << p.priority;
  plan();  // the winner chosen for the next edge may be another one now
}

void Crossbar::submit(MemRequest& request, Slave slave) {
  Port& p = ports_[index(request.master)];
  FOVEA_CHECK(p.tail - p.head < kQueue, "a master exceeds the crossbar's queue");
  request.in_path.slave = static_cast<std::uint8_t>(slave);
  if (observed()) [[unlikely]]
    report_request(request, slave == Slave::kDdr);
  const bool head = p.empty();
  Port::Item& item = p.queue[p.tail++ % kQueue];
  SlaveState& s = slaves_[request.in_path.slave];
  const std::uint32_t bit = 1u << index(request.master);
  const bool running = scr_.running();  // else set_clock() says when
  const std::uint64_t crossed =
      running ? scr_.edge_after(request.issued) + p.request_latency : kNotYet;
  item = {&request, crossed, crossed, s.grants_made ? s.grants_made - 1 : 0};
  if (!head) return;  // competes when those before it are gone
  const std::uint32_t others = waiting_;
  waiting_ |= bit;
  s.heads |= bit;
  visible_[index(request.master)] = crossed;
  if (!running || s.blocked || !(s.open_to & bit)) return;
  // An arbitration planned for an earlier edge stands; at an equal one the winner may change.
  const std::uint64_t edge = std::max(crossed, s.free);
  if (next_ != kNever && edge > next_edge_) return;
  if (others && next_ != kNever && edge == next_edge_) return plan();
  next_edge_ = edge;
  next_port_ = static_cast<std::uint8_t>(index(request.master));
  next_ = scr_.edge(edge);
}

[[gnu::noinline]] void Crossbar::report_request(const MemRequest& r, bool to_sdram) {
  observers_.each([&](MemObserver* o) { o->submitted(r, to_sdram); });
}

[[gnu::noinline]] void Crossbar::report_outcome(const MemRequest& r) {
  const bool sdram = r.in_path.slave == static_cast<std::uint8_t>(Slave::kDdr);
  observers_.each([&](MemObserver* o) { sdram ? o->responded(r) : o->register_done(r); });
}

/// Of the ports in `set` the one of the highest priority, then the next one after the last winner.
inline unsigned Crossbar::winner(const SlaveState& s, std::uint32_t set) const {
  std::uint32_t equals = 0;
  for (std::uint32_t left = priorities_; equals == 0; left &= left - 1)
    equals = set & of_priority_[static_cast<unsigned>(std::countr_zero(left))];
  const std::uint32_t after = equals & (~1u << s.last);
  return static_cast<unsigned>(std::countr_zero(after ? after : equals));
}

/// Of two winners at the same edge, each at its own slave.
bool Crossbar::goes_first(unsigned a, const SlaveState& of_a, unsigned b,
                          const SlaveState& of_b) const {
  const auto rank = [this](unsigned m, const SlaveState& s) {
    return (ports_[m].priority * 64u + turns_after(s.last, m)) * 64u + m;
  };
  return rank(a, of_a) < rank(b, of_b);
}

/// Finds the earliest arbitration and its winner: highest priority, then round robin. Only heads of
/// queues compete; the winner depends on arrivals strictly before the edge.
[[gnu::noinline]] void Crossbar::plan() {
  next_ = kNever;
  if (!scr_.running()) return;
  std::uint64_t best = kNotYet;
  const SlaveState* of_best = nullptr;
  for (SlaveState& s : slaves_) {
    const std::uint32_t candidates = s.candidates();
    if (candidates == 0) continue;
    std::uint64_t edge = kNotYet;
    for (std::uint32_t set = candidates & ~s.visible_heads; set; set &= set - 1) {
      const auto m = static_cast<unsigned>(std::countr_zero(set));
      if (visible_[m] <= s.free)
        s.visible_heads |= set & -set;
      else
        edge = std::min(edge, visible_[m]);
    }
    std::uint32_t competing = candidates & s.visible_heads;
    if (competing) {
      edge = s.free;
    } else {
      for (std::uint32_t set = candidates; set; set &= set - 1)
        if (visible_[static_cast<unsigned>(std::countr_zero(set))] == edge) competing |= set & -set;
    }
    if (edge > best || edge == kNotYet) continue;
    const unsigned m = winner(s, competing);
    if (edge == best && !goes_first(m, s, next_port_, *of_best)) continue;
    best = edge;
    of_best = &s;
    next_port_ = static_cast<std::uint8_t>(m);
  }
  if (best == kNotYet) return;
  next_edge_ = best;
  next_ = scr_.edge(best);
}

/// A locked request keeps the slave for its master until that one's next request is granted (the
/// read and the write of an SWP).
void Crossbar::set_lock(SlaveState& s, const MemRequest& r) {
  const bool second = s.open_to != ~0u;
  s.open_to = r.locked && !second ? 1u << index(r.master) : ~0u;
}

/// Brings `bus` and `before` up to the last grant but one. A sum just changed and read with its
/// neighbours would hold up the host.
inline void Crossbar::sum_grants(SlaveState& s) {
  const std::uint32_t last = s.grants_made - 1;
  if (last - s.summed > SlaveState::kGrants - 1)
    s.summed = last - static_cast<std::uint32_t>(SlaveState::kGrants - 1);
  for (; s.summed != last; ++s.summed) {
    const Grant& g = s.grant(s.summed);
    BusTimes& before = s.before[s.summed % SlaveState::kGrants];
    for (std::size_t i = 0; i < s.bus.size(); i += 2)
      store_pair(&before[i], load_pair(&s.bus[i]));
    s.bus[g.master] += g.time();
    s.bus[kMasterCount] += g.time();
  }
}

[[gnu::noinline]] void Crossbar::attribute(SlaveState& s, const MemRequest& r,
                                           std::uint64_t crossed, std::uint32_t grants,
                                           Picoseconds granted) {
  const Picoseconds start = scr_.edge(crossed), waited = granted - start;
  charge(r, Culprit::kBridge, start - r.issued);
  const std::uint32_t made = s.grants_made;
  std::uint32_t n = std::min(made - grants, static_cast<std::uint32_t>(SlaveState::kGrants));
  while (n > 0 && s.grant(made - n).end <= crossed) --n;
  MasterWaits& of_master = waits[index(r.master)];
  Waits& w = r.write ? of_master.write : of_master.read;
  std::optional<Waits> before;
  if (r.parts) before = w;
  Picoseconds of_bus = 0;
  if (n > kFewGrants) {
    sum_grants(s);
    const Grant &first = s.grant(made - n), &last = s.grant(made - 1);
    const Picoseconds passed = first.start < crossed ? start - first.start_at : 0;
    const BusTimes& bus = s.before[(made - n) % SlaveState::kGrants];
    of_bus = s.bus[kMasterCount] - bus[kMasterCount] + last.time() - passed;
    w.add_masters(s.bus.data(), bus.data());
    w.add(static_cast<Culprit>(last.master), last.time());
    w.take_back(static_cast<Culprit>(first.master), passed);
  } else {
    for (; n > 0; --n) {
      const Grant& g = s.grant(made - n);
      const Picoseconds t = g.end_at - (g.start < crossed ? start : g.start_at);
      w.add(static_cast<Culprit>(g.master), t);
      of_bus += t;
    }
  }
  // Time in which no other master occupied the data bus: the request waited behind an earlier one of its
  // own master.
  w.add(culprit(r.master), waited - of_bus);
  if (!before) return;
  for (std::size_t m = 0; m < kMasterCount; ++m)
    if (const Picoseconds t = w.ps[m] - before->ps[m]) r.parts->add(static_cast<Culprit>(m), t);
}

/// The slave's input is free again. @return the edge at which the slave takes the request
std::uint64_t Crossbar::reopen(MemRequest& request, Picoseconds at, Master unblocked_by) {
  SlaveState& s = slaves_[request.in_path.slave];
  s.blocked = false;
  // s.free is when the request's last beat is at the slave: it is not acknowledged before.
  // A faster clock since the grant does not bring it there before the time that was announced.
  s.free = std::max({s.free, scr_.edge_after(at), scr_.edge_at_or_after(request.in_path.accepted_at)});
  const Picoseconds taken = scr_.edge(s.free);
  if (s.grants_made) {
    Grant& g = s.grant(s.grants_made - 1);
    g.end = s.free;
    g.end_at = taken;
  }
  if (request.in_path.slave == static_cast<std::uint8_t>(Slave::kDdr))
    charge(request, culprit(unblocked_by), taken - request.in_path.accepted_at);
  request.in_path.accepted_at = taken;
  request.in_path.unblocked_by = static_cast<std::uint8_t>(unblocked_by);
  return s.free;
}

/// Data from the crossbar to the port. A port narrower than the crossbar takes longer for each word, and
/// begins with the next burst when it is through with the one before.
[[gnu::always_inline]] inline void Crossbar::return_read(MemRequest& r, Picoseconds first,
                                                         Picoseconds last,
                                                         Picoseconds attributed) {
  const Port& p = ports_[index(r.master)];
  const std::uint64_t seen = scr_.edge_at_or_after(first) + p.response_latency;
  std::uint64_t begin = seen;
  std::uint64_t end =
      last <= first ? begin : scr_.edge_at_or_after(last) + p.response_latency;
  if (p.beat_log2 < kBusLog2 && scr_.running()) {
    if (p.answered[0]) begin = std::max(begin, scr_.edge_after(p.answered[0]));
    const unsigned last_word = std::min<unsigned>(r.bytes, 1u << kBusLog2);
    end = std::max(end + p.beats(last_word), begin + p.beats(r.bytes)) - 1;
  }
  const Picoseconds granted = r.first;
  const bool slowest = set_outcome(r, scr_.edge(begin), scr_.edge(end));
  const Picoseconds free = begin == seen ? r.first : scr_.edge(seen);
  Waits& w = waits[index(r.master)].read;
  RequestWaits* const parts = r.parts;
  const auto add = [&w, parts](Culprit c, Picoseconds t) {
    w.add(c, t);
    if (parts) parts->add(c, t);
  };
  add(Culprit::kBridge, free - first);
  if (r.first != free) add(culprit(r.master), r.first - free);
  add(Culprit::kService, first - r.in_path.accepted_at - attributed);
  if (slowest) [[unlikely]]
    note_slowest(r, granted, first, free);
}

/// Everything about an outcome but the call that reports it.
void Crossbar::settle_outcome(MemRequest& request, const SlaveOutcome& outcome) {
  const auto [first, last, attributed, error] = outcome;
  const bool ddr = request.in_path.slave == static_cast<std::uint8_t>(Slave::kDdr);
  request.error = error;
  if (ddr) {
    // Nor does a faster clock bring data before the command was there.
    return_read(request, std::max(first, request.in_path.accepted_at + attributed), last, attributed);
  } else {
    const std::uint64_t latency = ports_[index(request.master)].response_latency;
    request.first = scr_.edge(scr_.edge_at_or_after(first) + latency);
    request.last =
        last <= first ? request.first : scr_.edge(scr_.edge_at_or_after(last) + latency);
  }
  if (error && request.locked) {  // its master gives up
    slaves_[request.in_path.slave].open_to = ~0u;
    plan();
  }
  if (observed()) [[unlikely]]
    report_outcome(request);
}

}  // namespace fovea::bus
