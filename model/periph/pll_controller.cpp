#include "model/periph/pll_controller.h"

#include <algorithm>
#include <utility>

namespace fovea::periph {

namespace {
constexpr std::uint32_t kEnabledRatio1 = 0x8000;
std::uint32_t plldiv_offset(unsigned n) {
  return n <= 3 ? 0x118 + 4 * (n - 1) : 0x160 + 4 * (n - 4);
}
}  // namespace

PllRegs::PllRegs(const char* name, unsigned sysclks, std::uint32_t reset_type)
    : RegBank(name),
      rstype(*this, "RSTYPE", 0x0E4, Mode::kRo, "1 power-on, 2 warm, 4 watchdog reset",
             reset_type),
      systat(*this, "SYSTAT", 0x150, Mode::kRo, "SYSCLKs that are on", (1u << sysclks) - 1) {
  for (unsigned n = 1; n <= sysclks; ++n)
    plldiv.emplace_back(*this, "PLLDIV" + std::to_string(n), plldiv_offset(n), Mode::kRw,
                        "bits 4:0 ratio - 1, bit 15 enable; acts with GOSET", kEnabledRatio1);
}

PllController::PllController(sc_core::sc_module_name name, const char* bank, unsigned sysclks,
                             const PllParams& params)
    : WithRegs(bank, sysclks, static_cast<std::uint32_t>(params.reset_type())),
      BusTarget(name, regs),
      sysclk("sysclk", sysclks),
      lock_time_(params.lock_time()),
      go_time_(params.go_time()) {
  FOVEA_CHECK(sysclks <= kMaxSysclks, "too many SYSCLKs");
  ratio_.fill(kEnabledRatio1);
  regs.pllctl.on_write([this](std::uint32_t) { control_written(); });
  for (LockingRegister& l : locking_) {
    l.last = l.reg->get();
    l.reg->on_write([this, &l](std::uint32_t) {
      if (l.reg->get() != std::exchange(l.last, l.reg->get())) relock();
    });
  }
  regs.postdiv.on_write([this](std::uint32_t) { wake_.soon(); });
  for (unsigned n = 0; n < sysclks; ++n) {
    regs.plldiv[n].on_write([this, n](std::uint32_t) {
      const bool differs = (regs.plldiv[n].get() ^ ratio_[n]) & 0x801F;
      regs.dchange.set((regs.dchange.get() & ~(1u << n)) | std::uint32_t{differs} << n);
    });
  }
  regs.pllcmd.on_write([this](std::uint32_t word) {
    if (!(word & 1)) return;
    regs.pllstat.gostat.set(1);
    go_at_ = kernel_time() + go_time_;
    wake_.soon();
  });
  regs.cken.on_write([this](std::uint32_t) { regs.ckstat.set(regs.cken.get() & 3); });
  regs.systat.on_read([this] {
    std::uint32_t on = 0;
    for (unsigned n = 0; n < regs.plldiv.size(); ++n) on |= (ratio_[n] >> 15 & 1) << n;
    regs.systat.set(on);
  });
  SC_METHOD(update);
  sensitive << wake_.event() << osc;
}

void PllController::on_reset(ResetKind kind) {
  regs.rstype.set(kind == ResetKind::kPowerOn ? 1 : kind == ResetKind::kWarm ? 2 : 4);
  ratio_.fill(kEnabledRatio1);
  for (LockingRegister& l : locking_) l.last = l.reg->get();
  locked_ = pll_on_ = false;
  pllm_ = prediv_ = 0;
  lock_at_ = go_at_ = kNever;
  wake_.soon();
}

void PllController::control_written() {
  const bool on = !regs.pllctl.pllpwrdn && !regs.pllctl.pllrst;
  if (on != pll_on_) {
    pll_on_ = on;
    pllm_ = 0;  // after a reset, a PLL has no output before its first lock
    relock();
  }
  if (regs.pllctl.pllen && !regs.pllctl.pllensrc && !locked_)
    diagnostics().guest(regs.name() + ": PLLEN set before the PLL has locked");
  wake_.soon();
}

void PllController::relock() {
  locked_ = false;
  if (regs.pllctl.pllen && !regs.pllctl.pllensrc && pllm_)
    diagnostics().guest(regs.name() + ": multiplier or pre-divider changed while PLLEN = 1");
  lock_at_ = pll_on_ ? kernel_time() + lock_time_ : kNever;
  wake_.soon();
}

Frequency PllController::source() const {
  if (!regs.pllctl.pllen || regs.pllctl.pllensrc || !pllm_) return osc.read();
  return divided(vco(osc.read(), pllm_, prediv_), regs.postdiv.get());
}

void PllController::update() {
  const Picoseconds now = kernel_time();
  if (now >= lock_at_) {
    lock_at_ = kNever;
    locked_ = !vco(osc.read(), regs.pllm.get(), regs.prediv.get()).stopped();
    if (locked_) {
      pllm_ = regs.pllm.get();
      prediv_ = regs.prediv.get();
    }
  }
  if (now >= go_at_) {
    go_at_ = kNever;
    for (unsigned n = 0; n < regs.plldiv.size(); ++n) ratio_[n] = regs.plldiv[n].get();
    regs.dchange.set(0);
    regs.pllstat.gostat.set(0);
    regs.pllcmd.set(0);
  }
  regs.pllstat.lock.set(locked_);
  const Frequency f = source();
  for (unsigned n = 0; n < sysclk.size(); ++n) sysclk[n].write(divided(f, ratio_[n]));
  locked.write(locked_);
  wake_.move_to(std::min(lock_at_, go_at_));
}

}  // namespace fovea::periph
