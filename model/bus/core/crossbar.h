// The switched central resource: queues per master, arbitration per slave, at the edges of its own
// clock. A passive state machine like the controllers behind it.
#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/bus/core/crossbar_params.h"
#include "model/bus/core/latency_histogram.h"
#include "model/bus/core/timeline.h"
#include "model/common/clock.h"
#include "model/common/mem_observer.h"
#include "model/common/mem_request.h"
#include "model/common/observers.h"
#include "model/common/stats.h"
#include "model/common/waits.h"

namespace fovea::bus {

enum class Slave : std::uint8_t { kDdr, kConfig, kInternalRam, kCount };
inline constexpr std::size_t kSlaveCount = static_cast<std::size_t>(Slave::kCount);

/// What the crossbar moves requests and outcomes through. The type is known at compile time, so that
/// both are direct calls.
template <class H>
concept CrossbarHost = requires(H& host, MemRequest& request, Picoseconds arrival) {
  /// Sends a granted request; it is at the slave at `arrival`. If the result is kWaits, the host calls
  /// slave_accepted() later.
  { host.forward(request, arrival) } -> std::same_as<Taken>;
  /// The outcome is in the request.
  host.respond(request);
};

struct MasterStats final : StatGroup {
  Counter read_bytes{*this, "read_bytes", "B", "bytes that " + name() + " read"};
  Counter write_bytes{*this, "write_bytes", "B", "bytes that " + name() + " wrote"};
  Counter transactions{*this, "transactions", "1", "bursts and single accesses of " + name()};
  /// The part that goes to the SDRAM, for the balance against ddr.*_bytes; not printed itself.
  std::uint64_t ddr_read_bytes = 0, ddr_write_bytes = 0;
  explicit MasterStats(Master m) : StatGroup("bus." + std::string(stat_name(m))) {}

 private:
  std::string name() const { return prefix().substr(4); }
  void on_reset() override { ddr_read_bytes = ddr_write_bytes = 0; }
};

class Crossbar {
 public:
  explicit Crossbar(const CrossbarParams& params);
  void set_clock(Frequency scr, Picoseconds at);
  /// 0 highest .. 7; takes effect for arbitration strictly after the call's time.
  void set_priority(Master m, unsigned priority);
  std::uint8_t priority(Master m) const { return ports_[index(m)].priority; }

  /// Adds an observer of all requests, which must outlive the subscription.
  Subscription observe(MemObserver& observer) { return observers_.add(&observer); }

  /// Puts a request on its master's port at request.issued: not before the master's earlier ones,
  /// and before any decision later than that was taken. It stays where it is until its response.
  void submit(MemRequest& request, Slave slave);
  /// The next arbitration, kNever if there is nothing to arbitrate.
  Picoseconds next_decision() const { return next_; }
  template <CrossbarHost Host>
  void step(Host& host);

  bool observed() const { return !observers_.empty(); }
  /// Who knows what passed at the SDRAM; outlives the crossbar. None: these steps are left out.
  void set_teller(const SlowRequestTeller& teller) { teller_ = &teller; }
  /// The grant of a request to the SDRAM whose port has not been called, if it comes before the
  /// next one planned: its time is known at once. `at` is kNever if another request or an observer has a say in it.
  struct UncontendedGrant {
    std::uint64_t crossed = 0, edge = 0;
    Picoseconds at = kNever;
  };
  UncontendedGrant uncontended_grant(const MemRequest& r) const {
    const SlaveState& s = slaves_[static_cast<std::size_t>(Slave::kDdr)];
    UncontendedGrant g;
    if (waiting_ >> index(r.master) & 1u || observed() || r.locked || s.blocked ||
        s.open_to != ~0u || !scr_.running())
      return g;
    g.crossed = scr_.edge_after(r.issued) + ports_[index(r.master)].request_latency;
    g.edge = std::max(g.crossed, s.free);
    if (next_ == kNever || g.edge < next_edge_) g.at = scr_.edge(g.edge);
    return g;
  }
  /// submit() and step() in one, for the present uncontended_grant() of a request of which r.parts has
  /// nothing yet. True: it is over, and the host not called, which a write with room is at once.
  template <bool kWrite, CrossbarHost Host>
  bool grant_uncontended(Host& host, MemRequest& request, const UncontendedGrant& grant);
  /// A write: from its issue to its acknowledgement, with one beat and without contention.
  Picoseconds least_latency(Master m) const {
    const Port& p = ports_[index(m)];
    const Picoseconds t = scr_.periods(p.request_latency + 1u + p.response_latency);
    return t > 2 ? t - 2 : 0;  // two times may have been rounded down
  }

  /// Slave side: the request waiting at the slave was accepted at `at`, when a request of
  /// `unblocked_by` left the slave's queue and made room.
  template <CrossbarHost Host>
  void slave_accepted(Host& host, MemRequest& request, Picoseconds at, Master unblocked_by);
  /// Slave side: read data on the crossbar from first to last; or a register access that ended.
  struct SlaveOutcome {
    Picoseconds first = 0, last = 0;
    Picoseconds attributed = 0;  ///< part of a read's time in the slave that the slave's own wait
                                 ///< attribution explains
    bool error = false;
  };
  template <CrossbarHost Host>
  void slave_done(Host& host, MemRequest& request, const SlaveOutcome& outcome) {
    settle_outcome(request, outcome);
    host.respond(request);
  }

  /// By stat_index().
  std::array<std::unique_ptr<MasterStats>, kStatCount> stats;
  /// Bytes granted.
  Timeline timeline;
  /// Time between issue and arrival at the SDRAM, and from there back to the port.
  WaitTable waits;
  /// Of the requests to the SDRAM, by Master; refused ones included.
  std::array<PortLatencies, kMasterCount> latencies;
  /// `first`: what counts as the first beat.
  /// @return none of its master and direction was as slow: note_slowest() is to be called
  [[gnu::always_inline]] bool count_latency(const MemRequest& r, Picoseconds first) {
    PortLatencies& of_port = latencies[index(r.master)];
    BeatLatencies& l = r.write ? of_port.write : of_port.read;
    const Picoseconds to_first = first - r.issued, to_last = r.last - r.issued;
    const bool slowest = r.write ? to_last > l.last.max() : to_first > l.first.max();
    l.first.add(to_first);
    l.last.add(to_last);
    return slowest;
  }
  /// For requests that do not pass the crossbar.
  void note_slowest(const MemRequest& r);

  /// Snapshot of all queued requests, for debugger commands.
  struct View {
    struct Item {
      const MemRequest* request;
      Picoseconds crossed;  ///< through its bridge; kNever while the clock stands
      bool head;            ///< of its master's queue: competes for the slave
    };
    struct SlaveView {
      bool blocked = false;           ///< the last granted request waits in its input register
      Picoseconds free = 0;           ///< its data bus; 0: free already
      std::optional<Master> granted;  ///< last
      std::optional<Master> locked_by;
    };
    std::vector<Item> items;  ///< by master, oldest first
    std::array<SlaveView, kSlaveCount> slaves;
    std::optional<Master> next;  ///< winner of the next arbitration, as things stand
    Picoseconds next_at = kNever;
    std::array<unsigned, kMasterCount> priority{};
  };
  View view(Picoseconds at) const;

 private:
  static constexpr std::uint64_t kNotYet = ~std::uint64_t{0};  // the clock stands
  static constexpr unsigned kBusLog2 = 3;  // bytes of a slave's data bus
  static constexpr std::size_t kQueue = 64;  // as deep as any master's outstanding limit
  struct Port {
    struct Item {
      MemRequest* request;
      std::uint64_t visible;  // edge from which the arbiter sees it, at the earliest
      std::uint64_t crossed;  // edge at which it is through the bridge
      std::uint32_t grants;   // of its slave, when it came; all but the last ended before `crossed`
    };
    std::array<Item, kQueue> queue;
    std::uint32_t head = 0, tail = 0;
    Item& front() { return queue[head % kQueue]; }
    const Item& front() const { return queue[head % kQueue]; }
    std::uint8_t priority = 7;
    std::uint8_t request_latency = 0, response_latency = 0;
    std::uint8_t beat_log2 = kBusLog2;  // bytes that cross the port in a clock
    MasterStats* stats = nullptr;
    unsigned beats(unsigned bytes) const { return (bytes + (1u << beat_log2) - 1) >> beat_log2; }
    std::array<Picoseconds, 2> answered{};  // last beat of the newest outcome; reads, writes
    bool empty() const { return head == tail; }
  };
  /// The slave's data bus was the master's from `start` on, up to the next one's start or `end`.
  struct Grant {
    std::uint64_t start = 0, end = 0;
    Picoseconds start_at = 0, end_at = 0;
    std::uint8_t master = 0;
    Picoseconds time() const { return end_at - start_at; }
  };
  static constexpr std::uint32_t kFewGrants = 4;  // so many are added up one by one
  /// How long each master occupied a slave's data bus, and all of them together, in ps.
  using BusTimes = std::array<Picoseconds, (kMasterCount + 2) / 2 * 2>;
  struct SlaveState {
    static constexpr std::size_t kGrants = 64;
    std::uint64_t free = 0;      // first edge at which its data bus is free
    std::uint32_t heads = 0;     // ports whose first request is for it
    std::uint32_t visible_heads = 0;     // those of them that are visible at `free`
    std::uint32_t grants_made = 0;
    std::array<Grant, kGrants> grants;  // the last ones, to say who was waited for
    Grant& grant(std::uint32_t n) { return grants[n % kGrants]; }
    std::uint32_t summed = 0;    // grants that are in `bus`: not the last
    BusTimes bus{};
    std::array<BusTimes, kGrants> before;  // `bus` at the start of each summed grant
    bool blocked = false;        // a request waits in its input register
    std::uint8_t last = 0;       // round robin: last master granted
    std::uint32_t open_to = ~0u; // masters it serves: all, or the one that locked it
    std::uint32_t candidates() const { return blocked ? 0 : heads & open_to; }
  };

  void report_request(const MemRequest& r, bool to_sdram);
  void report_outcome(const MemRequest& r);
  void plan();
  template <CrossbarHost Host>
  void grant(Host& host, MemRequest& request, std::uint64_t crossed, std::uint32_t grants);
  unsigned winner(const SlaveState& s, std::uint32_t set) const;
  bool goes_first(unsigned a, const SlaveState& of_a, unsigned b, const SlaveState& of_b) const;
  void sum_grants(SlaveState& s);
  void set_lock(SlaveState& s, const MemRequest& r);
  template <CrossbarHost Host>
  void acknowledge_write(Host& host, MemRequest& request, std::uint64_t edge) {
    const Picoseconds at = scr_.edge(edge + ports_[index(request.master)].response_latency);
    set_write_outcome(request, at);
    charge(request, Culprit::kBridge, request.first - request.in_path.accepted_at);
    if (observed()) [[unlikely]]
      report_outcome(request);
    host.respond(request);
  }
  /// Until a write has its outcome, `first` is when it was granted.
  /// A master sees its outcomes in order, also when a faster clock would have the later one pass an
  /// earlier one that was decided before the change.
  [[gnu::always_inline]] bool set_outcome(MemRequest& r, Picoseconds first, Picoseconds last) {
    const Picoseconds granted = r.first;
    Picoseconds& newest = ports_[index(r.master)].answered[r.write];
    r.first = std::max(first, newest);
    r.last = newest = std::max(last, r.first);
    return count_latency(r, r.write ? granted : r.first);
  }
  void set_write_outcome(MemRequest& r, Picoseconds at) {
    const Picoseconds granted = r.first;
    r.error = false;
    if (set_outcome(r, at, at)) [[unlikely]]
      note_slowest(r, granted, r.in_path.accepted_at, r.first);
  }
  /// Of the newest outcome. `granted`: its turn; `on_crossbar`: a read's data; `at_port`: across the bridge.
  void note_slowest(const MemRequest& r, Picoseconds granted, Picoseconds on_crossbar, Picoseconds at_port);
  void tell_way_to_sdram(const MemRequest& r, Picoseconds granted, SlowRequest& out);
  void new_head(unsigned port, std::uint64_t visible) {
    visible_[port] = visible;
    slaves_[ports_[port].front().request->in_path.slave].heads |= 1u << port;
  }
  void count(unsigned port, bool write, const MemRequest& r, Picoseconds at);
  void settle_outcome(MemRequest& r, const SlaveOutcome& outcome);
  void return_read(MemRequest& r, Picoseconds first, Picoseconds last, Picoseconds attributed);
  std::uint64_t reopen(MemRequest& r, Picoseconds at, Master unblocked_by);
  /// The parts of request.issued .. `granted`.
  void attribute(SlaveState& s, const MemRequest& r, std::uint64_t crossed, std::uint32_t grants,
                 Picoseconds granted);
  [[gnu::always_inline]] void charge(const MemRequest& r, Culprit c, Picoseconds t) {
    MasterWaits& w = waits[index(r.master)];
    (r.write ? w.write : w.read).add(c, t);
    if (r.parts) r.parts->add(c, t);
  }

  Observers<MemObserver*> observers_;
  const SlowRequestTeller* teller_ = nullptr;
  Clock scr_;
  std::array<Port, kMasterCount> ports_;
  std::array<SlaveState, kSlaveCount> slaves_;
  std::uint32_t waiting_ = 0;  // ports with a queue
  std::array<std::uint64_t, kMasterCount> visible_{};  // of their first requests
  std::array<std::uint32_t, 8> of_priority_{};         // ports
  std::uint32_t priorities_ = 0;                       // those in use
  std::uint64_t next_edge_ = 0;
  std::uint8_t next_port_ = 0;
  Picoseconds next_ = kNever;
};

/// What a grant adds to the statistics.
[[gnu::always_inline]] inline void Crossbar::count(unsigned port, bool write, const MemRequest& r,
                                                   Picoseconds at) {
  MasterStats& st = *ports_[port].stats;
  ++st.transactions;
  (write ? st.write_bytes : st.read_bytes) += r.bytes;
  if (r.in_path.slave == static_cast<std::uint8_t>(Slave::kDdr))
    (write ? st.ddr_write_bytes : st.ddr_read_bytes) += r.bytes;
  timeline.add(port, write, r.bytes, at);
}

template <CrossbarHost Host>
void Crossbar::step(Host& host) {
  Port& p = ports_[next_port_];
  const Port::Item& item = p.front();
  MemRequest& r = *item.request;
  const std::uint64_t crossed = item.crossed;
  const std::uint32_t grants = item.grants;
  SlaveState& s = slaves_[r.in_path.slave];
  const std::uint32_t bit = 1u << next_port_;
  s.heads &= ~bit;
  s.visible_heads &= ~bit;
  if (++p.head == p.tail)
    waiting_ &= ~bit;
  else  // the next in line shows itself one clock later
    new_head(next_port_, std::max(p.front().visible, next_edge_ + 1));
  grant(host, r, crossed, grants);
  if (waiting_ == 0 || (s.blocked && s.heads == waiting_))
    next_ = kNever;
  else
    plan();
}

/// The slave's data bus is the request's at next_edge_.
template <CrossbarHost Host>
[[gnu::always_inline]] inline void Crossbar::grant(Host& host, MemRequest& r,
                                                   std::uint64_t crossed, std::uint32_t grants) {
  const Port& p = ports_[next_port_];
  SlaveState& s = slaves_[r.in_path.slave];
  r.in_path.priority = p.priority;
  const unsigned cycles = r.write ? p.beats(r.bytes) : 1u;
  s.free = next_edge_ + cycles;
  s.last = next_port_;
  if (r.locked || s.open_to != ~0u) [[unlikely]] set_lock(s, r);
  count(next_port_, r.write, r, next_);

  const std::uint64_t arrival = next_edge_ + cycles;
  const Picoseconds at = scr_.edge(arrival);
  if (r.in_path.slave == static_cast<std::uint8_t>(Slave::kDdr)) {
    r.first = next_;
    if (crossed == next_edge_)
      charge(r, Culprit::kBridge, next_ - r.issued);
    else
      attribute(s, r, crossed, grants, next_);
    charge(r, Culprit::kService, at - next_);
  }
  s.grant(s.grants_made++) = {next_edge_, arrival, next_, at, next_port_};
  r.in_path.accepted_at = at;
  const Taken taken = host.forward(r, at);
  if (taken == Taken::kWaits)
    s.blocked = true;
  else if (taken == Taken::kRefused)
    slave_done(host, r, {at, at, 0, true});
  else if (r.write && r.in_path.slave == static_cast<std::uint8_t>(Slave::kDdr))
    acknowledge_write(host, r, arrival);
}

template <bool kWrite, CrossbarHost Host>
[[gnu::always_inline]] inline bool Crossbar::grant_uncontended(Host& host, MemRequest& r,
                                                         const UncontendedGrant& g) {
  constexpr auto kDdr = static_cast<std::uint8_t>(Slave::kDdr);
  const auto m = static_cast<std::uint8_t>(index(r.master));
  const Port& p = ports_[m];
  SlaveState& s = slaves_[kDdr];
  r.in_path.slave = kDdr;
  r.in_path.priority = p.priority;
  r.first = g.at;
  const std::uint64_t arrival = g.edge + (kWrite ? p.beats(r.bytes) : 1u);
  const Picoseconds at = scr_.edge(arrival);
  s.free = arrival;
  s.last = m;
  count(m, kWrite, r, g.at);
  const bool at_once = g.crossed == g.edge;
  Waits& w = kWrite ? waits[m].write : waits[m].read;
  const Picoseconds to_grant = g.at - r.issued, service = at - g.at;
  w.add(Culprit::kService, service);
  if (at_once) [[likely]] {
    w.add(Culprit::kBridge, to_grant);
    if (r.parts) r.parts->begin(Culprit::kBridge, to_grant, Culprit::kService, service);
  } else {
    attribute(s, r, g.crossed, s.grants_made ? s.grants_made - 1 : 0, g.at);
    if (r.parts) r.parts->add(Culprit::kService, service);
  }
  s.grant(s.grants_made++) = {g.edge, arrival, g.at, at, m};
  r.in_path.accepted_at = at;
  const Taken taken = host.forward(r, at);
  bool over = false;
  if (taken != Taken::kYes) [[unlikely]] {
    if (taken == Taken::kWaits)
      s.blocked = true;
    else
      slave_done(host, r, {at, at, 0, true});
  } else if (kWrite) {
    set_write_outcome(r, scr_.edge(arrival + p.response_latency));
    charge(r, Culprit::kBridge, r.first - at);
    over = true;
  }
  // What was planned for the others stands, unless the data bus is not free then or their turn changed.
  if (waiting_ && (waiting_ & (waiting_ - 1) || next_edge_ < s.free || s.blocked)) plan();
  return over;
}

template <CrossbarHost Host>
void Crossbar::slave_accepted(Host& host, MemRequest& r, Picoseconds at, Master unblocked_by) {
  const std::uint64_t edge = reopen(r, at, unblocked_by);
  if (r.write && r.in_path.slave == static_cast<std::uint8_t>(Slave::kDdr)) acknowledge_write(host, r, edge);
  plan();
}

}  // namespace fovea::bus
