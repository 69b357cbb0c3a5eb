// The wires of both buses of the remap engine at a clock edge (ARM IHI 0022). Knows neither SystemC nor Verilator.
#pragma once
#include <cstdint>

#include "model/engine/rtl/axi_checker.h"

namespace fovea::rtl {

struct ReadData {
  bool valid = false, ready = false;
  unsigned id = 0;
  std::uint64_t data = 0;
  unsigned response = 0;
  bool last = false;  ///< of its request
};
struct WriteAnswer {
  bool valid = false, ready = false;
  unsigned response = 0;
};
/// RRESP and BRESP.
inline constexpr unsigned kOkay = 0, kSlaveError = 2, kDecodeError = 3;

/// AXI4 with 64 bits. The master drives the `valid` of requests and write data, and the `ready` of
/// answers; the memory side all else.
struct AxiWires {
  Request ar, aw;
  WriteData w;
  ReadData r;
  WriteAnswer b;
};

struct LiteRequest {
  bool valid = false, ready = false;
  std::uint32_t address = 0;
};
struct LiteData {
  bool valid = false, ready = false;
  std::uint32_t data = 0;
  unsigned strobes = 0;   ///< of written data
  unsigned response = 0;  ///< of read data
};

/// AXI4-Lite with 32 bits: the register port.
struct LiteWires {
  LiteRequest aw, ar;
  LiteData w, r;
  WriteAnswer b;
};

}  // namespace fovea::rtl
