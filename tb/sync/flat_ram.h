// A slave of the crossbar beside the SDRAM, in the place of the core's internal RAM: plain memory that serves one
// burst after the other, as TcmDma does, in a time that depends on its length alone.
#pragma once
#include <cstdint>
#include <cstring>
#include <deque>
#include <systemc>
#include <vector>

#include "model/common/end_of_instant.h"
#include "model/common/mem_sockets.h"

namespace fovea::sync {

class FlatRam : public sc_core::sc_module, public MemTargetIf {
 public:
  MemTargetSocket<32> socket{"socket"};
  std::vector<std::uint8_t> bytes;

  FlatRam(sc_core::sc_module_name name, std::uint32_t size, EndOfInstant& end_of_instant)
      : sc_module(name), bytes(size), end_of_instant_(end_of_instant) {
    socket.bind(*this);
    for (std::uint32_t n = 0; n < size; ++n) bytes[n] = static_cast<std::uint8_t>(n * 11 + (n >> 8));
  }

  tlm::tlm_sync_enum nb_transport_fw(MemRequest& r, MemPhase& phase, sc_core::sc_time& delay) override {
    if (phase != MemPhase::kRequest) return tlm::TLM_ACCEPTED;
    queue_.push_back({&r, kernel_time() + delay.value()});
    if (queue_.size() == 1) serve();
    return tlm::TLM_UPDATED;
  }

 private:
  struct Waiting {
    MemRequest* request;
    Picoseconds arrival;
  };
  void serve() {
    const Waiting& w = queue_.front();
    const Picoseconds begin = std::max(w.arrival, kernel_time());
    end_of_instant_.at(begin + 10 * kPsPerNs + w.request->bytes * 840, instant_rank(w.request->master),
                       [this] { finish(); });
  }
  void finish() {
    MemRequest& r = *queue_.front().request;
    queue_.pop_front();
    std::uint8_t* const at = bytes.data() + r.address;
    r.write ? std::memcpy(at, r.data, r.bytes) : std::memcpy(r.data, at, r.bytes);
    r.error = false;
    MemPhase phase = MemPhase::kResponse;
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    socket->nb_transport_bw(r, phase, delay);
    if (!queue_.empty()) serve();
  }

  EndOfInstant& end_of_instant_;
  std::deque<Waiting> queue_;
};

}  // namespace fovea::sync
