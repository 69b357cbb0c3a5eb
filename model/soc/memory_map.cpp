#include "model/soc/memory_map.h"

#include <algorithm>
#include <cstdio>

namespace fovea::soc {
namespace {

/// What is documented but not modelled. Sources and sizes as in dm365_blocks.cpp.
const std::vector<MapEntry> kNotModelled = {
    {0x0000'8000, 0x4000, "ROM boot loader"},
    {0x0001'8000, 0x4000, "ROM boot loader (data side)"},
    {0x01C2'0C00, 0x400, "RTO (real-time output)"},
    {0x01C2'2000, 0x400, "PWM0"},
    {0x01C2'2400, 0x400, "PWM1"},
    {0x01C2'2800, 0x400, "PWM2"},
    {0x01C2'2C00, 0x400, "PWM3"},
    {0x01C2'3000, 0x800, "SPI4"},
    {0x01C2'3C00, 0x400, "ADC interface"},
    {0x01C6'4000, 0x2000, "USB controller"},
    {0x01C6'6000, 0x800, "SPI0"},
    {0x01C6'6800, 0x800, "SPI1"},
    {0x01C6'7800, 0x800, "SPI2"},
    {0x01C6'8000, 0x800, "SPI3"},
    {0x01C6'9000, 0x400, "RTC (PRTC interface)"},
    {0x01C6'9400, 0x400, "key scan"},
    {0x01C6'9800, 0x800, "UHPI (host port)"},
    {0x01C7'0400, 0x400, "VPSS resizer (RSZ)"},
    {0x01C7'0800, 0x800, "VPSS image pipe (IPIPE)"},
    {0x01C7'1200, 0x200, "VPSS IPIPEIF"},
    {0x01C7'1400, 0x200, "VPSS H3A"},
    {0x01C7'1600, 0x200, "VPSS lens distortion correction (LDC)"},
    {0x01C7'1800, 0x400, "VPSS face detection (FDIF)"},
    {0x01C7'2000, 0xA000, "VPSS image pipe tables"},
    {0x01C7'C000, 0x800, "ISIF linearisation tables"},
    {0x01C7'F000, 0x1000, "VPSS LDC table"},
    {0x01CA'0000, 0x2'0000, "MJCP (JPEG coprocessor)"},
    {0x01D0'0000, 0x800, "MMCSD1"},
    {0x01D0'2000, 0x800, "ASP (McBSP)"},
    {0x01D0'7000, 0x1000, "EMAC"},
    {0x01D0'8000, 0x2000, "EMAC descriptor RAM"},
    {0x01D0'A000, 0x1000, "EMAC control module"},
    {0x01D0'B000, 0x800, "MDIO"},
    {0x01D0'C000, 0x400, "voice codec"},
    {0x01D1'0000, 0x1000, "AEMIF registers"},
    {0x01D1'1000, 0x800, "MMCSD0"},
    {0x01D2'0000, 0x800, "memory stick controller"},
    {0x01E0'0000, 0x20'0000, "HDVICP (video coprocessor)"},
    {0x0200'0000, 0x200'0000, "AEMIF chip select 0 (NAND, NOR)"},
    {0x0400'0000, 0x200'0000, "AEMIF chip select 1"},
};

}  // namespace

std::vector<MapEntry> memory_map(const Placements& rows) {
  std::vector<MapEntry> map;
  for (const Placement& row : rows)
    map.push_back({row.base, row.size, row.title, row.name, row.partly});
  for (const MapEntry& e : kNotModelled)
    if (std::none_of(rows.begin(), rows.end(), [&](const Placement& row) {
          return row.base < e.base + e.size && e.base < row.base + row.size;
        }))
      map.push_back(e);
  std::sort(map.begin(), map.end(),
            [](const MapEntry& a, const MapEntry& b) { return a.base < b.base; });
  return map;
}

std::string not_modelled_at(std::uint32_t address, const Placements& rows) {
  for (const MapEntry& e : memory_map(rows)) {
    if (address < e.base || address - e.base >= e.size) continue;
    if (!e.block.empty() && !e.partly) return {};
    char base[16];
    std::snprintf(base, sizeof base, "0x%08x", e.base);
    return e.title + " at " + base + (e.partly ? " is modelled in part only" : " is not modelled");
  }
  return {};
}

std::string absent_at(std::uint32_t address, const Placements& rows) {
  for (const Placement& row : rows) {
    if (address < row.base || address - row.base >= row.size) continue;
    char base[16];
    std::snprintf(base, sizeof base, "0x%08x", row.base);
    return row.title + " at " + base + " is not there: " + row.absent;
  }
  return {};
}

}  // namespace fovea::soc
