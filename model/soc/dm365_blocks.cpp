// The blocks of the DM365 with registers: where each lies. Bases: U-Boot asm/arch-davinci/hardware.h,
// Linux mach-davinci/dm365.c and devices.c, TI's register headers for the DM36x (CSL), the boot loader's
// device.h. Sizes are those of the resources there; a block without one reaches to its neighbour, at
// most 1 KB (assumed). Power gates: Linux psc-dm365.c, TI boot loader. Interrupts: Linux irqs.h for the
// DM365.
#include "model/dma/edma_cc.h"
#include "model/dma/edma_tc.h"
#include "model/engine/remap_engine.h"
#include "model/mem/ddr_module.h"
#include "model/periph/aintc.h"
#include "model/periph/gpio.h"
#include "model/periph/i2c_controller.h"
#include "model/periph/pll_controller.h"
#include "model/periph/psc.h"
#include "model/periph/system_module.h"
#include "model/periph/timer64.h"
#include "model/periph/uart16550.h"
#include "model/soc/placement.h"
#include "model/video/isif.h"
#include "model/video/osd.h"
#include "model/video/venc.h"
#include "model/video/vpss_top.h"

namespace fovea::soc {

const Placements& dm365_blocks() {
  using periph::Timer64;
  constexpr auto kFast = bus::ConfigBus::Speed::kFast;
  constexpr auto kSlow = bus::ConfigBus::Speed::kSlow;  // blocks on the 24 MHz AUXCLK
  constexpr auto kNone = BlockClock::kNone;
  constexpr auto kAux = BlockClock::kAux;
  constexpr auto kEdma = BlockClock::kEdma;
  constexpr bool kSecond = true;
  using enum cpu::WakeEvent;
  static const Placements rows = {
      place<mem::DdrModule>({"ddr", "DDR2/mDDR controller", 0x2000'0000, 0x8000, kFast, kNone,
                             periph::kLpscDdr}),
      place<dma::EdmaCc>({"edma", "EDMA3 channel controller", 0x01C0'0000, 0x1'0000, kFast, kEdma,
                          periph::kLpscTpcc, {16, {17, kSecond}}, kDma}),
      place<dma::EdmaTc>({"edma_tc0", "EDMA3 transfer controller 0", 0x01C1'0000, 0x400, kFast, kEdma,
                          periph::kLpscTptc0, {{18, kSecond}}, kDma}, 0u),
      place<dma::EdmaTc>({"edma_tc1", "EDMA3 transfer controller 1", 0x01C1'0400, 0x400, kFast, kEdma,
                          periph::kLpscTptc1, {{19, kSecond}}, kDma}, 1u),
      place<dma::EdmaTc>({"edma_tc2", "EDMA3 transfer controller 2", 0x01C1'0800, 0x400, kFast, kEdma,
                          periph::kLpscTptc2, {{61, kSecond}}, kDma}, 2u),
      place<dma::EdmaTc>({"edma_tc3", "EDMA3 transfer controller 3", 0x01C1'0C00, 0x400, kFast, kEdma,
                          periph::kLpscTptc3, {{62, kSecond}}, kDma}, 3u),
      place<periph::PllController>({"pll1", "PLL controller 1", 0x01C4'0800, 0x400}, "PLLC1", 9u),
      place<periph::PllController>({"pll2", "PLL controller 2", 0x01C4'0C00, 0x400}, "PLLC2", 5u),
      place<periph::Psc>({"psc", "power and sleep controller", 0x01C4'1000, 0x1000}),
      place<periph::SystemModule>({"system", "system module", 0x01C4'0000, 0x800}),
      place<periph::Aintc>({"aintc", "interrupt controller", 0x01C4'8000, 0x400}),
      place<Timer64>({"timer0", "TIMER0", 0x01C2'1400, 0x400, kSlow, kAux, periph::kLpscTimer0,
                      {32, 33}, kTimer}),
      place<Timer64>({"timer1", "TIMER1", 0x01C2'1800, 0x400, kSlow, kAux, periph::kLpscTimer1,
                      {34, 35}, kTimer}),
      // Without a power gate: public code never disables LPSC 29 (Linux psc-dm365.c).
      place<Timer64>({"timer2", "TIMER2 (watchdog)", 0x01C2'1C00, 0x400, kSlow, kAux, {},
                      {{13, kSecond}, 14}, kTimer}),
      place<Timer64>({"timer3", "TIMER3", 0x01C2'0800, 0x400, kSlow, kAux, periph::kLpscTimer3,
                      {15, 22}, kTimer}),
      place<Timer64>({"timer4", "TIMER4", 0x01C2'3800, 0x400, kSlow, kAux, periph::kLpscTimer4,
                      {{38, kSecond}, {28, kSecond}}, kTimer}),
      place<periph::Uart16550>({"uart0", "UART0", 0x01C2'0000, 0x400, kSlow, kAux,
                                periph::kLpscUart0, {40}}, "PINMUX3 bit 19 = 1"),
      place<periph::Uart16550>({"uart1", "UART1", 0x01D0'6000, 0x400, kFast, BlockClock::kUart1,
                                periph::kLpscUart1, {41}}, "PINMUX3 bits 16:15 = 2"),
      place<periph::Gpio>({"gpio", "GPIO", 0x01C6'7000, 0x800, kFast, BlockClock::kEdma,
                           periph::kLpscGpio,
                           {44, 45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59}}),
      place<periph::I2cController>({"i2c", "I2C", 0x01C2'1000, 0x400, kSlow, kAux, periph::kLpscI2c,
                                    {39}}),
      place<video::VpssTop>({"vpss", "VPSS system (ISP5, clock control)", 0x01C7'0000, 0x400, kFast,
                             kNone, periph::kLpscVpss, {0, 1, 2, 3, 4, 5, 6, 7, 8}}),
      place<video::Isif>({"isif", "ISIF", 0x01C7'1000, 0x200, kFast, kNone, periph::kLpscVpss}),
      place<video::Osd>({"osd", "OSD", 0x01C7'1C00, 0x100, kFast, kNone, periph::kLpscVpss}),
      place<video::Venc>({"venc", "VENC", 0x01C7'1E00, 0x200, kFast, BlockClock::kVenc,
                          periph::kLpscVpss}),
      // Hypothetical: the chip has no such block, and nothing is documented at this address. It has the
      // priority of the imaging coprocessor (MSTPRI0.IMCOPP) and takes the interrupt input of that, which
      // is not modelled and whose wire no multiplexer touches (IMCOPINT 11, Linux irqs.h). No power gate:
      // none of the numbers is known to be free.
      only_if(&engine::EngineParams::present, "key 'engine' is none",
              place<engine::RemapEngine>({"engine", "remap engine (hypothetical)", 0x01C6'A000, 0x400, kFast,
                                          kEdma, {}, {11}, kEngine})),
  };
  return rows;
}

}  // namespace fovea::soc
