// The switched central resource: queues per master, arbitration per slave, at the edges of its own
// clock. A passive state machine like the controllers behind it.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/bus/core/crossbar_params.h"
#include "model/common/clock.h"
#include "model/common/mem_observer.h"
#include "model/common/mem_request.h"
#include "model/common/stats.h"
#include "model/common/waits.h"

namespace fovea::bus {

enum class Slave : std::uint8_t { kDdr, kConfig, kCount };
inline constexpr std::size_t kSlaveCount = static_cast<std::size_t>(Slave::kCount);

/// What the crossbar moves requests and outcomes through.
class XbarHost {
 public:
  virtual ~XbarHost() = default;
  enum class Taken {
    kYes,
    kWaits,    ///< at the slave's door; Crossbar::slave_accepted follows
    kRefused,  ///< nobody answers: a bus error
  };
  /// Sends a granted request; it is at the slave at `arrival`.
  virtual Taken forward(MemRequest& request, Picoseconds arrival) = 0;
  /// The outcome is in the request.
  virtual void respond(MemRequest& request) = 0;
};

struct MasterStats : StatGroup {
  Counter read_bytes{*this, "read_bytes", "B", "bytes read by this master"};
  Counter write_bytes{*this, "write_bytes", "B", "bytes written by this master"};
  Counter transactions{*this, "transactions", "1", "bursts and single accesses of this master"};
  /// The part that goes to the SDRAM, for the balance against ddr.*_bytes; not printed itself.
  std::uint64_t ddr_read_bytes = 0, ddr_write_bytes = 0;
  explicit MasterStats(Master m) : StatGroup("bus." + std::string(kMasterNames[index(m)])) {}

 protected:
  void on_reset() override { ddr_read_bytes = ddr_write_bytes = 0; }
};

class Crossbar {
 public:
  Crossbar(const CrossbarParams& params, XbarHost& host);
  void set_clock(Frequency scr, Picoseconds at);
  /// 0 highest .. 7; takes effect for arbitration strictly after the call's time.
  void set_priority(Master m, unsigned priority);

  /// Looks on at all requests; null: nobody. Gives back who did before.
  MemObserver* observe(MemObserver* observer) { return std::exchange(observer_, observer); }

  /// Puts a request on its master's port at request.issued: not before the master's earlier ones,
  /// and before any decision later than that was taken. It stays where it is until its response.
  void submit(MemRequest& request, Slave slave);
  /// The next arbitration, kNever if there is nothing to arbitrate.
  Picoseconds next_decision() const { return next_; }
  const Picoseconds* next_decision_place() const { return &next_; }
  void step() { step(host_); }
  /// The same for a host of known type: its forward() and respond() are called directly.
  template <class Host>
  void step(Host& host);

  /// Slave side: the request waiting at the slave was taken at `at`.
  void slave_accepted(MemRequest& request, Picoseconds at);
  /// Slave side: read data on the crossbar from first to last; or a register access that ended.
  void slave_done(MemRequest& request, Picoseconds first, Picoseconds last, bool error);

  std::array<std::unique_ptr<MasterStats>, kMasterCount> stats;
  /// Bytes granted, per interval of simulated time since the start of the run.
  struct TimelineBin {
    std::array<std::uint64_t, kMasterCount> read{}, write{};
  };
  const std::vector<TimelineBin>& timeline() const { return timeline_; }
  Picoseconds timeline_interval() const { return interval_; }
  /// Time between issue and arrival at the SDRAM, and from there back to the port.
  WaitTable waits;

  /// What stands where at a time, for a debugger.
  struct View {
    struct Item {
      const MemRequest* request;
      Picoseconds crossed;  ///< through its bridge; kNever while the clock stands
      bool head;            ///< of its master's queue: competes for the slave
    };
    struct SlaveView {
      bool blocked = false;           ///< the last granted request waits at its door
      Picoseconds free = 0;           ///< its command lane; 0: free already
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
  static constexpr std::size_t kQueue = 32;  // as deep as any master's outstanding limit
  struct Port {
    struct Item {
      MemRequest* request;
      std::uint64_t visible;  // edge from which the arbiter sees it
      std::uint64_t crossed;  // edge at which it is through the bridge
    };
    std::array<Item, kQueue> queue;
    std::uint32_t head = 0, tail = 0;
    Item& front() { return queue[head % kQueue]; }
    const Item& front() const { return queue[head % kQueue]; }
    std::uint8_t priority = 7;
    std::uint8_t request_latency = 0, response_latency = 0;
    std::array<Picoseconds, 2> answered{};  // last beat of the newest outcome; reads, writes
    bool empty() const { return head == tail; }
  };
  /// The lane was the master's from `start` on, up to the next one's start or `end`.
  struct Grant {
    std::uint64_t start = 0, end = 0;
    std::uint8_t master = 0;
  };
  struct SlaveState {
    static constexpr std::size_t kGrants = 64;
    std::uint64_t free = 0;      // first edge at which its command lane is free
    std::uint32_t grants_made = 0;
    std::array<Grant, kGrants> grants;  // the last ones, to say who was waited for
    Grant& grant(std::uint32_t n) { return grants[n % kGrants]; }
    bool blocked = false;        // a request waits at its door
    std::uint8_t last = 0;       // round robin: last master granted
    std::uint32_t open_to = ~0u; // masters it serves: all, or the one that locked it
  };

  void plan();
  void set_lock(SlaveState& s, const MemRequest& r);
  const SlaveState& slave_of(const MemRequest& r) const { return slaves_[r.slave]; }
  bool barred(const SlaveState& s, unsigned master) const {
    return s.blocked || !(s.open_to >> master & 1u);
  }
  template <class Host>
  void acknowledge_write(Host& host, MemRequest& request, std::uint64_t edge) {
    const Picoseconds at = scr_.edge(edge + ports_[index(request.master)].response_latency);
    set_outcome(request, at, at);
    request.error = false;
    waits_of(request).add(Culprit::kBridge, request.first - request.taken);
    if (observer_) [[unlikely]]
      observer_->responded(request);
    host.respond(request);
  }
  /// A master sees its outcomes in order, also when a faster clock would have the later one pass an
  /// earlier one that was decided before the change.
  void set_outcome(MemRequest& r, Picoseconds first, Picoseconds last) {
    Picoseconds& newest = ports_[index(r.master)].answered[r.write];
    r.first = std::max(first, newest);
    r.last = newest = std::max(last, r.first);
  }
  void count(const MemRequest& r);
  /// The parts of request.issued .. grant at `edge`.
  void attribute(SlaveState& s, const MemRequest& r, std::uint64_t crossed, std::uint64_t edge);
  Waits& waits_of(const MemRequest& r) {
    MasterWaits& w = waits[index(r.master)];
    return r.write ? w.write : w.read;
  }

  XbarHost& host_;
  MemObserver* observer_ = nullptr;
  Clock scr_;
  std::array<Port, kMasterCount> ports_;
  std::array<SlaveState, kSlaveCount> slaves_;
  std::uint32_t waiting_ = 0;  // ports with a queue
  std::uint64_t next_edge_ = 0;
  std::uint8_t next_port_ = 0;
  Picoseconds next_ = kNever;
  Picoseconds interval_;
  Picoseconds bin_end_ = 0;
  std::vector<TimelineBin> timeline_;
};

/// What a grant adds to the statistics.
inline void Crossbar::count(const MemRequest& r) {
  MasterStats& st = *stats[next_port_];
  ++st.transactions;
  (r.write ? st.write_bytes : st.read_bytes) += r.bytes;
  if (r.slave == static_cast<std::uint8_t>(Slave::kDdr))
    (r.write ? st.ddr_write_bytes : st.ddr_read_bytes) += r.bytes;
  if (next_ >= bin_end_ || timeline_.empty()) [[unlikely]] {
    timeline_.resize(next_ / interval_ + 1);
    bin_end_ = (next_ / interval_ + 1) * interval_;
  }
  (r.write ? timeline_.back().write : timeline_.back().read)[next_port_] += r.bytes;
}

template <class Host>
void Crossbar::step(Host& host) {
  Port& p = ports_[next_port_];
  MemRequest& r = *p.front().request;
  const std::uint64_t crossed = p.front().crossed;
  if (++p.head == p.tail) {
    waiting_ &= ~(1u << next_port_);
  } else {  // the next in line shows itself one clock later
    auto& visible = p.front().visible;
    visible = std::max(visible, next_edge_ + 1);
  }
  r.priority = p.priority;
  SlaveState& s = slaves_[r.slave];
  const unsigned cycles = r.write ? (r.bytes + 7u) / 8u : 1u;
  s.free = next_edge_ + cycles;
  s.last = next_port_;
  if (r.locked || s.open_to != ~0u) [[unlikely]] set_lock(s, r);
  count(r);

  const std::uint64_t arrival = next_edge_ + cycles;
  const Picoseconds at = scr_.edge(arrival);
  if (r.slave == static_cast<std::uint8_t>(Slave::kDdr)) {
    if (crossed == next_edge_)
      waits_of(r).add(Culprit::kBridge, next_ - r.issued);
    else
      attribute(s, r, crossed, next_edge_);
    waits_of(r).add(Culprit::kService, at - next_);
  }
  s.grant(s.grants_made++) = {next_edge_, arrival, next_port_};
  r.taken = at;
  const XbarHost::Taken taken = host.forward(r, at);
  if (taken == XbarHost::Taken::kWaits)
    s.blocked = true;
  else if (taken == XbarHost::Taken::kRefused)
    slave_done(r, at, at, true);
  else if (r.write && r.slave == static_cast<std::uint8_t>(Slave::kDdr))
    acknowledge_write(host, r, arrival);
  if (waiting_)
    plan();
  else
    next_ = kNever;
}

}  // namespace fovea::bus
