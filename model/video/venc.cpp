#include "model/video/venc.h"

#include "model/common/burst_master.h"

namespace fovea::video {

Venc::Venc(sc_core::sc_module_name name, const VpssParams& params)
    : BusTarget(name, regs), params_(params) {
  add_clock(clock);
  add_power_gate(psc_enabled);
  for (Reg* r : {static_cast<Reg*>(&regs.vmod), static_cast<Reg*>(&regs.clkctl)})
    r->on_write([this](std::uint32_t) { reconsider_timer_.soon(); });
  SC_METHOD(reconsider);
  sensitive << clock << psc_enabled << vpbe_gate << clk_sel << reconsider_timer_.event();
  SC_METHOD(tick);
  sensitive << line_timer_.event();
  dont_initialize();
}

bool Venc::wanted() const {
  return regs.vmod.venc && regs.clkctl.venc && clock_.running() && clocked();
}

Frequency Venc::input_frequency() const {
  const Frequency f = clock.read();
  return clk_sel.read() && params_.venc_clk_sel.is("halves") ? Frequency(f.num, f.den * 2) : f;
}

void Venc::on_reset(ResetKind) {
  if (standard_) stop_raster();
  reconsider_timer_.soon();
}

void Venc::stop_raster() {
  standard_ = nullptr;
  line_timer_.cancel();
  osd->stop();
  display->raster_off();
}

void Venc::reconsider() {
  if (input_frequency() != clock_.frequency()) {
    clock_.restart(input_frequency(), kernel_time());
    if (standard_ && clock_.running()) schedule();
  }
  if (regs.vmod.venc && (regs.vmod.vmd || regs.vmod.slave || regs.vmod.hdmd || regs.vmod.nsit ||
                         regs.vmod.tvtyp.get() > 1))
    diagnostics().not_modelled("VENC mode other than standard 525/60 or 625/50");
  if (regs.vmod.venc && !regs.vmod.vie)
    diagnostics().not_modelled("VENC VMOD.VIE = 0: the analogue output shows the picture");
  const bool on = wanted();
  if (standard_ && (!on || standard_ != &chosen())) stop_raster();
  if (on && !standard_) {
    standard_ = &chosen();
    origin_ = clock_.edge_after(kernel_time());
    next_line_ = 0;
    line_out_ = false;
    schedule();
  }
}

void Venc::schedule() {
  line_timer_.move_to(clock_.edge(origin_ + next_line_ * standard_->line_bytes));
}

void Venc::tick() {
  const Standard& s = *standard_;
  if (line_out_) {
    DisplayLine out = osd->finish();
    if (regs.vmod.blnk) out.uyvy = nullptr;
    display->line(out);
  }
  const LinePosition now = locate(s, next_line_);
  const bool f = now.field % 2 != 0;
  if (now.line == s.field_start[f]) {
    regs.vstat.fidst.set(f);
    osd->field_start(s, f);
    interrupt.raise();
  }
  line_out_ = !s.at(now.line).v;
  // Vertical blanking is longer than the read-ahead, so a fetched line belongs to the current
  // field.
  const std::uint64_t ahead = next_line_ + params_.read_ahead_lines();
  const LinePosition then = locate(s, ahead);
  const Standard::Lines& fv = s.at(then.line);
  if (!fv.v)
    osd->fetch({&s, &clock_, origin_ + ahead * s.line_bytes + s.active_offset(), then.line, fv.f});
  ++next_line_;
  schedule();
}

}  // namespace fovea::video
