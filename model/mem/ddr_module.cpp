#include "model/mem/ddr_module.h"

#include <cstdio>

#include "model/common/timer.h"
#include "model/mem/ddr_decode.h"

namespace fovea::mem {
namespace {

/// What BOOTUNLOCK opens: the type of the SDRAM (SPRUFI2), and the settings of drive, strobe, DLL and termination that
/// go to the part with it (family: SPRUH82C 14.4.2).
std::uint32_t type_bits(const DdrRegs::Sdbcr& r) {
  std::uint32_t mask = 0;
  for (const Field* f : {&r.sdramen, &r.ddren, &r.ddr2en, &r.mddren, &r.ddrdrive, &r.ddrdrive1, &r.ddrdllen, &r.ddqs,
                         &r.term})
    mask |= f->mask();
  return mask;
}

}  // namespace

DdrModule::DdrModule(sc_core::sc_module_name name, const DdrParams& params, memsys::MemorySystem& memory)
    : BusTarget(name, regs),
      params_(params),
      memory_(memory),
      check_(params, memory.controller(), diagnostics()),
      sdtimr_(regs.sdtimr.get()),
      sdtimr2_(regs.sdtimr2.get()),
      cl_(regs.sdbcr.cl.get()),
      type_(regs.sdbcr.get() & type_bits(regs.sdbcr)) {
  add_power_gate(enabled);
  SC_HAS_PROCESS(DdrModule);
  memory_.set_admission(*this);
  update_open();
  add_statistics(controller().stats);
  SC_METHOD(clocks_changed);
  sensitive << ddr_clk << scr_clk;
  SC_METHOD(enabled_changed);
  sensitive << enabled;
  for (Reg* r : regs.regs()) r->on_write([this](std::uint32_t) { reconfigure(); });
  regs.sdbcr.on_write([this](std::uint32_t) {
    keep_latency_while_locked();
    keep_type_while_locked();
    reconfigure();
  });
  regs.sdtimr.on_write([this](std::uint32_t) { keep_while_locked(regs.sdtimr, sdtimr_); });
  regs.sdtimr2.on_write([this](std::uint32_t) { keep_while_locked(regs.sdtimr2, sdtimr2_); });
  regs.sdrstat.on_read([this] {
    memory_.settle(kernel_time());
    regs.sdrstat.phyrdy.set(controller().asleep() != LowPower::kClockStop);
  });
}

void DdrModule::on_reset(ResetKind) {
  sdtimr_ = regs.sdtimr.get();
  sdtimr2_ = regs.sdtimr2.get();
  cl_ = regs.sdbcr.cl.get();
  type_ = regs.sdbcr.get() & type_bits(regs.sdbcr);
  lost_ = 0;
  unlocked_ = timed_ = boot_unlocked_ = false;
  in_reset_ = true;
  reconfigure();
  check_.restart();
  ready_ = false;  // although the reset value of SDBCR is that of a locked register
  update_open();
  note_initialised();
}

void DdrModule::enabled_changed() {
  enabled_ = enabled.read();
  update_open();
  note_initialised();
}

void DdrModule::note_initialised() {
  const auto& r = regs.sdbcr;
  initialised.write(ready_ && timed_ && !r.timunlock && !r.bootunlock && enabled_ &&
                    controller().running());
}

void DdrModule::clocks_changed() {
  const Picoseconds now = kernel_time();
  memory_.settle(now);
  if (ready_ && ddr_clk.read().stopped() && !refreshes_itself(controller().asleep()))
    diagnostics().guest("the SDRAM's clock stops outside self-refresh: nothing refreshes it; the model keeps its data");
  controller().set_clocks(ddr_clk.read(), scr_clk.read(), now);
  examined_ = false;
  update_open();
  memory_.controller_changed();
  note_initialised();
}

/// SDTIMR and SDTIMR2 can be written while SDBCR.TIMUNLOCK is set.
void DdrModule::keep_while_locked(Reg& timing, std::uint32_t& kept) {
  if (regs.sdbcr.timunlock) {
    kept = timing.get();
  } else if (timing.get() != kept) {
    diagnostics().guest(timing.name() + " written without SDBCR TIMUNLOCK: write lost");
    timing.set(kept);
  }
  reconfigure();
}

/// The manual has TIMUNLOCK open CL; the vendor's boot loader writes its last CL with BOOTUNLOCK only.
/// Either does here (assumed), in the write itself or in the one before.
void DdrModule::keep_latency_while_locked() {
  auto& r = regs.sdbcr;
  const bool unlocks = r.timunlock || r.bootunlock;
  if (r.cl.get() != cl_ && !unlocks && !unlocked_) {
    diagnostics().guest("SDBCR CL written without TIMUNLOCK or BOOTUNLOCK: write lost");
    r.cl.set(cl_);
  }
  cl_ = r.cl.get();
  unlocked_ = unlocks;
}

/// The type bits are taken if BOOTUNLOCK was set before the write: the manuals' order is a write of BOOTUNLOCK, then
/// one of 0 to it with the values. TI's boot loader writes them first without, and in this order behind; so what a
/// write loses is told with the first access to the SDRAM, if the last write has lost it.
void DdrModule::keep_type_while_locked() {
  auto& r = regs.sdbcr;
  const std::uint32_t mask = type_bits(r), wanted = r.get() & mask;
  lost_ = boot_unlocked_ ? 0 : wanted ^ type_;
  if (boot_unlocked_) type_ = wanted;
  r.set((r.get() & ~mask) | type_);
  boot_unlocked_ = r.bootunlock.get();
}

void DdrModule::warn_of_lost_type() const {
  char text[96];
  std::snprintf(text, sizeof text,
                "SDBCR type bits 0x%08x written without BOOTUNLOCK in the write before: write lost", lost_);
  diagnostics().guest(text);
}

/// SDBCR is written with TIMUNLOCK to load CL and the timing; the write that locks it again ends
/// the initialisation (UBL's order). The controller keeps programmed values, whatever the part
/// would like.
void DdrModule::reconfigure() {
  const Picoseconds now = kernel_time();
  memory_.settle(now);
  controller().configure(idealised(programmed(), params_), now);
  memory_.controller_changed();
  if (!regs.sdbcr.sdramen)
    ready_ = false;
  else if (!regs.sdbcr.timunlock)
    ready_ = true;
  if (regs.sdbcr.timunlock) timed_ = true;
  examined_ = false;
  update_open();
  note_initialised();
}

DdrConfig DdrModule::programmed() const { return decode(regs); }

bool DdrModule::admit(std::uint32_t offset, unsigned bytes) {
  if (in_reset_) return false;
  const std::uint64_t end = std::uint64_t{offset} + bytes;
  const bool outside = end > memory_.map().ddr_window;
  if (outside || !ready_ || !enabled_ || !controller().running()) {
    diagnostics().guest(outside ? "access beyond the SDRAM's 256 MiB of the memory map"
                                : "access to the SDRAM before its controller runs");
    return false;
  }
  if (!examined_) {
    examined_ = true;
    update_open();
    check_.begin();
    if (lost_) warn_of_lost_type();
    for (const std::string& line : invalid_register_values(regs, params_)) diagnostics().guest(line);
    check_.warn(programmed(), ddr_clk.read());
  }
  if (end > store().size())
    diagnostics().guest("access beyond the SDRAM's end (ddr.part, " + std::to_string(store().size() >> 20) +
                        " MiB): it repeats from its beginning");
  return true;
}

}  // namespace fovea::mem
