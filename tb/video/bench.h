// Pieces that the SystemC tests of the video blocks share.
#pragma once
#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <cstring>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/common/burst_master.h"
#include "model/common/clock.h"
#include "model/common/mem_request.h"

namespace fovea::video {

/// A memory that answers every burst after a fixed time, in order.
class FakeMemory : public sc_core::sc_module {
 public:
  static constexpr std::uint32_t kBase = 0x8000'0000;
  struct Request {
    Picoseconds time;
    std::uint32_t address;
    unsigned bytes;
  };
  tlm_utils::simple_target_socket<FakeMemory> socket{"socket"};
  std::vector<std::uint8_t> bytes;
  Picoseconds latency = 100 * kPsPerNs;
  std::vector<Request> log;

  explicit FakeMemory(sc_core::sc_module_name name, std::size_t size = 4 << 20)
      : sc_module(name), bytes(size) {
    socket.register_nb_transport_fw(this, &FakeMemory::nb_transport_fw);
  }
  std::uint8_t* at(std::uint32_t address) { return bytes.data() + (address - kBase); }

 private:
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& gp, tlm::tlm_phase& phase,
                                     sc_core::sc_time&) {
    if (phase != tlm::BEGIN_REQ) return tlm::TLM_ACCEPTED;
    const auto address = static_cast<std::uint32_t>(gp.get_address());
    const unsigned n = gp.get_data_length();
    log.push_back({kernel_now(), address, n});
    MemExtension* ext = nullptr;
    gp.get_extension(ext);
    last_ = std::max(last_, kernel_now() + latency);
    ext->first = ext->last = last_;
    if (address >= kBase && address - kBase + n <= bytes.size()) {
      if (gp.is_write())
        std::memcpy(at(address), gp.get_data_ptr(), n);
      else
        std::memcpy(gp.get_data_ptr(), at(address), n);
      gp.set_response_status(tlm::TLM_OK_RESPONSE);
    } else {
      gp.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
    }
    tlm::tlm_phase response = tlm::BEGIN_RESP;
    sc_core::sc_time zero = sc_core::SC_ZERO_TIME;
    socket->nb_transport_bw(gp, response, zero);
    return tlm::TLM_ACCEPTED;
  }
  Picoseconds last_ = 0;
};

/// Register access to one block, without time.
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

/// Notes the times of rising edges.
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
  void note() { rises.push_back(kernel_now()); }
};

inline void run_for(Picoseconds ps) { sc_core::sc_start(to_sc_time(ps)); }
inline void run_until(Picoseconds t) {
  if (t > kernel_now()) run_for(t - kernel_now());
}

}  // namespace fovea::video
