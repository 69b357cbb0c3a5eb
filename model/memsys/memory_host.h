// What a memory system needs from the program around it.
#pragma once
#include "model/bus/core/crossbar.h"
#include "model/common/mem_request.h"

namespace fovea::memsys {

/// Receives outcomes, and requests to slaves that are not part of the memory system. The calls come
/// from within MemorySystem::advance(), try_complete() or the functions that report a slave's answer;
/// the host may submit requests from within them.
class MemoryHost {
 public:
  virtual ~MemoryHost() = default;
  /// The outcome of a request is decided and written into it; its times may lie ahead.
  virtual void completed(MemRequest& request) = 0;
  /// A request to another slave than the SDRAM; it is there at `arrival`. If the slave makes it wait,
  /// the host calls MemorySystem::slave_accepted() later, and in any case slave_done() at its end.
  virtual Taken deliver(MemRequest& request, bus::Slave slave, Picoseconds arrival) = 0;
  /// Clocks or registers have moved the next event, unasked by any request.
  virtual void rescheduled() {}
};

/// Decides about a request to the SDRAM while the controller is closed (see
/// MemorySystem::set_open()) or if the request is not inside the part.
class SdramAdmission {
 public:
  virtual ~SdramAdmission() = default;
  /// False: the request ends in a bus error. True: it is served; an offset beyond the part is taken
  /// modulo its size.
  virtual bool admit(std::uint32_t offset, unsigned bytes) = 0;
};

}  // namespace fovea::memsys
