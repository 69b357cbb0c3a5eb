// Shared code of the peripheral tests: a register bus, and stepping of simulated time.
#pragma once
#include <gtest/gtest.h>
#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>
#include <systemc>
#include <tlm>

#include "model/common/sc_ports.h"
#include "model/common/units.h"

namespace fovea::test {

inline Picoseconds now() { return sc_core::sc_time_stamp().value(); }

/// Lets all activity of the present instant happen.
inline void settle() {
  static bool elaborated = false;
  while (!elaborated || sc_core::sc_pending_activity_at_current_time()) {
    elaborated = true;
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }
}

/// Advances to the absolute time t and lets all activity of that instant happen.
inline void run_until(Picoseconds t) {
  if (t > now()) sc_core::sc_start(sc_core::sc_time::from_value(t - now()));
  settle();
}

/// Register accesses as the configuration bus makes them: after all other activity of the instant.
struct Bus : sc_core::sc_module {
  tlm_utils::simple_initiator_socket<Bus> socket{"socket"};
  explicit Bus(sc_core::sc_module_name name) : sc_module(name) {}

  std::uint32_t read(std::uint32_t offset, unsigned bytes = 4) {
    std::uint32_t value = 0;
    access(tlm::TLM_READ_COMMAND, offset, value, bytes);
    return value;
  }
  void write(std::uint32_t offset, std::uint32_t value, unsigned bytes = 4) {
    access(tlm::TLM_WRITE_COMMAND, offset, value, bytes);
  }

 private:
  void access(tlm::tlm_command command, std::uint32_t offset, std::uint32_t& value,
              unsigned bytes) {
    settle();
    tlm::tlm_generic_payload gp;
    gp.set_command(command);
    gp.set_address(offset);
    gp.set_data_ptr(reinterpret_cast<unsigned char*>(&value));
    gp.set_data_length(bytes);
    gp.set_streaming_width(bytes);
    sc_core::sc_time delay;
    socket->b_transport(gp, delay);
    ASSERT_EQ(gp.get_response_status(), tlm::TLM_OK_RESPONSE);
    settle();
  }
};

/// Counts the edges of a line and records the times of the last ones.
struct Probe : sc_core::sc_module {
  SC_HAS_PROCESS(Probe);
  sc_core::sc_in<bool> in{"in"};
  unsigned rises = 0, falls = 0;
  Picoseconds last_rise = 0, last_fall = 0;
  explicit Probe(sc_core::sc_module_name name) : sc_module(name) {
    SC_METHOD(look);
    sensitive << in;
    dont_initialize();
  }
  void look() {
    if (in.read()) {
      ++rises;
      last_rise = now();
    } else {
      ++falls;
      last_fall = now();
    }
  }
};

}  // namespace fovea::test

#define FOVEA_SC_TEST_MAIN                \
  int sc_main(int argc, char** argv) {    \
    testing::InitGoogleTest(&argc, argv); \
    return RUN_ALL_TESTS();               \
  }
