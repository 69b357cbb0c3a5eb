// Coherency hazards: places where the core and a DMA master do not see the same memory.
#pragma once
#include <cstddef>
#include <cstdint>

#include "model/common/masters.h"
#include "model/common/units.h"

namespace fovea::cpu {

/// What goes wrong. The ARM926EJ-S keeps no coherency between its D-cache and other masters (ARM DDI
/// 0198D chapter 4): the program has to clean and invalidate.
enum class HazardKind : std::uint8_t {
  kStaleLoad,      ///< the core loads bytes of a line that memory changed since the line's fill
  kDirtyRead,      ///< a master reads memory whose newer bytes are in a dirty line
  kBufferedRead,   ///< a master reads memory whose newer bytes are in the write or victim buffer
  kOverwrite,      ///< a dirty half is written back, or a buffered write goes, over a master's newer bytes
  kStaleFetch,     ///< the core executes an instruction of an I-cache line that memory changed since the fill
  kCount
};
inline constexpr std::size_t kHazardKinds = static_cast<std::size_t>(HazardKind::kCount);

struct Hazard {
  HazardKind kind = HazardKind::kStaleLoad;
  Master master = Master::kCount;  ///< the other one
  std::uint32_t pc = 0;            ///< of the load or the instruction, or of the first store into the dirty half;
                                   ///< for bytes in a buffer see `stored`
  std::uint32_t address = 0;       ///< physical address of the first byte concerned
  Picoseconds before = 0;          ///< the earlier act: a line's fill, a store, or the master's write
  Picoseconds after = 0;           ///< the later one, which is the hazard
  /// kStaleLoad, kStaleFetch: when the line was filled (`before` is the master's write). Otherwise 0.
  Picoseconds filled = 0;
  /// Bytes in a buffer (kBufferedRead, and kOverwrite with before == after): when the store at `pc` made them. 0: no
  /// line of the D-cache held them, and `pc` is that of the instruction under way at the master's access.
  Picoseconds stored = 0;
};

}  // namespace fovea::cpu
