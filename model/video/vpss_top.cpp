#include "model/video/vpss_top.h"

namespace fovea::video {

VpssTop::VpssTop(sc_core::sc_module_name name) : BusTarget(name, regs) {
  add_power_gate(psc_enabled);
  for (unsigned k = 0; k < kOutputs; ++k)
    add_interrupt("vpssint" + std::to_string(k), vpssint[k]);
  // Only processes of this block drive the outputs: register writes arrive in several other
  // processes.
  for (VpssRegs::Select* r : {&regs.intsel1, &regs.intsel2, &regs.intsel3})
    r->on_write([this](std::uint32_t) { selection_.soon(); });
  regs.evtsel.on_write([this](std::uint32_t) { events_selected(); });
  const auto controls = [this](std::uint32_t) { controls_.soon(); };
  regs.pccr.on_write(controls);
  regs.bcr.on_write(controls);
  regs.clkctrl.on_write(controls);
  SC_METHOD(route);
  for (std::size_t i = 0; i < isif_int.size(); ++i) sensitive << isif_int[i];
  sensitive << venc_int << selection_.event();
  SC_METHOD(drive_controls);
  sensitive << controls_.event();
}

void VpssTop::route() {
  std::uint32_t level = 0;
  for (unsigned i = 0; i < isif_int.size(); ++i) level |= std::uint32_t{isif_int[i].read()} << i;
  level |= std::uint32_t{venc_int.read()} << kVencSource;
  regs.intstat.set(regs.intstat.get() | (level & ~level_));
  level_ = level;
  for (unsigned k = 0; k < kOutputs; ++k) vpssint[k].write((level >> source_of(k) & 1) != 0);
  route_events(level);
}

/// The EDMA takes rising edges, also such as a new selection makes.
void VpssTop::route_events(std::uint32_t level) {
  std::uint32_t now = 0;
  for (unsigned k = 0; k < kEvents; ++k)
    now |= (level >> regs.evtsel.fields()[k]->get() & 1) << k;
  for (unsigned k = 0; k < kEvents; ++k)
    if ((now & ~event_level_) >> k & 1 && on_event) on_event(k + 1);
  event_level_ = now;
}

void VpssTop::events_selected() {
  for (unsigned k = 0; k < kEvents; ++k) {
    const std::uint32_t source = regs.evtsel.fields()[k]->get();
    if (source < isif_int.size() || source == kVencSource || source == kNoSource) continue;
    diagnostics().not_modelled("VPSS EVTSEL gives VPSS_EVT" + std::to_string(k + 1) + " to source " +
                               std::to_string(source) + ", which is silent here");
  }
  selection_.soon();
}

void VpssTop::drive_controls() {
  isif_gate.write(regs.pccr.isif.get() != 0);
  vpbe_gate.write(regs.clkctrl.vpbe.get() != 0);
  venc_clk_sel.write(regs.clkctrl.venc.get() != 0);
  isif_owns_write_buffer.write(regs.bcr.isif_wb.get() != 0);
  read_priority.write(regs.bcr.rd_pri.get());
  write_priority.write(regs.bcr.wr_pri.get());
}

}  // namespace fovea::video
