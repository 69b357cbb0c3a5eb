// A transfer of the EDMA: what its channel controller hands to a transfer controller, and what started it.
#pragma once
#include <cstdint>

#include "model/common/masters.h"
#include "model/common/units.h"

namespace fovea {

/// One transfer: `bcnt` arrays of `acnt` bytes. Addresses are in bytes; an index is the distance from
/// the start of an array to the start of the next one.
struct TransferRequest {
  /// Constant addressing: every access goes to the array's first bytes, `fifo_bytes` of them.
  struct Side {
    std::uint32_t address = 0;
    std::int32_t index = 0;
    bool constant = false;
    friend bool operator==(const Side&, const Side&) = default;
  };
  Side source, destination;
  std::uint16_t acnt = 0, bcnt = 0;   ///< both at least 1
  std::uint8_t fifo_bytes = 1;        ///< width of the port that constant addressing accesses
  std::uint8_t tcc = 0;               ///< completion code
  bool interrupt = false;             ///< the code sets a bit of IPR
  bool chain = false;                 ///< the code sets a bit of CER
  /// Which transfer controller has it, and how many requests that one was given before. A set that moves
  /// nothing counts too.
  std::uint8_t controller = 0;
  std::uint64_t number = 0;

  std::uint32_t bytes() const { return std::uint32_t{acnt} * bcnt; }
  friend bool operator==(const TransferRequest&, const TransferRequest&) = default;
};

/// What let a transfer request go, or set a completion code.
struct TransferTrigger {
  enum class Kind : std::uint8_t {
    kEvent,      ///< a hardware event
    kWrite,      ///< a master's write to a register of the channel controller
    kSubmitted,  ///< another request was submitted: it reports early, or moves nothing
    kEnded,      ///< another request's last write was acknowledged
  };
  Kind kind = Kind::kEvent;
  Master writer = Master::kCount;  ///< kWrite
  std::uint8_t controller = 0;     ///< kSubmitted, kEnded: of the other request
  std::uint64_t number = 0;
  Picoseconds at = 0;              ///< when that happened
};

/// Learns of the EDMA's transfers, in kernel time while a trace is recorded. An observer changes nothing.
class TransferObserver {
 public:
  virtual ~TransferObserver() = default;
  /// A master's write to a register sets a trigger.
  virtual void trigger_written(Master, Picoseconds /*at*/) {}
  /// A request, also one that moves nothing, leaves its queue. Its turn came at `ready`.
  /// @param burst the default burst size of its transfer controller, bytes
  virtual void requested(const TransferRequest&, const TransferTrigger&, unsigned /*burst*/,
                         Picoseconds /*ready*/, Picoseconds /*at*/) {}
  /// A completion code sets a bit of IPR.
  virtual void coded(const TransferTrigger&, Picoseconds /*at*/) {}
  /// The completion interrupt of the ARM's region is pulsed, because of the code set last.
  virtual void completion_pulsed(Picoseconds /*at*/) {}
};

}  // namespace fovea
