// Names for a program's addresses in the stall statistics, and the table of a run.
#pragma once
#include <span>
#include <vector>

#include "model/cpu/core/stats.h"
#include "sw/fovea/program/elf_image.h"
#include "sw/fovea/program/exec_program.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::app {

/// Objects of a program get a region of their own from this size on, in bytes.
inline constexpr std::uint32_t kRegionObjectBytes = 4096;

/// Adds the program's sections as regions, the largest first, as long as there is room for them and
/// for half as many objects, and then its largest objects, which lie within the sections. The
/// address of a section is its link address if that is inside `memory`, otherwise its load address.
void add_program_regions(cpu::RegionMap& map, const ElfImage& image,
                         std::span<const MemoryRegion> memory);
/// Regions of `fovea exec`: RAM as `sdram`, internal RAM, registers, heap and stack, and the
/// program.
cpu::RegionMap exec_regions(const ExecProgram& program, const ExecMap& map,
                            std::span<const MemoryRegion> registers);

/// All entries that are not zero, ordered by cause, region and culprit.
std::vector<StallRow> stall_rows(const cpu::Counts& from, const cpu::Counts& to,
                                 const cpu::RegionMap& regions);

}  // namespace fovea::app
