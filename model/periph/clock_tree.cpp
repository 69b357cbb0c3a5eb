#include "model/periph/clock_tree.h"

namespace fovea::periph {

ClockTree::ClockTree(sc_core::sc_module_name name) : sc_module(name) {
  SC_METHOD(update);
  sensitive << osc << pll1_sysclk2 << pll1_sysclk4 << pll1_sysclk5 << pll1_sysclk6 << pll1_sysclk7
            << pll2_sysclk2 << pll2_sysclk3 << pll2_sysclk5 << pclk << peri_clk_ctrl
            << vpss_clk_ctrl;
}

Frequency ClockTree::venc() const {
  const std::uint32_t ctrl = vpss_clk_ctrl.read();
  if (!(ctrl >> 3 & 1)) return {};
  switch (ctrl & 3) {
    case 2:
      diagnostics_.not_modelled("VPSS_CLK_CTRL: EXTCLK as VENC clock");
      return {};
    case 3:
      return pclk.size() ? pclk->read() : Frequency{};
  }
  switch (ctrl >> 5 & 3) {
    case 0:
      return pll1_sysclk6.read();
    case 1:
      return pll2_sysclk5.read();
    default:
      return osc.read();
  }
}

Frequency ClockTree::crossbar() const {
  const Frequency pll = pll1_sysclk4.read(), crystal = osc.read();
  const bool multiplied = pll.num * crystal.den > crystal.num * pll.den;
  return multiplied && !crossbar_.stopped() ? crossbar_ : pll;
}

void ClockTree::update() {
  const std::uint32_t peri = peri_clk_ctrl.read();
  arm_clk.write(peri >> 29 & 1 ? pll2_sysclk2.read() : pll1_sysclk2.read());
  ddr_clk.write((peri >> 27 & 1 ? pll2_sysclk3.read() : pll1_sysclk7.read()) / 2);
  edma_clk.write(crossbar());
  vpss_clk.write(pll1_sysclk5.read());
  venc_clk.write(venc());
  aux_clk.write(osc.read());
  uart1_clk.write(pll1_sysclk4.read());
}

}  // namespace fovea::periph
