#include "model/bus/tlm_slave_port.h"

namespace fovea::bus {
namespace {

void fill(tlm::tlm_generic_payload& p, const MemRequest& r) {
  p.set_command(r.write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
  p.set_address(r.address);
  p.set_data_ptr(r.data);
  p.set_data_length(r.bytes);
  p.set_streaming_width(r.bytes);
}

}  // namespace

TlmSlavePort::TlmSlavePort(sc_core::sc_module_name name) : sc_module(name) {
  SC_HAS_PROCESS(TlmSlavePort);
  memory.bind(*this);
  SC_THREAD(serve);
}

tlm::tlm_sync_enum TlmSlavePort::nb_transport_fw(MemRequest& r, MemPhase& phase,
                                                 sc_core::sc_time& delay) {
  if (phase != MemPhase::kRequest) return tlm::TLM_ACCEPTED;
  const Picoseconds at = kernel_time() + delay.value();
  if (arrivals_.empty()) arrived_.at(at);
  arrivals_.push_back({&r, at});
  return tlm::TLM_UPDATED;
}

void TlmSlavePort::serve() {
  for (;;) {
    while (arrivals_.empty()) wait(arrived_.event());
    const auto [request, at] = arrivals_.front();
    if (const Picoseconds now = kernel_time(); at > now) wait(ps_time(at - now));
    tlm::tlm_generic_payload payload;
    fill(payload, *request);
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    socket->b_transport(payload, delay);
    if (delay != sc_core::SC_ZERO_TIME) wait(delay);
    request->error = payload.is_response_error();
    arrivals_.pop_front();
    MemPhase phase = MemPhase::kResponse;
    delay = sc_core::SC_ZERO_TIME;
    memory->nb_transport_bw(*request, phase, delay);
  }
}

unsigned TlmSlavePort::transport_dbg(MemRequest& r) {
  tlm::tlm_generic_payload payload;
  fill(payload, r);
  return socket->transport_dbg(payload);
}

}  // namespace fovea::bus
