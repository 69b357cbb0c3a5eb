// Where a program's stalls come from: names for its addresses, and the table of a run.
#pragma once
#include <span>
#include <vector>

#include "model/cpu/core/stats.h"
#include "sw/fovea/elf_image.h"
#include "sw/fovea/exec_program.h"
#include "sw/fovea/outputs.h"

namespace fovea::app {

/// Objects of a program from this size on get a region of their own.
inline constexpr std::uint32_t kRegionObjectBytes = 4096;

/// Names the program's sections, the largest first while there is room for their names and for half
/// as many objects; then its largest objects, which lie in the sections. A section is where it is
/// linked to if that is inside `memory`, else where it is loaded.
void add_program_regions(cpu::RegionMap& map, const ElfImage& image,
                         std::span<const MemoryRegion> memory);
/// Memory of `fovea exec`: RAM as `sdram`, internal RAM, registers, heap and stack, and the program.
cpu::RegionMap exec_regions(const ExecProgram& program, const ExecMap& map);

/// What is not zero, in order of cause, region and culprit.
std::vector<StallRow> stall_rows(const cpu::Counts& from, const cpu::Counts& to,
                                 const cpu::RegionMap& regions);

}  // namespace fovea::app
