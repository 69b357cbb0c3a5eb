// TLM-2.0 sockets of the memory path: the non-blocking transport of the standard with a payload of
// our own (decision 0005).
#pragma once
#include <systemc>
#include <tlm>

#include "model/common/mem_request.h"

namespace fovea {

enum class MemPhase : std::uint8_t {
  kRequest,   ///< forward: the request is on the port at MemRequest::issued
  kAccepted,  ///< backward, from a slave: accepted from its input register
  kResponse,  ///< backward: the outcome is decided; its times may lie ahead
  kRefused,   ///< backward, from a slave: the same, and the outcome is that nothing answers
};

struct MemProtocol {
  using tlm_payload_type = MemRequest;
  using tlm_phase_type = MemPhase;
};

template <unsigned kWidth>
using MemInitiatorSocket = tlm::tlm_initiator_socket<kWidth, MemProtocol>;
/// A port without a master stays unbound.
template <unsigned kWidth>
using MemTargetSocket =
    tlm::tlm_target_socket<kWidth, MemProtocol, 1, sc_core::SC_ZERO_OR_MORE_BOUND>;

/// A target without the blocking call (it would bypass the order of the path) and without direct
/// memory pointers.
class MemTargetIf : public tlm::tlm_fw_transport_if<MemProtocol> {
 public:
  void b_transport(MemRequest& r, sc_core::sc_time&) override { r.error = true; }
  bool get_direct_mem_ptr(MemRequest&, tlm::tlm_dmi&) override { return false; }
  unsigned transport_dbg(MemRequest&) override { return 0; }
};

class MemInitiatorIf : public tlm::tlm_bw_transport_if<MemProtocol> {
 public:
  void invalidate_direct_mem_ptr(sc_dt::uint64, sc_dt::uint64) override {}
};

}  // namespace fovea
