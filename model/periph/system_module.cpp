#include "model/periph/system_module.h"

namespace fovea::periph {

SystemRegs::SystemRegs(std::uint32_t bootcfg_pins)
    : RegBank("SYSTEM"),
      bootcfg(*this, "BOOTCFG", 0x14, Mode::kRo, "boot configuration pins", bootcfg_pins) {
  for (unsigned n = 0; n < 5; ++n)
    pinmux.emplace_back(*this, "PINMUX" + std::to_string(n), 4 * n, Mode::kRw,
                        "pin functions; no pin is disconnected");
  for (unsigned n = 0; n < 8; ++n)
    debounce.emplace_back(*this, "DEBOUNCE" + std::to_string(n), 0x54 + 4 * n, "GPIO debounce");
}

SystemModule::SystemModule(sc_core::sc_module_name name, const SystemParams& params)
    : WithRegs(static_cast<std::uint32_t>(params.bootcfg())),
      BusTarget(name, regs),
      vtp_time_(params.vtp_time()) {
  for (Reg* r : std::initializer_list<Reg*>{&regs.mstpri0, &regs.mstpri1, &regs.vpss_clk_ctrl,
                                            &regs.peri_clk_ctrl, &regs.misc, &regs.edma_evtmux,
                                            &regs.arm_intmux})
    r->on_write([this](std::uint32_t) { written_.soon(); });
  regs.pinmux[3].on_write([this](std::uint32_t) { written_.soon(); });
  regs.deepsleep.on_write([this](std::uint32_t word) {
    if (word >> 31) diagnostics().not_modelled("deep sleep");
  });
  regs.vtpiocr.on_write([this](std::uint32_t) {
    const bool clrz = regs.vtpiocr.clrz.get();
    if (clrz && !vtp_clrz_) vtp_ready_at_ = kernel_time() + vtp_time_;
    vtp_clrz_ = clrz;
  });
  regs.vtpiocr.on_read(
      [this] { regs.vtpiocr.ready.set(vtp_clrz_ && kernel_time() >= vtp_ready_at_); });
  // LOCK, LOCK123 and LOOPLOCK change together; boot code waits for bits 26:24.
  constexpr std::uint32_t kLockFlags = 0x1F000000;
  regs.pll0_config.on_read([this] { regs.pll0_config.set(pll1_locked.read() ? kLockFlags : 0); });
  regs.pll1_config.on_read([this] { regs.pll1_config.set(pll2_locked.read() ? kLockFlags : 0); });
  SC_METHOD(update);
  sensitive << written_.event();
}

void SystemModule::on_reset(ResetKind) {
  vtp_ready_at_ = kNever;
  vtp_clrz_ = true;
  written_.soon();
}

void SystemModule::update() {
  mstpri0.write(regs.mstpri0.get());
  mstpri1.write(regs.mstpri1.get());
  vpss_clk_ctrl.write(regs.vpss_clk_ctrl.get());
  peri_clk_ctrl.write(regs.peri_clk_ctrl.get());
  misc.write(regs.misc.get());
  edma_evtmux.write(regs.edma_evtmux.get());
  arm_intmux.write(regs.arm_intmux.get());
  const std::uint32_t pinmux3 = regs.pinmux[3].get();
  uart0_pins.write(pinmux3 >> 19 & 1);
  uart1_pins.write((pinmux3 >> 15 & 3) == 2);
  i2c_pins.write((pinmux3 >> 21 & 3) == 2 && (pinmux3 >> 23 & 3) == 2);
}

}  // namespace fovea::periph
