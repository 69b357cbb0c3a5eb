// Interface for observers of the core's internal RAM.
#pragma once
#include <cstdint>

#include "model/common/masters.h"
#include "model/common/units.h"

namespace fovea {

/// Learns what the core loads from internal RAM and what others write there: how a program sees that a
/// transfer has ended. An observer changes nothing; while there is one, loads from internal RAM cost more
/// host time.
class RamWatch {
 public:
  virtual ~RamWatch() = default;
  /// A load at a clock of the core, in the order of the program.
  /// @param room_waits clocks that the core has waited for room in its write buffers so far
  virtual void loaded(std::uint32_t offset, unsigned bytes, std::uint64_t clock, std::uint64_t room_waits) = 0;
  /// A master's burst has changed the RAM, at `at`.
  virtual void written(std::uint32_t offset, unsigned bytes, Master master, Picoseconds at) = 0;
};

}  // namespace fovea
