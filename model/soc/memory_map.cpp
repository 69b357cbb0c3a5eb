#include "model/soc/memory_map.h"

#include <cstdio>

namespace fovea::soc {
namespace {

constexpr auto kFast = bus::ConfigBus::Speed::kFast;
constexpr auto kSlow = bus::ConfigBus::Speed::kSlow;  // blocks on the 24 MHz AUXCLK

/// Bases: U-Boot asm/arch-davinci/hardware.h, Linux mach-davinci/dm365.c and devices.c, TI's
/// register headers for the DM36x (CSL), the boot loader's device.h. Sizes are those of the
/// resources there; a block without one reaches to its neighbour, at most 1 KB (assumed).
const std::vector<MapEntry> kMap = {
    {0x0000'8000, 0x4000, "ROM boot loader", ""},
    {0x0001'8000, 0x4000, "ROM boot loader (data side)", ""},
    {0x01C0'0000, 0x1'0000, "EDMA3 channel controller", "edma", kFast, true},
    {0x01C1'0000, 0x400, "EDMA3 transfer controller 0", ""},
    {0x01C1'0400, 0x400, "EDMA3 transfer controller 1", ""},
    {0x01C1'0800, 0x400, "EDMA3 transfer controller 2", ""},
    {0x01C1'0C00, 0x400, "EDMA3 transfer controller 3", ""},
    {0x01C2'0000, 0x400, "UART0", "uart0", kSlow},
    {0x01C2'0800, 0x400, "TIMER3", "timer3", kSlow},
    {0x01C2'0C00, 0x400, "RTO (real-time output)", ""},
    {0x01C2'1000, 0x400, "I2C", "i2c", kSlow},
    {0x01C2'1400, 0x400, "TIMER0", "timer0", kSlow},
    {0x01C2'1800, 0x400, "TIMER1", "timer1", kSlow},
    {0x01C2'1C00, 0x400, "TIMER2 (watchdog)", "timer2", kSlow},
    {0x01C2'2000, 0x400, "PWM0", ""},
    {0x01C2'2400, 0x400, "PWM1", ""},
    {0x01C2'2800, 0x400, "PWM2", ""},
    {0x01C2'2C00, 0x400, "PWM3", ""},
    {0x01C2'3000, 0x800, "SPI4", ""},
    {0x01C2'3800, 0x400, "TIMER4", "timer4", kSlow},
    {0x01C2'3C00, 0x400, "ADC interface", ""},
    {0x01C4'0000, 0x800, "system module", "system"},
    {0x01C4'0800, 0x400, "PLL controller 1", "pll1"},
    {0x01C4'0C00, 0x400, "PLL controller 2", "pll2"},
    {0x01C4'1000, 0x1000, "power and sleep controller", "psc"},
    {0x01C4'8000, 0x400, "interrupt controller", "aintc"},
    {0x01C6'4000, 0x2000, "USB controller", ""},
    {0x01C6'6000, 0x800, "SPI0", ""},
    {0x01C6'6800, 0x800, "SPI1", ""},
    {0x01C6'7000, 0x800, "GPIO", "gpio"},
    {0x01C6'7800, 0x800, "SPI2", ""},
    {0x01C6'8000, 0x800, "SPI3", ""},
    {0x01C6'9000, 0x400, "RTC (PRTC interface)", ""},
    {0x01C6'9400, 0x400, "key scan", ""},
    {0x01C6'9800, 0x800, "UHPI (host port)", ""},
    {0x01C7'0000, 0x400, "VPSS system (ISP5, clock control)", "vpss"},
    {0x01C7'0400, 0x400, "VPSS resizer (RSZ)", ""},
    {0x01C7'0800, 0x800, "VPSS image pipe (IPIPE)", ""},
    {0x01C7'1000, 0x200, "ISIF", "isif"},
    {0x01C7'1200, 0x200, "VPSS IPIPEIF", ""},
    {0x01C7'1400, 0x200, "VPSS H3A", ""},
    {0x01C7'1600, 0x200, "VPSS lens distortion correction (LDC)", ""},
    {0x01C7'1800, 0x400, "VPSS face detection (FDIF)", ""},
    {0x01C7'1C00, 0x100, "OSD", "osd"},
    {0x01C7'1E00, 0x200, "VENC", "venc"},
    {0x01C7'2000, 0xA000, "VPSS image pipe tables", ""},
    {0x01C7'C000, 0x800, "ISIF linearisation tables", ""},
    {0x01C7'F000, 0x1000, "VPSS LDC table", ""},
    {0x01CA'0000, 0x2'0000, "MJCP (JPEG coprocessor)", ""},
    {0x01D0'0000, 0x800, "MMCSD1", ""},
    {0x01D0'2000, 0x800, "ASP (McBSP)", ""},
    {0x01D0'6000, 0x400, "UART1", "uart1"},
    {0x01D0'7000, 0x1000, "EMAC", ""},
    {0x01D0'8000, 0x2000, "EMAC descriptor RAM", ""},
    {0x01D0'A000, 0x1000, "EMAC control module", ""},
    {0x01D0'B000, 0x800, "MDIO", ""},
    {0x01D0'C000, 0x400, "voice codec", ""},
    {0x01D1'0000, 0x1000, "AEMIF registers", ""},
    {0x01D1'1000, 0x800, "MMCSD0", ""},
    {0x01D2'0000, 0x800, "memory stick controller", ""},
    {0x01E0'0000, 0x20'0000, "HDVICP (video coprocessor)", ""},
    {0x0200'0000, 0x200'0000, "AEMIF chip select 0 (NAND, NOR)", ""},
    {0x0400'0000, 0x200'0000, "AEMIF chip select 1", ""},
    {0x2000'0000, 0x8000, "DDR2/mDDR controller", "ddr"},
};

}  // namespace

const std::vector<MapEntry>& memory_map() { return kMap; }

std::vector<bus::ConfigBus::BlockSpec> register_blocks() {
  std::vector<bus::ConfigBus::BlockSpec> out;
  for (const MapEntry& e : kMap)
    if (!e.block.empty()) out.push_back({e.block, e.base, e.size, e.speed});
  return out;
}

std::string not_modelled_at(std::uint32_t address) {
  for (const MapEntry& e : kMap) {
    if (address < e.base || address - e.base >= e.size) continue;
    if (!e.block.empty() && !e.partly) return {};
    char base[16];
    std::snprintf(base, sizeof base, "0x%08x", e.base);
    return e.title + " at " + base + (e.partly ? " is modelled in part only" : " is not modelled");
  }
  return {};
}

}  // namespace fovea::soc
