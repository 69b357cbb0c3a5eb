// Region names of a program's addresses, and the table of its stalls.
#include "sw/fovea/tools/stall_regions.h"

#include <map>

#include "tb/unit/support.h"

namespace fovea::app {
namespace {

using cpu::Cause;
using cpu::RegionMap;

const std::vector<MemoryRegion> kRam = {{"ram", 0x8000'0000, 0x0100'0000}};

std::string name_at(const RegionMap& map, std::uint32_t address) {
  return map.names()[map.find(address)];
}

TEST(ProgramRegionsTest, SectionsAndLargeObjectsHaveNames) {
  const auto image = ElfImage::load(FIXTURE_TABLES);
  RegionMap map;
  map.add("sdram", 0x8000'0000, 0x0100'0000);
  add_program_regions(map, image, kRam);
  const auto address = [&](const char* symbol) { return image.find(symbol)->address; };
  EXPECT_EQ(name_at(map, address("add_one")), ".text");
  EXPECT_EQ(name_at(map, address("counter")), ".data");
  EXPECT_EQ(name_at(map, address("zeroed")), ".bss");
  EXPECT_EQ(name_at(map, address("table")), "table");
  EXPECT_EQ(name_at(map, address("table") + 8191), "table");
  EXPECT_NE(name_at(map, address("table") + 8192), "table");
  EXPECT_EQ(name_at(map, 0x80F0'0000), "sdram");
  EXPECT_EQ(name_at(map, 0), "other");
}

TEST(ProgramRegionsTest, SectionsOutsideMemoryAreWhereTheyAreLoaded) {
  const auto image = ElfImage::load(FIXTURE_MOVED);  // linked to 0xc0000000, loaded to 0x80000000
  RegionMap map;
  add_program_regions(map, image, kRam);
  const std::uint32_t at = image.find("add_one")->address;
  ASSERT_GE(at, 0xC000'0000u);
  EXPECT_EQ(name_at(map, at - 0x4000'0000u), ".text");
  EXPECT_EQ(name_at(map, at), "other");
}

TEST(ProgramRegionsTest, TheLargestGetTheNamesThatAreLeft) {
  const auto image = ElfImage::load(FIXTURE_TABLES);
  RegionMap map;
  for (unsigned k = 0; map.names().size() < RegionMap::kMax - 3; ++k)
    map.add("taken" + std::to_string(k), 64 * k, 64);
  add_program_regions(map, image, kRam);
  EXPECT_EQ(map.names().size(), RegionMap::kMax);
  EXPECT_EQ(name_at(map, image.find("table")->address), "table");
  EXPECT_EQ(name_at(map, image.find("zeroed")->address), ".bss");
  EXPECT_EQ(name_at(map, image.find("counter")->address), "other") << "the smallest section";
}

TEST(ExecRegionsTest, HeapAndStackOfTheMemoryMap) {
  const ExecProgram program = ExecProgram::elf(FIXTURE_TABLES);
  const ExecMap map = program.map(128u << 20);
  const RegionMap regions = exec_regions(program, map, std::vector<MemoryRegion>{{"registers", 0x2000'0000, 0x8000}});
  EXPECT_EQ(name_at(regions, map.free_end - 4), "stack");
  EXPECT_NE(name_at(regions, map.free_end), "stack");
  EXPECT_EQ(name_at(regions, map.heap_limit()), "stack");
  EXPECT_EQ(name_at(regions, map.heap_limit() - 4), "heap");
  EXPECT_EQ(name_at(regions, map.free_base), "heap");
  EXPECT_EQ(name_at(regions, 0x100), "itcm");
  EXPECT_EQ(name_at(regions, 0x1'0100), "dtcm");
  EXPECT_EQ(name_at(regions, 0x2000'0004), "registers");
}

TEST(StallRowsTest, DifferenceOfTheWindowInOrder) {
  RegionMap map;
  map.add("lut", 0x8000'0000, 0x1000);
  const std::size_t lut = map.find(0x8000'0000);
  cpu::Counts from, to;
  const auto charge = [](cpu::Counts& c, Cause cause, std::size_t region, std::size_t culprit,
                         std::uint64_t clocks) {
    c.stall[index(cause)] += clocks;
    c.stalls.add(cause, region, culprit, clocks);
  };
  charge(from, Cause::kDcache, lut, cpu::kService, 3);
  to = from;
  charge(to, Cause::kDcache, lut, cpu::kCore, 5);
  charge(to, Cause::kDcache, lut, index(culprit(Master::kVpbe)), 4);
  charge(to, Cause::kBusSync, RegionMap::kOther, cpu::kCore, 2);
  to.stall[index(Cause::kInterlock)] += 7;
  EXPECT_EQ(stalls_csv(stall_rows(from, to, map)),
            "cause,region,culprit,cycles\n"
            "interlock,none,core,7\n"
            "dcache,lut,vpbe,4\n"
            "dcache,lut,core,5\n"
            "bus_sync,other,core,2\n");
  // And the same in stats.json, by culprit.
  cpu::CoreStats stats;
  stats.from = from;
  stats.to = to;
  std::vector<StatRow> rows;
  collect(stats, rows);
  std::map<std::string, std::uint64_t> sums;
  for (const auto& r : rows)
    if (const auto by = r.name.find(".by."); by != std::string::npos)
      sums[r.name.substr(0, by)] += std::get<std::uint64_t>(r.value);
  EXPECT_EQ(sums.size(), 8u) << "causes that may wait for others";
  for (const auto& [name, sum] : sums)
    EXPECT_EQ(sum, std::get<std::uint64_t>(find(rows, name)->value)) << name;
  EXPECT_EQ(std::get<std::uint64_t>(find(rows, "cpu.stall.dcache.by.vpbe")->value), 4u);
}

TEST(StallRowsDeathTest, AMissingChargeIsADefect) {
  cpu::Counts missing;
  missing.stall[index(Cause::kDcache)] = 1;
  EXPECT_EXIT(stall_rows({}, missing, {}), testing::ExitedWithCode(4), "stalled clock");
}

}  // namespace
}  // namespace fovea::app
