// Clock multiplexers between the SYSCLKs of the PLL controllers and the blocks.
#pragma once
#include <cstdint>
#include <systemc>

#include "model/common/sc_ports.h"
#include "model/periph/clocked_target.h"

namespace fovea::periph {

/// The clock multiplexers that PERI_CLK_CTRL and VPSS_CLK_CTRL of the system module control (TI
/// boot loader and register header for the DM36x). Not modelled: EXTCLK, the CLKOUT pins, the
/// dividers of voice codec, key scan and ADC. VPSS_CLKMD has no effect on a frequency.
class ClockTree : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(ClockTree);
  ClockIn osc{"osc"};
  ClockIn pll1_sysclk2{"pll1_sysclk2"}, pll1_sysclk4{"pll1_sysclk4"}, pll1_sysclk5{"pll1_sysclk5"},
      pll1_sysclk6{"pll1_sysclk6"}, pll1_sysclk7{"pll1_sysclk7"};
  ClockIn pll2_sysclk2{"pll2_sysclk2"}, pll2_sysclk3{"pll2_sysclk3"}, pll2_sysclk5{"pll2_sysclk5"};
  /// Pixel clock from the video input pin, used if VPSS_MUXSEL = 3; may stay unbound.
  sc_core::sc_port<sc_core::sc_signal_in_if<Frequency>, 1, sc_core::SC_ZERO_OR_MORE_BOUND> pclk{
      "pclk"};
  sc_core::sc_in<std::uint32_t> peri_clk_ctrl{"peri_clk_ctrl"}, vpss_clk_ctrl{"vpss_clk_ctrl"};

  OptionalOut<Frequency> arm_clk{"arm_clk"};    ///< bit 29 set: PLL2 SYSCLK2, otherwise PLL1
                                                ///< SYSCLK2
  OptionalOut<Frequency> ddr_clk{"ddr_clk"};    ///< bit 27 set: PLL2 SYSCLK3 / 2, otherwise PLL1
                                                ///< SYSCLK7 / 2
  OptionalOut<Frequency> edma_clk{"edma_clk"};  ///< PLL1 SYSCLK4; also clocks the configuration bus
  OptionalOut<Frequency> vpss_clk{"vpss_clk"};  ///< PLL1 SYSCLK5
  /// VENC_CLK_SRC selects PLL1 SYSCLK6, PLL2 SYSCLK5 or the crystal; stopped while VENCLKEN = 0.
  OptionalOut<Frequency> venc_clk{"venc_clk"};
  OptionalOut<Frequency> aux_clk{"aux_clk"};      ///< oscillator; clocks timers, UART0 and I2C
  OptionalOut<Frequency> uart1_clk{"uart1_clk"};  ///< PLL1 SYSCLK4

  explicit ClockTree(sc_core::sc_module_name name);

  /// Crossbar, EDMA and registers at this clock once PLL1 multiplies, which no chip can have; stopped: SYSCLK4.
  void set_crossbar(Frequency f) { crossbar_ = f; }

 private:
  void update();
  Frequency venc() const;
  Frequency crossbar() const;
  Frequency crossbar_;
  DiagnosticsRef diagnostics_ = DiagnosticsRef::current();
};

}  // namespace fovea::periph
