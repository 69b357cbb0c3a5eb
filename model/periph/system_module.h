// System module: pin and interrupt multiplexers, priorities, clock selection, I/O calibration.
#pragma once
#include <cstdint>
#include <deque>
#include <systemc>

#include "model/common/bus_target.h"
#include "model/common/param.h"
#include "model/common/timer.h"
#include "model/periph/clocked_target.h"

namespace fovea::periph {

struct SystemParams : ParamGroup {
  IntParam vtp_time{*this,
                    "vtp_time",
                    IntParam::Unit::kTime,
                    2 * kPsPerUs,
                    10 * kPsPerNs,
                    kPsPerMs,
                    "from CLRZ = 1 to READY of the DDR I/O calibration",
                    Origin::kAssumed,
                    "no figure published; software polls READY once at start-up",
                    {"500ns", "100us", "a search over some hundred steps of a clock"}};
  IntParam bootcfg{*this,
                   "bootcfg",
                   IntParam::Unit::kCount,
                   0,
                   0,
                   255,
                   "BOOTCFG pins: 7:5 boot mode (0 NAND ... 3 UART), 2 AEMIF width",
                   Origin::kChoice,
                   "board straps"};
  IntParam reset_time{*this,
                      "reset_time",
                      IntParam::Unit::kTime,
                      10 * kPsPerUs,
                      100 * kPsPerNs,
                      10 * kPsPerMs,
                      "from a reset of the running chip to the core's first instruction; the work "
                      "of the ROM boot loader takes no time",
                      Origin::kAssumed,
                      "no figure published",
                      {"1us", "1ms", "some clocks of 24 MHz to the start of the oscillator"}};
  SystemParams() : ParamGroup("system") {}
};

/// Offsets and reset values: TI's register header (CSL) and TI's boot loader, which agree. Settings
/// that act on the chip but have no effect here give a warning (Modelled). BOOTCFG, DDR_SLEW, the
/// pull resistors and the registers of blocks that are not modelled (host port, USB) only keep what
/// is written.
struct SystemRegs : RegBank {
  explicit SystemRegs(std::uint32_t bootcfg_pins);
  std::deque<Reg> pinmux;  ///< PINMUX0 to 4
  Reg bootcfg;
  Reg arm_intmux{*this, "ARM_INTMUX", 0x18, Mode::kRw,
                 "which of two blocks feeds an interrupt (interrupt_mux.h)"};
  Reg edma_evtmux{*this, "EDMA_EVTMUX", 0x1C, Mode::kRw,
                  "which of two blocks feeds an EDMA event (soc/edma_events.h)"};
  Reg ddr_slew{*this, "DDR_SLEW", 0x20, Mode::kRw, "DDR pad slew; bit 4 CMOS levels", 0x700};
  Reg uhpi_ctl{*this, "UHPI_CTL", 0x24, Mode::kRw, "host port; kept"};
  Reg device_id{*this, "DEVICE_ID", 0x28, Mode::kRo, "JTAG identification", 0x0B83E02F};
  Reg vdac_config{*this, "VDAC_CONFIG", 0x2C, Mode::kRw, "video DAC; kept", 0x00115500};
  struct Timer64Ctl : Reg {
    using Reg::Reg;
    Field gio1_2{*this, "GIO1_2", 0, 1, Mode::kRw, "input pin of TIMER0: GIO1, GIO2", Modelled{0}};
    Field gio3_4{*this, "GIO3_4", 1, 1, Mode::kRw, "input pin of TIMER1: GIO3, GIO4", Modelled{0}};
  } timer64_ctl{*this, "TIMER64_CTL", 0x30, "timer input pins"};
  Reg usbphy_ctl{*this, "USBPHY_CTL", 0x34, Mode::kRw, "USB PHY; kept", 0xC7};
  struct Misc : Reg {
    using Reg::Reg;
    Field arm_waitst{*this, "ARM_WAITST", 0,
                     1,     Mode::kRw,    "internal RAM: 0 one wait state, 1 none"};
    Field efuse{*this, "EFUSE_BIT", 2, 2, Mode::kRo, "0"};
    Field timer2_wdt{*this, "TIMER2_WDT", 4,
                     1,     Mode::kRw,    "1: TIMER2's reset request resets the chip"};
    Field clkstp{*this,      "CLKSTP_BYP", 5, 2, Mode::kRw, "clock stop bypass: McBSP, EDMA",
                 Modelled{0}};
    Field tptc1_bst{*this,     "TPTC1_BST", 7,
                    1,         Mode::kRw,   "burst of TPTC1: 0 32 bytes, 1 64"};
    Field bootst{*this, "BOOTST", 8, 2, Mode::kRw, "boot status; kept"};
  } misc{*this, "MISC", 0x38, "miscellaneous", 0x13};
  struct Mstpri0 : Reg {
    using Reg::Reg;
    Field arm_dma{*this, "ARM_DMAP", 0, 3, Mode::kRw, "priority of the ARM's DMA port"};
    Field arm_cfg{*this, "ARM_CFGP", 4, 3, Mode::kRw, "priority of the ARM's configuration port"};
    Field mjcp{*this, "IMCOPP", 16, 3, Mode::kRw, "priority of the imaging coprocessor"};
    Field hdvicp{*this, "KALEIDOP", 20, 3, Mode::kRw, "priority of HDVICP"};
  } mstpri0{*this, "MSTPRI0", 0x3C, "master priorities, 0 highest", 0x00550011};
  struct Mstpri1 : Reg {
    using Reg::Reg;
    Field emac{*this, "EMACP", 0, 3, Mode::kRw, "priority of the EMAC"};
    Field uhpi{*this, "UHPIP", 4, 3, Mode::kRw, "priority of the host port"};
    Field usb{*this, "USBP", 8, 3, Mode::kRw, "priority of USB"};
  } mstpri1{*this, "MSTPRI1", 0x40, "master priorities, 0 highest", 0x00000444};
  struct VpssClkCtrl : Reg {
    using Reg::Reg;
    Field muxsel{*this, "VPSS_MUXSEL", 0, 2, Mode::kRw, "VENC clock: 0, 1 internal, 3 PCLK"};
    Field pclk_inv{*this, "PCLK_INV", 2, 1, Mode::kRw, "inverts PCLK; kept"};
    Field venclken{*this, "VENCLKEN", 3, 1, Mode::kRw, "VENC clock on"};
    Field dacclken{*this, "DACCLKEN", 4, 1, Mode::kRw, "DAC clock on; kept"};
    Field venc_src{*this, "VENC_CLK_SRC", 5, 2, Mode::kRw, "0 PLL1, 1 PLL2, 2, 3 crystal"};
    Field clkmd{*this, "VPSS_CLKMD", 7, 1, Mode::kRw, "DMA : VPSS 0 1:2, 1 1:1; kept"};
  } vpss_clk_ctrl{*this, "VPSS_CLK_CTRL", 0x44, "VPSS clocks", 0x10};
  /// TI's header gives DDRCLKS a reset value of 1, but the whole register 0x003F0FF8; the latter is
  /// used.
  Reg peri_clk_ctrl{
      *this,     "PERI_CLK_CTRL", 0x48, Mode::kRw, "29 ARM from PLL2, 27 DDR from PLL2, dividers",
      0x003F0FF8};
  Reg deepsleep{*this, "DEEPSLEEP", 0x4C, Mode::kRw, "deep sleep; not modelled", 0x176B};
  Reg dft_enable{*this, "DFT_ENABLE", 0x50, Mode::kRw, "test; kept"};
  struct Debounce : Reg {
    using Reg::Reg;
    Field interval{*this, "INTERVAL", 0, 21, Mode::kRw, "time that a level must last"};
    Field enable{*this, "ENABLE", 31, 1, Mode::kRw, "debouncing of a GPIO pin", Modelled{0}};
  };
  std::deque<Debounce> debounce;  ///< for GPIO0 to GPIO7
  struct Vtpiocr : Reg {
    using Reg::Reg;
    Field code{*this, "DRIVE", 0, 6, Mode::kRw, "drive and filter settings; kept"};
    Field pwrdn{*this, "PWRDN", 6, 1, Mode::kRw, "calibration off; kept"};
    Field lock{*this, "LOCK", 7, 1, Mode::kRw, "holds the calibration"};
    Field pwrsave{*this, "PWRSAVE", 8, 1, Mode::kRw, "kept"};
    Field force{*this, "FORCE", 9, 4, Mode::kRw, "kept"};
    Field clrz{*this, "CLRZ", 13, 1, Mode::kRw, "0 clears, a rise starts the calibration"};
    Field iopwrdn{*this, "IOPWRDN", 14, 1, Mode::kRw, "kept"};
    Field ready{*this, "READY", 15, 1, Mode::kRo, "calibration is complete"};
    Field vref{*this, "VREF", 16, 5, Mode::kRw, "reference; kept"};
  } vtpiocr{*this, "VTPIOCR", 0x74, "DDR I/O calibration", 0x00182077};
  Reg pupdctl0{*this, "PUPDCTL0", 0x78, Mode::kRw, "pull resistors; kept", ~0u};
  Reg pupdctl1{*this, "PUPDCTL1", 0x7C, Mode::kRw, "pull resistors; kept", ~0u};
  Reg hdimcopbt{*this, "HDIMCOPBT", 0x80, Mode::kRw, "coprocessor boot; kept", 0x1};
  Reg pll0_config{*this, "PLL0_CONFIG", 0x84, Mode::kRo, "PLLC1 lock flags: 24, 27:25, 28"};
  Reg pll1_config{*this, "PLL1_CONFIG", 0x88, Mode::kRo, "PLLC2 lock flags: 24, 27:25, 28"};
};

/// System module at 0x01C40000. Its control registers are output as ports, which change in the
/// instant of the write.
class SystemModule : public WithRegs<SystemRegs>, public BusTarget {
 public:
  using Params = SystemParams;
  SC_HAS_PROCESS(SystemModule);
  sc_core::sc_in<bool> pll1_locked{"pll1_locked"}, pll2_locked{"pll2_locked"};
  OptionalOut<std::uint32_t> mstpri0{"mstpri0"}, mstpri1{"mstpri1"};
  OptionalOut<std::uint32_t> vpss_clk_ctrl{"vpss_clk_ctrl"}, peri_clk_ctrl{"peri_clk_ctrl"};
  OptionalOut<std::uint32_t> misc{"misc"}, edma_evtmux{"edma_evtmux"}, arm_intmux{"arm_intmux"};

  /// True while PINMUX assigns their pins to these blocks (Linux mach-davinci/dm365.c, MUX_CFG).
  /// Other pins are not checked, and no pin is disconnected.
  OptionalOut<bool> uart0_pins{"uart0_pins"}, uart1_pins{"uart1_pins"}, i2c_pins{"i2c_pins"};

  SystemModule(sc_core::sc_module_name name, const SystemParams& params);

 private:
  void on_reset(ResetKind) override;
  void update();
  Picoseconds vtp_time_;
  Picoseconds vtp_ready_at_ = kNever;
  bool vtp_clrz_ = true;
  Timer written_;
};

}  // namespace fovea::periph
