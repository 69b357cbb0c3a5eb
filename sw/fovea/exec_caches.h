// The preamble of `fovea exec --caches`: what a boot loader would do before a program that expects
// MMU and caches to be on.
#pragma once
#include <cstdint>
#include <vector>

#include "sw/fovea/exec_program.h"

namespace fovea::app {

/// Translation table and code of the preamble, the bytes from map.table on: sections of 1 MiB, every
/// address mapped to itself, RAM write-back cacheable, everything else neither cached nor buffered.
std::vector<std::uint8_t> cache_preamble(const ExecMap& map, std::uint32_t entry);
/// Where the preamble begins; it ends with a jump to the program's entry.
inline std::uint32_t preamble_entry(const ExecMap& map) { return map.table + 0x4000; }

}  // namespace fovea::app
