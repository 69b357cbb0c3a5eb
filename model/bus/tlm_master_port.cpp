#include "model/bus/tlm_master_port.h"

#include <algorithm>

namespace fovea::bus {
namespace {

/// What the memory system cannot do at all; TLM_OK_RESPONSE if there is no such thing.
tlm::tlm_response_status unsupported(const tlm::tlm_generic_payload& p) {
  if (p.get_byte_enable_ptr()) return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  if (p.get_data_length() == 0 || p.get_streaming_width() < p.get_data_length())
    return tlm::TLM_BURST_ERROR_RESPONSE;
  if (p.get_address() + p.get_data_length() > std::uint64_t{1} << 32)
    return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

/// Bytes from `address` on up to `left`, inside one aligned block.
unsigned burst_of(std::uint64_t address, unsigned left) {
  return std::min<unsigned>(left, kMaxBurstBytes - static_cast<unsigned>(address % kMaxBurstBytes));
}

}  // namespace

TlmMasterPort::TlmMasterPort(sc_core::sc_module_name name, Master master, unsigned outstanding)
    : sc_module(name), bursts_("bursts", master, outstanding), phases_(this, &TlmMasterPort::arrived) {
  SC_HAS_PROCESS(TlmMasterPort);
  socket.register_nb_transport_fw(this, &TlmMasterPort::nb_transport_fw);
  socket.register_transport_dbg(this, &TlmMasterPort::transport_dbg);
  bursts_.on_done = [this](const BurstMaster::Completion& c) { burst_done(c); };
  SC_METHOD(response_over);
  sensitive << free_.event();
  dont_initialize();
}

tlm::tlm_sync_enum TlmMasterPort::nb_transport_fw(tlm::tlm_generic_payload& payload,
                                                  tlm::tlm_phase& phase, sc_core::sc_time& delay) {
  if (phase == tlm::BEGIN_REQ && payload.has_mm()) payload.acquire();
  phases_.notify(payload, phase, delay);
  return tlm::TLM_ACCEPTED;
}

/// A phase of the initiator, at its own time.
void TlmMasterPort::arrived(tlm::tlm_generic_payload& payload, const tlm::tlm_phase& phase) {
  if (phase == tlm::BEGIN_REQ) {
    requests_.push_back({&payload});
    issue();
  } else if (phase == tlm::END_RESP) {
    busy_ = false;
    if (payload.has_mm()) payload.release();
    respond();
  }
}

/// Puts bursts of the oldest transaction that is not wholly on the port there, as far as they may be
/// outstanding; several transactions overlap.
void TlmMasterPort::issue() {
  for (auto t = requests_.begin(); t != requests_.end();) {
    tlm::tlm_generic_payload& p = *t->payload;
    const unsigned length = p.get_data_length();
    const bool nothing_to_do =
        unsupported(p) != tlm::TLM_OK_RESPONSE || p.get_command() == tlm::TLM_IGNORE_COMMAND;
    const bool was_complete = !nothing_to_do && t->issued == length;
    while (!nothing_to_do && t->issued < length) {
      if (!bursts_.can_issue()) return;
      const auto address = static_cast<std::uint32_t>(p.get_address() + t->issued);
      const unsigned n = burst_of(address, length - t->issued);
      const auto tag = reinterpret_cast<std::uintptr_t>(&*t);
      if (p.is_write())
        bursts_.write(address, {p.get_data_ptr() + t->issued, n}, tag);
      else
        bursts_.read(address, n, tag);
      t->issued += n;
      ++t->bursts;
    }
    const auto next = std::next(t);
    if (!was_complete) {
      tlm::tlm_phase phase = tlm::END_REQ;
      sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
      socket->nb_transport_bw(p, phase, delay);
      if (nothing_to_do) finish(t);
    }
    t = next;
  }
}

void TlmMasterPort::burst_done(const BurstMaster::Completion& c) {
  const auto t = std::find_if(requests_.begin(), requests_.end(), [&](const Transaction& r) {
    return reinterpret_cast<std::uintptr_t>(&r) == c.tag;
  });
  tlm::tlm_generic_payload& p = *t->payload;
  if (!c.write)
    std::copy(c.data.begin(), c.data.end(), p.get_data_ptr() + (c.address - p.get_address()));
  t->failed |= c.error;
  if (--t->bursts == 0 && t->issued == p.get_data_length()) finish(t);
  issue();
}

void TlmMasterPort::finish(Transactions::iterator t) {
  tlm::tlm_generic_payload& p = *t->payload;
  p.set_response_status(t->failed ? tlm::TLM_ADDRESS_ERROR_RESPONSE : unsupported(p));
  requests_.erase(t);
  responses_.push_back(&p);
  respond();
}

void TlmMasterPort::response_over() {
  busy_ = false;
  respond();
}

/// One transaction at a time is in its response phase.
void TlmMasterPort::respond() {
  while (!busy_ && !responses_.empty()) {
    tlm::tlm_generic_payload& p = *responses_.front();
    responses_.pop_front();
    busy_ = true;
    tlm::tlm_phase phase = tlm::BEGIN_RESP;
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    const tlm::tlm_sync_enum status = socket->nb_transport_bw(p, phase, delay);
    const bool ended = status == tlm::TLM_COMPLETED ||
                       (status == tlm::TLM_UPDATED && phase == tlm::END_RESP);
    if (!ended) return;  // END_RESP follows
    if (p.has_mm()) p.release();
    busy_ = false;
    if (delay == sc_core::SC_ZERO_TIME) continue;
    busy_ = true;  // until then
    free_.at(kernel_time() + delay.value());
    return;
  }
}

unsigned TlmMasterPort::transport_dbg(tlm::tlm_generic_payload& p) {
  unsigned done = 0;
  while (done < p.get_data_length()) {
    MemRequest r;
    r.address = static_cast<std::uint32_t>(p.get_address() + done);
    r.data = p.get_data_ptr() + done;
    const unsigned n = burst_of(r.address, p.get_data_length() - done);
    r.bytes = static_cast<std::uint8_t>(n);
    r.write = p.is_write();
    if (bursts_.socket->transport_dbg(r) != n) break;
    done += n;
  }
  return done;
}

}  // namespace fovea::bus
