// A memory transaction on its way through crossbar and controller: the TLM payload's extension.
#pragma once
#include <cstdint>
#include <tlm>

#include "model/common/masters.h"
#include "model/common/units.h"

namespace fovea {

/// Largest burst a master may ask for; a burst never crosses a multiple of its size.
inline constexpr unsigned kMaxBurstBytes = 64;

/// The project's one extension. The payload carries command, address, length and data; this
/// carries who asks, how urgent it is, and the outcome's times. Owned by the master, which keeps
/// payload, data and extension alive until the response.
struct MemExtension : tlm::tlm_extension<MemExtension> {
  Master master = Master::kArmD;
  std::uint8_t priority = 0;        ///< 0 highest ... 7 lowest; set by the crossbar
  std::uint32_t critical = 0;       ///< byte offset in the burst that must come first (WRAP8)
  Picoseconds issued = 0;           ///< when the master put it on its port
  Picoseconds first = 0;            ///< outcome: first beat at the master's port
  Picoseconds last = 0;             ///< outcome: last beat; a write's acknowledgement
  void* owner = nullptr;            ///< the master's own record of the transaction
  /// The payload this belongs to; set by the crossbar, so that neither it nor the controller has to
  /// look up the extension again on the way back.
  tlm::tlm_generic_payload* payload = nullptr;

  tlm::tlm_extension_base* clone() const override { return new MemExtension(*this); }
  void copy_from(const tlm::tlm_extension_base& other) override {
    *this = static_cast<const MemExtension&>(other);
  }
};

}  // namespace fovea
