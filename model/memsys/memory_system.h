// The memory system: crossbar, SDRAM controller and memory as one component, without SystemC. The
// board, `fovea exec`, the replay of traces and the tests are users of this class.
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/bus/core/crossbar.h"
#include "model/common/arrival_observer.h"
#include "model/common/check.h"
#include "model/common/masters.h"
#include "model/common/mem_request.h"
#include "model/common/observers.h"
#include "model/contract/memory_map.h"
#include "model/mem/core/backing_store.h"
#include "model/mem/core/ddr_controller.h"
#include "model/memsys/bypass.h"
#include "model/memsys/memory_host.h"
#include "model/memsys/passive_slave.h"

namespace fovea::memsys {

/// Which slave an address belongs to.
struct AddressMap {
  std::uint32_t ddr_base = DDR_BASE;
  /// Addresses from there on that belong to the SDRAM, however large the part is (SPRS457E, memory map).
  std::uint64_t ddr_window = 256u << 20;
  /// Internal RAM, for all masters but the core's own ports, which reach it by another way.
  std::uint32_t ram_base = INTERNAL_RAM_DATA_BASE, ram_size = 0;
};

/// How the masters reach the controller.
enum class Route {
  kCrossbar,
  kBypass,  ///< without crossbar and read-return channel, to study the SDRAM alone
};

/// A passive state machine: it has events (arbitrations, DRAM commands) at times of its own, and takes
/// them when a user advances it to a time before which that user knows all requests.
class MemorySystem final : private SlowRequestTeller {
 public:
  /// @param diagnostics receives its warnings; two memory systems share them only if both are handed the same
  MemorySystem(const bus::CrossbarParams& crossbar, const mem::DdrParams& ddr, const AddressMap& map, MemoryHost& host,
               const DiagnosticsRef& diagnostics, Route route = Route::kCrossbar);
  MemorySystem(const MemorySystem&) = delete;
  MemorySystem& operator=(const MemorySystem&) = delete;

  /// Puts a request on its master's port at request.issued: not before the master's earlier ones, and
  /// not before an event that was taken already. It stays where it is until its outcome is reported.
  void submit(MemRequest& request);

  /// Time of the next event; kNever while nothing is to be done before another request comes.
  Picoseconds next_event() const {
    return std::min({crossbar_.next_decision(), controller_.next_decision(), passive_next_});
  }
  /// The one loop that takes events: all strictly before `limit`, in time order. It stops early, and
  /// returns true, after an event in which the host was called: its master may have more requests, or
  /// another process may act sooner than the caller thought.
  bool advance(Picoseconds limit);
  /// The same without stopping.
  void advance_through(Picoseconds limit) {
    while (advance(limit)) {
    }
  }

  /// What became of try_complete().
  enum class Attempt {
    kNotSubmitted,  ///< another request has a say, or the grant would come at or after the limit
    kUnderWay,      ///< granted; completed() is or was called, as after submit()
    kCompleted,     ///< the outcome is in the request; completed() is not called
  };
  /// Uncontended fast path, in place of submit(), for a request to the SDRAM by a master that runs
  /// ahead: if no other request has a say in it, it is granted at once, and the events up to its
  /// outcome are taken, all in order and strictly before `limit`.
  Attempt try_complete(MemRequest& request, Picoseconds limit);

  /// A slave outside accepts the request that it made wait.
  void slave_accepted(MemRequest& request, Picoseconds at);
  /// A slave outside has ended a request at `at`.
  void slave_done(MemRequest& request, Picoseconds at, bool error);

  /// A slave outside whose acts are events of the memory system's own. At most one, before the first request.
  void attach(PassiveSlave& slave) { passive_ = &slave; }
  /// The slave's next act; kNever: none. Later than the host's time.
  void passive_acts_at(Picoseconds t) {
    passive_next_ = t;
    host_.rescheduled();
  }

  /// Who is asked while the SDRAM is closed. None: it is always open.
  void set_admission(SdramAdmission& admission) { admission_ = &admission; }
  /// Open: requests inside the part go to the controller without a question.
  void set_open(bool open) {
    open_ = open;
    direct_ = open && arrivals_.empty();
  }
  /// Adds an observer of the controller's input. While there is one, every request counts as one with
  /// side effects, so that no agent works past an arrival that it has not seen.
  Subscription observe_arrivals(ArrivalObserver& observer) { return arrivals_.add(&observer); }
  /// The controller's clocks or registers were changed: its next event may be another one.
  void controller_changed() { host_.rescheduled(); }
  /// Takes all events at or before `now`, and brings everything that needs none up to that time, so that
  /// statistics and memory are those of `now`.
  void settle(Picoseconds now) {
    set_present(now);
    advance_through(now + 1);
    controller_.catch_up(now);
  }
  /// A debugger's access to the SDRAM, without time. @return bytes moved
  unsigned debug_access(const MemRequest& r);

  /// Number of requests under way whose completion can trigger another process (not MemRequest::no_side_effects).
  unsigned undecided() const { return undecided_; }
  /// Time of the event being taken, within a call of the host.
  Picoseconds event_time() const { return event_time_; }
  /// Of the controller's last event; 0 before the first.
  Picoseconds last_command_time() const { return last_command_; }
  /// The host's own time, to tell outcomes decided ahead of it from others. An act of the passive slave that is due is
  /// no event any more.
  void set_present(Picoseconds now) {
    present_ = now;
    if (passive_next_ <= now) {
      passive_next_ = kNever;
      passive_->act_at_present();
    }
  }
  /// Outcomes of SDRAM requests decided ahead of the host's time, and all others.
  std::uint64_t decided_ahead() const { return decided_ahead_; }
  std::uint64_t decided_at_present() const { return decided_at_present_; }

  bus::Slave slave_of(const MemRequest& r) const;
  const AddressMap& map() const { return map_; }
  /// For their clocks, registers, statistics and observers; requests come through submit() alone.
  bus::Crossbar& crossbar() { return crossbar_; }
  const bus::Crossbar& crossbar() const { return crossbar_; }
  mem::DdrController& controller() { return controller_; }
  const mem::DdrController& controller() const { return controller_; }
  mem::BackingStore& store() { return store_; }
  /// Bytes handed to the memory, by master: at the crossbar's grants, or without it at the controller.
  bus::Timeline& timeline() { return bypass_ ? bypass_->timeline : crossbar_.timeline; }
  const bus::Timeline& timeline() const {
    return bypass_ ? bypass_->timeline : crossbar_.timeline;
  }

 private:
  /// The crossbar's view of its surroundings.
  struct Link {
    MemorySystem& memory;
    Taken forward(MemRequest& r, Picoseconds arrival) { return memory.forward(r, arrival); }
    void respond(MemRequest& r) { memory.respond(r); }
  };

  void step_controller();
  void step_passive();
  template <bool kWrite>
  Attempt try_grant(MemRequest& request, Picoseconds limit);
  Taken forward(MemRequest& r, Picoseconds arrival);
  Taken arrive(MemRequest& r, Picoseconds at);
  Taken arrive_slowly(MemRequest& r, Picoseconds at);
  Taken refuse_in_order(MemRequest& r, Picoseconds at);
  void refuse_after(const MemRequest* read, Picoseconds last);
  void respond(MemRequest& r);
  void count_decided() { ++(event_time_ > present_ ? decided_ahead_ : decided_at_present_); }
  void send_directly(MemRequest& r, Picoseconds at);
  void send_waiting();
  void respond_directly(MemRequest& r, Picoseconds first, Picoseconds last);
  void tell(SlowRequest& s) const override;
  void handle_news();
  void handle_read(const mem::DdrController::ReadOutcome& read);
  void handle_acceptance(const mem::DdrController::Acceptance& accepted);

  AddressMap map_;
  MemoryHost& host_;
  SdramAdmission* admission_ = nullptr;
  Observers<ArrivalObserver*> arrivals_{[this] {
    trusting_ = arrivals_.empty();
    set_open(open_);
  }};
  bool open_ = true;
  bool direct_ = true;    // open and not observed
  bool trusting_ = true;  // requests without side effects are believed to have none
  mem::BackingStore store_;
  bus::Crossbar crossbar_;
  mem::DdrController controller_;
  std::optional<Bypass> bypass_;
  /// Reads that the SDRAM does not answer, behind older reads of their master that are still to be served.
  struct Refused {
    MemRequest* request;
    const MemRequest* behind;
    Picoseconds at;
  };
  std::vector<Refused> refused_;
  PassiveSlave* passive_ = nullptr;
  Picoseconds passive_next_ = kNever;
  const mem::DdrController::ReadOutcome* read_ = nullptr;  // whose outcome is being handled
  std::uint64_t host_calls_ = 0;
  unsigned undecided_ = 0;
  Picoseconds event_time_ = 0, last_command_ = 0, present_ = 0;
  std::uint64_t decided_ahead_ = 0, decided_at_present_ = 0;
};

}  // namespace fovea::memsys
