// A request in the controller.
#pragma once
#include <array>
#include <cstdint>

#include "model/common/mem_request.h"
#include "model/common/waits.h"

namespace fovea::mem {

/// The controller's own copy of what it needs of a request: the master of a write goes on, and uses its
/// record for another one, as soon as the write is accepted.
struct QueuedRequest {
  MemRequest* origin = nullptr;
  std::uint8_t* data = nullptr;   // read: where to; write, in the input register: where from
  RequestWaits* parts = nullptr;  // read: gets its share of the attribution as well
  std::uint32_t address = 0;      // offset in the SDRAM
  Master master = Master::kArmD;
  std::uint8_t priority = 0;
  bool write = false;
  std::uint8_t bytes = 0;  // 1..64, inside one aligned 64-byte block
};

struct alignas(64) QueueEntry {
  QueuedRequest request;
  std::uint64_t ready = 0;  // first edge at which the scheduler sees it
  std::uint32_t row = 0;
  std::uint8_t bank = 0;
  std::uint8_t chunks = 0;  // column commands it needs
  bool classified = false;
  std::uint64_t prepared = 0;  // number of its newest ACT or PRE, from 1; 0: none
  std::array<std::uint8_t, 64> data;
};

}  // namespace fovea::mem
