// The chip's address map below the SDRAM: the blocks of the model and what else TI and the public
// drivers document.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/soc/placement.h"

namespace fovea::soc {

struct MapEntry {
  std::uint32_t base, size;
  std::string title;       ///< for people
  std::string block = {};  ///< name of its row; empty: documented, but not modelled
  /// Of this block only some registers are modelled; an access to another one is a bus error.
  bool partly = false;
};

/// By address, without overlaps. The core's internal RAM and the SDRAM are not in it. A block that is
/// placed where only a documented one was takes its entry.
std::vector<MapEntry> memory_map(const Placements& rows = dm365_blocks());

/// What the map says of an address that ended in a bus error, such as "MMCSD0 at 0x01d11000 is not
/// modelled"; empty where nothing is documented, or where all that is documented is modelled.
std::string not_modelled_at(std::uint32_t address, const Placements& rows = dm365_blocks());
/// The block of these rows, none of which is there, and why it is not; empty: none has the address.
std::string absent_at(std::uint32_t address, const Placements& rows);

}  // namespace fovea::soc
