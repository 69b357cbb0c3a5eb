#include "sw/fovea/tools/stall_regions.h"

#include <algorithm>

#include "model/common/check.h"
#include "model/contract/memory_map.h"

namespace fovea::app {
namespace {

using cpu::RegionMap;

bool inside(const ElfSection& s, std::span<const MemoryRegion> memory) {
  return std::any_of(memory.begin(), memory.end(), [&](const MemoryRegion& m) {
    return s.address >= m.base && s.address - m.base + std::uint64_t{s.size} <= m.size;
  });
}

/// Difference between the address of the section in memory and its link address.
std::uint32_t offset(const ElfSection& s, const ElfImage& image,
                     std::span<const MemoryRegion> memory) {
  if (inside(s, memory)) return 0;
  for (const auto& segment : image.segments())
    if (s.address - segment.virtual_address < segment.memory_size)
      return segment.address - segment.virtual_address;
  return 0;
}

}  // namespace

void add_program_regions(RegionMap& map, const ElfImage& image,
                         std::span<const MemoryRegion> memory) {
  const auto larger = [](const auto* a, const auto* b) {
    return a->size != b->size ? a->size > b->size : a->address < b->address;
  };
  std::vector<const ElfSection*> sections;
  for (const auto& s : image.sections()) sections.push_back(&s);
  std::sort(sections.begin(), sections.end(), larger);
  std::vector<const ElfSymbol*> objects;
  for (const auto& s : image.symbols())
    if (!s.function && s.size >= kRegionObjectBytes) objects.push_back(&s);
  std::sort(objects.begin(), objects.end(), larger);

  const std::size_t room = RegionMap::kMax - map.names().size();
  const std::size_t kept = std::min(objects.size(), room / 3);
  if (sections.size() > room - kept) sections.resize(room - kept);
  for (const auto* s : sections) map.add(s->name, s->address + offset(*s, image, memory), s->size);
  for (const auto* o : objects) {
    const auto home = std::find_if(
        image.sections().begin(), image.sections().end(),
        [&](const ElfSection& s) { return o->address - s.address < s.size; });
    if (home == image.sections().end()) continue;
    if (!map.add(o->text(), o->address + offset(*home, image, memory), o->size)) break;
  }
}

RegionMap exec_regions(const ExecProgram& program, const ExecMap& map,
                       std::span<const MemoryRegion> registers) {
  RegionMap out;
  std::vector<MemoryRegion> memory = {{"sdram", map.ram_base, map.ram_size}};
  if (map.tcm) {
    memory.push_back({"itcm", INTERNAL_RAM_BASE, INTERNAL_RAM_BYTES});
    memory.push_back({"dtcm", INTERNAL_RAM_DATA_BASE, INTERNAL_RAM_BYTES});
  }
  for (const auto& m : memory) out.add(m.name, m.base, m.size);
  for (const auto& m : registers) out.add(m.name, m.base, m.size);
  out.add("heap", map.free_base, map.heap_limit() - map.free_base);
  out.add("stack", map.heap_limit(), map.free_end - map.heap_limit());
  if (program.image()) add_program_regions(out, *program.image(), memory);
  return out;
}

std::vector<StallRow> stall_rows(const cpu::Counts& from, const cpu::Counts& to,
                                 const RegionMap& regions) {
  FOVEA_CHECK(to.unexplained() == cpu::Cause::kCount,
              "every stalled clock has one region and one culprit");
  std::vector<StallRow> rows;
  for (const cpu::CauseInfo& info : cpu::kCauseTable)
    for (std::size_t r = 0; r < regions.names().size(); ++r)
      for (std::size_t c = 0; c < cpu::kStallCulprits; ++c) {
        const std::uint64_t n = to.stalled(info.cause, r, c, from);
        if (n != 0)
          rows.push_back({info.name, regions.names()[r], std::string(cpu::stall_culprit_name(c)), n});
      }
  return rows;
}

}  // namespace fovea::app
