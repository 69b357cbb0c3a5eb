// From SYSCLKs to the clocks of the blocks.
#pragma once
#include <cstdint>
#include <systemc>

#include "model/common/sc_ports.h"
#include "model/periph/clocked_target.h"

namespace fovea::periph {

/// The clock multiplexers that PERI_CLK_CTRL and VPSS_CLK_CTRL of the system module steer.
/// (reference: TI boot loader, TI register header.) Not modelled: EXTCLK, CLKOUT pins, the dividers
/// of voice codec, key scan and ADC; VPSS_CLKMD does not change a frequency here.
class ClockTree : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(ClockTree);
  ClockIn osc{"osc"};
  ClockIn pll1_sysclk2{"pll1_sysclk2"}, pll1_sysclk4{"pll1_sysclk4"}, pll1_sysclk5{"pll1_sysclk5"},
      pll1_sysclk6{"pll1_sysclk6"}, pll1_sysclk7{"pll1_sysclk7"};
  ClockIn pll2_sysclk2{"pll2_sysclk2"}, pll2_sysclk3{"pll2_sysclk3"}, pll2_sysclk5{"pll2_sysclk5"};
  /// Pixel clock from the video input pin, for VPSS_MUXSEL = 3; may stay unbound.
  sc_core::sc_port<sc_core::sc_signal_in_if<Frequency>, 1, sc_core::SC_ZERO_OR_MORE_BOUND> pclk{
      "pclk"};
  sc_core::sc_in<std::uint32_t> peri_clk_ctrl{"peri_clk_ctrl"}, vpss_clk_ctrl{"vpss_clk_ctrl"};

  OptionalOut<Frequency> arm_clk{"arm_clk"};    ///< bit 29: PLL2 SYSCLK2, else PLL1 SYSCLK2
  OptionalOut<Frequency> ddr_clk{"ddr_clk"};    ///< bit 27: PLL2 SYSCLK3 / 2, else PLL1 SYSCLK7 / 2
  OptionalOut<Frequency> edma_clk{"edma_clk"};  ///< PLL1 SYSCLK4; also the configuration bus
  OptionalOut<Frequency> vpss_clk{"vpss_clk"};  ///< PLL1 SYSCLK5
  /// VENC_CLK_SRC: PLL1 SYSCLK6, PLL2 SYSCLK5 or crystal; off while VENCLKEN = 0.
  OptionalOut<Frequency> venc_clk{"venc_clk"};
  OptionalOut<Frequency> aux_clk{"aux_clk"};      ///< oscillator: timers, UART0, I2C
  OptionalOut<Frequency> uart1_clk{"uart1_clk"};  ///< PLL1 SYSCLK4

  explicit ClockTree(sc_core::sc_module_name name);

 private:
  void update();
  Frequency venc() const;
};

}  // namespace fovea::periph
