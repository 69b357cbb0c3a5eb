// A memory transaction on its way through crossbar and controller, and back.
#pragma once
#include <cstdint>

#include "model/common/masters.h"
#include "model/common/units.h"

namespace fovea {

class RequestWaits;

/// Largest burst a master may ask for; a burst never crosses a multiple of its size.
inline constexpr unsigned kMaxBurstBytes = 64;

/// What the memory path keeps about a request on its way. Only crossbar and memory system write it.
struct PathState {
  std::uint8_t priority = 0;    ///< 0 highest ... 7 lowest; as of the grant
  std::uint8_t slave = 0;       ///< bus::Slave
  std::uint8_t unblocked_by = 0;  ///< Master whose request made room, if it waited at the slave's input
  Picoseconds accepted_at = 0;  ///< when the slave accepted it
};

/// Owned by the master, which keeps it and the data alive until the outcome. Knows no SystemC: crossbar
/// and controller pass it by reference. Its halves: what the master sets and reads, and `in_path`. Of
/// the master's half the path changes the outcome, clears `no_side_effects` where it does not hold, and
/// makes `address` an offset while the request is at internal RAM.
struct MemRequest {
  // What the master asks for.
  std::uint32_t address = 0;
  std::uint32_t critical = 0;      ///< byte offset in the burst that must come first (WRAP8)
  std::uint8_t* data = nullptr;    ///< `bytes` bytes, in address order
  void* owner = nullptr;           ///< the master's own record of the transaction
  RequestWaits* parts = nullptr;   ///< receives the attribution of an SDRAM request; null: not wanted
  Picoseconds issued = 0;          ///< when the master puts it on its port
  Master master = Master::kArmD;
  bool write = false;
  bool locked = false;             ///< no other master reaches the slave before this master's next request
  std::uint8_t bytes = 0;          ///< 1 .. kMaxBurstBytes
  /// Completing this request wakes no process and raises no interrupt, directly or through requests that
  /// follow from it. Initiators that run ahead need not stop at its completion. An interrupt at the end
  /// of a chain of requests is a side effect of all of them.
  bool no_side_effects = false;

  // The outcome.
  bool error = false;              ///< no slave answered (bus error)
  Picoseconds first = 0;           ///< first beat at the master's port
  Picoseconds last = 0;            ///< last beat; a write's acknowledgement

  PathState in_path;
};

/// What a slave does with a request.
enum class Taken : std::uint8_t {
  kYes,
  kWaits,    ///< it waits in the slave's input register
  kRefused,  ///< no slave answers: a bus error
};

}  // namespace fovea
