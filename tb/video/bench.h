// Shared modules of the SystemC tests of the video blocks.
#pragma once
#include <tlm_utils/simple_initiator_socket.h>

#include <cstring>
#include <deque>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/common/burst_master.h"
#include "model/common/clock.h"
#include "model/common/mem_sockets.h"

namespace fovea::video {

/// A memory that answers every burst after a fixed time, in order. The outcome of a burst is
/// decided when it is submitted.
class FakeMemory : public sc_core::sc_module, private MemTargetIf {
 public:
  static constexpr std::uint32_t kBase = 0x8000'0000;
  struct Request {
    Picoseconds time;
    std::uint32_t address;
    unsigned bytes;
  };
  MemTargetSocket<32> socket{"socket"};
  std::vector<std::uint8_t> bytes;
  Picoseconds latency = 100 * kPsPerNs;
  std::vector<Request> log;

  SC_HAS_PROCESS(FakeMemory);
  explicit FakeMemory(sc_core::sc_module_name name, std::size_t size = 4 << 20)
      : sc_module(name), bytes(size) {
    socket.bind(*this);
    SC_METHOD(decide);
    sensitive << due_.event();
    dont_initialize();
  }
  std::uint8_t* at(std::uint32_t address) { return bytes.data() + (address - kBase); }

 private:
  tlm::tlm_sync_enum nb_transport_fw(MemRequest& r, MemPhase& phase, sc_core::sc_time&) override {
    if (phase != MemPhase::kRequest) return tlm::TLM_ACCEPTED;
    requests_.push_back(&r);
    decide();
    return tlm::TLM_ACCEPTED;
  }
  void decide() {
    while (!requests_.empty() && requests_.front()->issued <= kernel_time()) {
      MemRequest& r = *requests_.front();
      requests_.pop_front();
      answer(r);
    }
    if (!requests_.empty()) due_.at(requests_.front()->issued);
  }
  void answer(MemRequest& r) {
    log.push_back({r.issued, r.address, r.bytes});
    last_ = std::max(last_, r.issued + latency);
    r.first = r.last = last_;
    r.error = r.address < kBase || r.address - kBase + r.bytes > bytes.size();
    if (!r.error) {
      if (r.write)
        std::memcpy(at(r.address), r.data, r.bytes);
      else
        std::memcpy(r.data, at(r.address), r.bytes);
    }
    MemPhase response = MemPhase::kResponse;
    sc_core::sc_time zero = sc_core::SC_ZERO_TIME;
    socket->nb_transport_bw(r, response, zero);
  }
  std::deque<MemRequest*> requests_;
  Timer due_;
  Picoseconds last_ = 0;
};

/// Register access to one block, without latency.
class RegisterPort : public sc_core::sc_module {
 public:
  tlm_utils::simple_initiator_socket<RegisterPort> socket{"socket"};
  explicit RegisterPort(sc_core::sc_module_name name) : sc_module(name) {}
  void write(std::uint32_t offset, std::uint32_t value) { access(true, offset, value); }
  std::uint32_t read(std::uint32_t offset) {
    std::uint32_t value = 0;
    access(false, offset, value);
    return value;
  }

 private:
  void access(bool write, std::uint32_t offset, std::uint32_t& value) {
    tlm::tlm_generic_payload gp;
    gp.set_command(write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
    gp.set_address(offset);
    gp.set_data_ptr(reinterpret_cast<unsigned char*>(&value));
    gp.set_data_length(4);
    gp.set_streaming_width(4);
    sc_core::sc_time zero = sc_core::SC_ZERO_TIME;
    socket->b_transport(gp, zero);
  }
};

/// Records the times of rising edges.
class EdgeLog : public sc_core::sc_module {
 public:
  sc_core::sc_in<bool> in{"in"};
  std::vector<Picoseconds> rises;
  SC_HAS_PROCESS(EdgeLog);
  explicit EdgeLog(sc_core::sc_module_name name) : sc_module(name) {
    SC_METHOD(note);
    sensitive << in.pos();
    dont_initialize();
  }

 private:
  void note() { rises.push_back(kernel_time()); }
};

inline void run_for(Picoseconds ps) { sc_core::sc_start(ps_time(ps)); }
inline void run_until(Picoseconds t) {
  if (t > kernel_time()) run_for(t - kernel_time());
}

}  // namespace fovea::video
