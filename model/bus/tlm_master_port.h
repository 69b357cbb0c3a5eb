// A port of the memory system for an initiator that knows nothing of Fovea: the base protocol of
// IEEE 1666-2011 (TLM-2.0) on one side, the memory system's own protocol on the other.
#pragma once
#include <tlm_utils/peq_with_cb_and_phase.h>
#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <deque>
#include <list>
#include <systemc>
#include <tlm>

#include "model/common/burst_master.h"

namespace fovea::bus {

/// Approximately timed in four phases; the socket converts blocking calls. Addresses are the chip's. A
/// transaction of any length becomes bursts that each stay inside 64 aligned bytes. END_REQ comes when
/// the last of them is on the port, BEGIN_RESP with the last beat of the last one.
///
/// Not supported, and answered with the standard's error responses: byte enables, and a streaming width
/// below the length. No direct memory pointers are given: they would bypass the order of accesses.
class TlmMasterPort : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<TlmMasterPort, 32> socket{"socket"};

  TlmMasterPort(sc_core::sc_module_name name, Master master, unsigned outstanding = 4);
  /// To be bound to the memory system's target socket of that master.
  MemInitiatorSocket<32>& memory() { return bursts_.socket; }

 private:
  struct Transaction {
    tlm::tlm_generic_payload* payload;
    unsigned issued = 0;   // bytes on the port so far
    unsigned bursts = 0;   // not yet answered
    bool failed = false;
  };
  using Transactions = std::list<Transaction>;

  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);
  unsigned transport_dbg(tlm::tlm_generic_payload& payload);
  void arrived(tlm::tlm_generic_payload& payload, const tlm::tlm_phase& phase);
  void issue();
  void burst_done(const BurstMaster::Completion& c);
  void finish(Transactions::iterator t);
  void respond();
  void response_over();

  BurstMaster bursts_;
  tlm_utils::peq_with_cb_and_phase<TlmMasterPort> phases_;
  Transactions requests_;                              // in the order of BEGIN_REQ
  std::deque<tlm::tlm_generic_payload*> responses_;    // the first is in its response phase, if busy_
  bool busy_ = false;
  Timer free_;                                         // the response phase is over
};

}  // namespace fovea::bus
