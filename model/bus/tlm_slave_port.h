// A slave port of the memory system for a target that knows nothing of Fovea: it is called by
// b_transport, as IEEE 1666-2011 (TLM-2.0) has it for loosely timed targets.
#pragma once
#include <tlm_utils/simple_initiator_socket.h>

#include <deque>
#include <systemc>
#include <tlm>

#include "model/common/timer.h"
#include "model/common/mem_sockets.h"

namespace fovea::bus {

/// Requests are served one after another, in the order of their arrival. The target is called at the
/// request's own time; what it adds to the delay, or waits, is its latency. Addresses are offsets in
/// the slave.
class TlmSlavePort : public sc_core::sc_module, public MemTargetIf {
 public:
  MemTargetSocket<32> memory{"memory"};  ///< towards the memory system
  tlm_utils::simple_initiator_socket<TlmSlavePort, 32> socket{"socket"};

  explicit TlmSlavePort(sc_core::sc_module_name name);

  tlm::tlm_sync_enum nb_transport_fw(MemRequest&, MemPhase&, sc_core::sc_time&) override;
  unsigned transport_dbg(MemRequest&) override;

 private:
  struct Arrival {
    MemRequest* request;
    Picoseconds at;
  };
  void serve();

  std::deque<Arrival> arrivals_;
  Timer arrived_;
};

}  // namespace fovea::bus
