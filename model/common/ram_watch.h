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
  struct Load {
    std::uint32_t offset = 0;
    unsigned bytes = 0;
    std::uint32_t pc = 0;          ///< of the instruction
    std::uint64_t clock = 0;       ///< of the core
    std::uint64_t room_waits = 0;  ///< clocks that the core has waited for room in its write buffers so far
  };
  /// A load, in the order of the program.
  virtual void loaded(const Load& load) = 0;
  struct Access {
    std::uint32_t offset = 0;
    std::uint32_t pc = 0;          ///< of the instruction
    std::uint64_t clock = 0;       ///< at which the core got the word
    std::uint64_t waited = 0;      ///< clocks before it, for words of another master's burst
    std::uint64_t room_waits = 0;  ///< as in Load
  };
  /// A load, a store or a fetch, in the order of the program and of clocks; of fetches only those that are looked up,
  /// which are all while a burst is under way.
  virtual void accessed(const Access& access) = 0;
  struct Burst {
    std::uint32_t offset = 0;
    unsigned bytes = 0;
    bool write = false;
    Master master = Master::kCount;
    std::uint64_t waited = 0;  ///< clocks of the core for which its words waited for accesses of the core
  };
  /// A master's burst has read or changed the RAM, at `at`.
  virtual void moved(const Burst& burst, Picoseconds at) = 0;
};

}  // namespace fovea
