// The chip's address map below the SDRAM: one table of what TI and the public drivers document.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/bus/config_bus.h"

namespace fovea::soc {

struct MapEntry {
  std::uint32_t base, size;
  std::string title;  ///< for people
  std::string block;  ///< name on the configuration bus; empty: documented, but not modelled
  bus::ConfigBus::Speed speed = bus::ConfigBus::Speed::kFast;
  /// Of this block only some registers are modelled; an access to another one is a bus error.
  bool partly = false;
};

/// By address, without overlaps. The core's internal RAM and the SDRAM are not in it.
const std::vector<MapEntry>& memory_map();

/// The modelled blocks of the map.
std::vector<bus::ConfigBus::BlockSpec> register_blocks();

/// What the map says of an address that ended in a bus error, such as "MMCSD0 at 0x01d11000 is not
/// modelled"; empty where nothing is documented, or where all that is documented is modelled.
std::string not_modelled_at(std::uint32_t address);

}  // namespace fovea::soc
