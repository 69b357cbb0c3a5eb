// A master that may run ahead of the kernel: the ARM core, and the traffic of the time tests.
#pragma once
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

#include "model/bus/memory_path.h"
#include "model/common/check.h"
#include "model/common/timer.h"
#include "model/common/mem_sockets.h"

namespace fovea::bus {

/// Runs on one SC_THREAD with a local time at or after the kernel's. It works ahead strictly before
/// the horizon H, the next event pending in the kernel; while it works it holds the memory path and
/// takes the path's events itself. Whatever lies at or beyond H waits for the kernel.
///
/// The derived class, Self, can do background work beside the path: if it hides background_next(),
/// background_act() or completed(), its own functions are called at every step.
///
/// MemInitiatorIf is a public base although only the own sockets call it: it has SystemC's virtual base,
/// which the most derived class destroys, and a private base would bar the way to it (CWG 7).
template <class Self>
class LookaheadInitiator : public sc_core::sc_module, public MemInitiatorIf {
 public:
  struct Transaction : MemRequest {
    unsigned port = 0;
    bool done = true;
    Transaction() { owner = this; }
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
  };
  std::vector<std::unique_ptr<MemInitiatorSocket<32>>> sockets;
  sc_core::sc_port<MemoryPathIf> path{"path"};

  LookaheadInitiator(sc_core::sc_module_name name, unsigned ports) : sc_module(name) {
    for (unsigned i = 0; i < ports; ++i) {
      sockets.push_back(
          std::make_unique<MemInitiatorSocket<32>>(("socket_" + std::to_string(i)).c_str()));
      sockets.back()->bind(*this);
    }
    FOVEA_CHECK(ports <= ports_.size(), "a look-ahead initiator with too many ports");
    SC_HAS_PROCESS(LookaheadInitiator);
    SC_METHOD(background);
    sensitive << background_due_.event();
    dont_initialize();
  }

 protected:
  /// Puts tx on its port at time `at` (not before earlier submissions of this agent). The caller has
  /// set what a master sets in a MemRequest.
  void submit(Transaction& tx, Picoseconds at) {
    tx.done = tx.error = false;
    tx.issued = at;
    // The usual case of submit_any(): nothing else is under way, and no kernel event comes before `at`.
    if (running_ && !deferred_ && own_undecided_ == 0 && tx.address >= ports_[tx.port].deferred_from &&
        at >= now_ && at < next_event()) [[likely]]
      deferred_ = &tx;
    else
      submit_any(tx, at);
  }
  /// See cpu::BusPort::poll.
  bool poll(Transaction& tx, Picoseconds until) {
    if (strict_) {
      sleep_until(until);
      return tx.done && tx.last <= until;
    }
    for (;;) {
      if (tx.done) return tx.last <= until;
      if (deferred_ == &tx) {
        if (until < tx.issued + ports_[tx.port].least_latency) return false;
        try_deferred(until);
        continue;
      }
      const Picoseconds t = next_decision();
      const Picoseconds h = next_event();
      if (std::min(t, h) >= until) return false;
      if (t >= h) {
        // Another process may still act before `until`: wait in the kernel.
        sleep_until(until);
        return tx.done && tx.last <= until;
      }
      memory_->advance(std::min(until, h));
    }
  }
  /// Returns when tx is done; does background work in time order meanwhile.
  void finish(Transaction& tx) {
    if (deferred_ == &tx) try_deferred(self().background_next());
    if (!tx.done) finish_queued(tx);
  }
  /// Returns when `timer` fires in the kernel.
  void wait_for(const Timer& timer) {
    leave();
    sc_core::wait(timer.event());
    enter();
  }
  /// Lets all other processes act before `until`; afterwards nothing is pending before it.
  [[gnu::noinline]] void sleep_until(Picoseconds until) {
    const Picoseconds now = now_;
    if (until <= now) return;
    submit_deferred();
    if (!strict_) {
      // No process switch if all that lies before `until` is in the path and can be taken here.
      for (;;) {
        const Picoseconds t = next_decision();
        const Picoseconds b = self().background_next();
        const Picoseconds h = next_event();
        if (std::min({t, b, h}) >= until) return;
        if (std::min(t, b) >= h) break;
        if (b <= t) {
          self().background_act();
          submit_deferred();  // the decisions that follow are behind what it asked for
        } else {
          memory_->advance(std::min({until, b, h}));
        }
      }
    }
    leave();
    sc_core::wait(ps_time(until - now));
    enter();
  }
  /// From the issue of a request on this port to its outcome it takes at least this long.
  Picoseconds least_latency(unsigned port) const { return ports_[port].least_latency; }
  /// No other process acts before this time: there is no kernel event, and no decision of the path about another
  /// master's request that may let that master act, or about an own request that may let a register block
  /// act.
  Picoseconds horizon() {
    const Picoseconds h = next_event();
    return memory_->undecided() > own_undecided_ ? std::min(h, next_decision()) : h;
  }
  /// True for an access to the SDRAM: its completion by itself triggers no other process.
  bool in_memory(const Transaction& tx) const { return tx.address >= sdram_base_; }
  /// The time of the next background work is another one now.
  void background_moved() {
    if (!running_) arm_background();
  }
  /// Called at the start and end of each activation of the thread. In between this initiator advances the
  /// memory system instead of the kernel.
  void enter() {
    running_ = true;
    if (!path_) {
      path_ = path.operator->();
      strict_ = path_->strict();
      memory_ = &path_->memory();
      // An observer disables deferral, so that it sees each request when it is issued.
      sdram_base_ = memory_->crossbar().observed() ? kNever : memory_->map().ddr_base;
    }
    if (!strict_) {
      deferred_base_ = sdram_base_;
      for (Port& p : ports_) {
        p.least_latency = memory_->crossbar().least_latency(p.master);
        if (p.known) p.deferred_from = deferred_base_;
      }
    }
    now_ = kernel_();
    background_due_.cancel();
    path_->hold();
    horizon_.forget();
  }
  void leave() {
    submit_deferred();
    running_ = false;
    arm_background();
    path_->release();
  }

  Picoseconds next_event() { return horizon_(); }

  Picoseconds background_next() const { return kNever; }
  void background_act() {}
  void completed(Transaction&) {}

 private:
  struct Port {
    bool known = false;  // `master`, once a request has gone through it
    std::uint64_t deferred_from = kNever;  // requests to addresses from here on may be deferred
    Master master = Master::kArmD;
    Picoseconds least_latency = 0;
  };

  Self& self() { return static_cast<Self&>(*this); }
  [[gnu::noinline]] void submit_any(Transaction& tx, Picoseconds at) {
    const Picoseconds now = running_ ? now_ : kernel_();
    // Ahead of the kernel only strictly before H; at `now` the order within the instant is harmless.
    if (at > now && (strict_ || at >= next_event())) sleep_until(at);
    FOVEA_CHECK(at >= now, "a request in the past");
    submit_deferred();
    if (running_ && own_undecided_ == 0 && tx.address >= ports_[tx.port].deferred_from)
      deferred_ = &tx;
    else
      put_on_port(tx);
  }
  [[gnu::noinline]] void finish_queued(Transaction& tx) {
    while (!tx.done) {
      if (deferred_) {
        try_deferred(self().background_next());
        continue;
      }
      if (!strict_) {
        const Picoseconds t = next_decision();
        const Picoseconds b = self().background_next();
        const Picoseconds h = next_event();
        if (std::min(t, b) < h) {
          if (b <= t)
            self().background_act();
          else
            memory_->advance(std::min(b, h));
          continue;
        }
      }
      waiting_ = &tx;
      wait_for(done_);
      waiting_ = nullptr;
    }
  }
  [[gnu::noinline]] void put_on_port(Transaction& tx) {
    MemPhase phase = MemPhase::kRequest;
    const Picoseconds now = running_ ? now_ : kernel_();
    sc_core::sc_time delay = ps_time(tx.issued > now ? tx.issued - now : 0);
    (*sockets[tx.port])->nb_transport_fw(tx, phase, delay);
    own_undecided_ += to_memory(tx);
    Port& p = ports_[tx.port];
    p.known = true;
    p.master = tx.master;
    p.deferred_from = deferred_base_;
  }
  /// The deferred request takes the ordinary route: others may come in between.
  void submit_deferred() {
    if (deferred_) put_on_port(*std::exchange(deferred_, nullptr));
  }
  void try_deferred(Picoseconds limit) {
    Transaction& tx = *std::exchange(deferred_, nullptr);
    tx.master = ports_[tx.port].master;
    ++own_undecided_;
    using Attempt = memsys::MemorySystem::Attempt;
    switch (memory_->try_complete(tx, std::min(limit, next_event()))) {
      case Attempt::kCompleted:
        --own_undecided_;
        tx.done = true;
        self().completed(tx);
        break;
      case Attempt::kNotSubmitted:
        --own_undecided_;
        put_on_port(tx);
        break;
      case Attempt::kUnderWay: break;
    }
  }
  bool to_memory(const Transaction& tx) const { return tx.address >= memory_->map().ddr_base; }
  Picoseconds next_decision() const { return memory_->next_event(); }

  tlm::tlm_sync_enum nb_transport_bw(MemRequest& r, MemPhase& phase, sc_core::sc_time&) override {
    if (phase != MemPhase::kResponse) return tlm::TLM_ACCEPTED;
    auto& tx = static_cast<Transaction&>(r);
    tx.done = true;
    own_undecided_ -= to_memory(tx);
    self().completed(tx);
    if (!running_) {
      if (waiting_ == &tx) done_.at(tx.first);
      arm_background();
    }
    return tlm::TLM_COMPLETED;
  }
  void background() {
    if (running_) return;
    while (self().background_next() <= kernel_time()) self().background_act();
    arm_background();
  }
  void arm_background() {
    background_due_.at(self().background_next());
  }

  Timer done_, background_due_;
  KernelNow kernel_;
  MemoryPathIf* path_ = nullptr;  // behind `path`
  memsys::MemorySystem* memory_ = nullptr;
  Transaction* waiting_ = nullptr;
  /// The newest request, not yet on its port: most often its master waits for it next and no other request
  /// comes between, so that it need not go through the queues.
  Transaction* deferred_ = nullptr;
  std::array<Port, 8> ports_;
  std::uint64_t sdram_base_ = kNever;
  std::uint64_t deferred_base_ = kNever;  // from here on requests may be deferred
  bool running_ = false;
  unsigned own_undecided_ = 0;  // own requests to memory: they let only this agent act
  Horizon horizon_;
  Picoseconds now_ = 0;  // kernel time of the present activation
  bool strict_ = false;
};

}  // namespace fovea::bus
