// The preamble of `fovea exec --caches`: what a boot loader does for a program that expects the MMU
// and caches to be enabled.
#pragma once
#include <cstdint>
#include <vector>

#include "sw/fovea/program/exec_program.h"

namespace fovea::app {

/// Translation table and code of the preamble, as the bytes from map.table on. Sections of 1 MiB
/// map every address to itself; RAM is write-back cacheable, everything else is neither cached nor
/// buffered.
std::vector<std::uint8_t> cache_preamble(const ExecMap& map, std::uint32_t entry);
/// Entry of the preamble, which ends with a jump to the program's entry.
inline std::uint32_t preamble_entry(const ExecMap& map) { return map.table + 0x4000; }

}  // namespace fovea::app
