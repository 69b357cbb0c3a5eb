#include "model/periph/psc.h"

namespace fovea::periph {

namespace {
/// MDSTAT of a state without transition, with the bits of the chip family: 8 LRST, 9 LRSTDONE, 10
/// MRST (1 in states 2 and 3), 11 MRSTDONE, 12 clock enabled (states 1 and 3).
std::uint32_t mdstat_of(std::uint32_t state) {
  return 0xB00u | (state >= 2 ? 0x400u : 0u) | (state & 1 ? 0x1000u : 0u) | state;
}
bool on_at_reset(unsigned n) {
  switch (n) {
    case kLpscArm:
    case kLpscSystem:
    case kLpscAemif:
    case kLpscUart0:
    case kLpscTimer0:
    case kLpscTimer1:
    case kLpscTimer2:
      return true;
  }
  return false;
}
}  // namespace

PscRegs::PscRegs() : RegBank("PSC") {
  for (unsigned n = 0; n < kLpscCount; ++n) {
    const std::uint32_t state = on_at_reset(n) ? 3 : 0;
    mdstat.emplace_back(*this, "MDSTAT" + std::to_string(n), 0x800 + 4 * n, Mode::kRo,
                        "bits 5:0 state, 10 out of reset, 12 clock on", mdstat_of(state));
    mdctl.emplace_back(*this, "MDCTL" + std::to_string(n), 0xA00 + 4 * n, Mode::kRw,
                       "bits 4:0 next state", 0x100u | state);
  }
}

Psc::Psc(sc_core::sc_module_name name, const PscParams& params)
    : BusTarget(name, regs), transition_time_(params.transition_time()) {
  regs.ptcmd.on_write([this](std::uint32_t word) {
    regs.ptcmd.set(0);
    command(word);
  });
  SC_METHOD(update);
  sensitive << wake_.event();
}

void Psc::on_reset(ResetKind) {
  again_ = false;
  done_at_ = kNever;
  wake_.soon();
}

void Psc::command(std::uint32_t domains) {
  if (!(domains & 1)) return;
  if (done_at_ != kNever) {
    diagnostics().guest("PSC: PTCMD while domain 0 is in transition");
    again_ = true;
    return;
  }
  for (unsigned n = 0; n < kLpscCount; ++n)
    goal_[n] = static_cast<std::uint8_t>(regs.mdctl[n].get() & 0x1F);
  regs.ptstat.set(1);
  done_at_ = kernel_time() + transition_time_;
  wake_.soon();
}

void Psc::update() {
  if (kernel_time() >= done_at_) {
    done_at_ = kNever;
    regs.ptstat.set(0);
    for (unsigned n = 0; n < kLpscCount; ++n)
      if (goal_[n] <= 3) regs.mdstat[n].set(mdstat_of(goal_[n]));
    if (again_) {
      again_ = false;
      command(1);
    }
  }
  for (unsigned n = 0; n < kLpscCount; ++n) enabled[n].write((regs.mdstat[n].get() & 0x3F) == 3);
  wake_.move_to(done_at_);
}

}  // namespace fovea::periph
