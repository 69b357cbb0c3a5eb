// A master that may run ahead of the kernel: the ARM core, and the traffic of the time tests.
#pragma once
#include <algorithm>
#include <memory>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/common/lookahead.h"
#include "model/common/mem_request.h"

namespace fovea::bus {

/// Runs on one SC_THREAD with a local time at or after the kernel's. It works ahead strictly before
/// the horizon H, the next event pending in the kernel; while it works it holds the memory path and
/// plays the path's decisions itself. Whatever lies at or beyond H waits for the kernel.
class Agent : public sc_core::sc_module, private tlm::tlm_bw_transport_if<> {
 public:
  struct Transaction {
    tlm::tlm_generic_payload gp;
    MemExtension ext;
    unsigned port = 0;
    bool done = true;
    Transaction() {
      gp.set_extension(&ext);
      ext.owner = this;
    }
    ~Transaction() { gp.clear_extension(&ext); }
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    bool error() const { return gp.is_response_error(); }
  };
  std::vector<std::unique_ptr<tlm::tlm_initiator_socket<32>>> sockets;
  sc_core::sc_port<MemoryPathIf> path{"path"};

  Agent(sc_core::sc_module_name name, unsigned ports);

 protected:
  /// Puts tx on its port at time `at` (not before earlier submissions of this agent). The payload's
  /// command, address, data and length are set by the caller.
  void submit(Transaction& tx, Picoseconds at);
  /// See cpu::BusPort::poll.
  bool poll(Transaction& tx, Picoseconds until);
  /// Returns when tx is done; plays background work in time order meanwhile.
  void finish(Transaction& tx);
  /// Returns when `event` fires in the kernel.
  void wait_for(sc_core::sc_event& event);
  /// Lets everybody else act before `until`; afterwards nothing is pending before it.
  void sleep_until(Picoseconds until);
  /// Nobody else acts before this time: no kernel event, and no decision of the path about a
  /// request of somebody else.
  Picoseconds horizon() {
    const Picoseconds h = next_event();
    return path_->undecided() > own_undecided_ ? std::min(h, path_->next_decision()) : h;
  }
  /// Thread body brackets: the path is the agent's between enter() and leave().
  void enter();
  void leave();

  virtual Picoseconds background_next() const { return kNever; }
  virtual void background_act() {}
  virtual void completed(Transaction&) {}

 private:
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload&, tlm::tlm_phase&,
                                     sc_core::sc_time&) override;
  void invalidate_direct_mem_ptr(sc_dt::uint64, sc_dt::uint64) override {}
  void background();
  void arm_background();
  /// kernel_horizon(), asked again only when something was notified since.
  Picoseconds next_event() {
    if (seen_epoch_ != horizon_epoch) {
      seen_epoch_ = horizon_epoch;
      next_event_ = kernel_horizon();
    }
    return next_event_;
  }

  sc_core::sc_event done_, background_due_;
  KernelNow kernel_;
  MemoryPathIf* path_ = nullptr;  // behind `path`
  Transaction* waiting_ = nullptr;
  bool running_ = false;
  unsigned own_undecided_ = 0;
  std::uint64_t seen_epoch_ = ~std::uint64_t{0};
  Picoseconds next_event_ = 0;
  Picoseconds now_ = 0;  // kernel time of the present activation
  bool strict_ = false;
};

}  // namespace fovea::bus
