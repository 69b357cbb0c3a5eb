#include "model/mem/ddr_module.h"

#include "model/mem/ddr_decode.h"

namespace fovea::mem {

DdrModule::DdrModule(sc_core::sc_module_name name, const DdrParams& params)
    : BusTarget(name, regs), store_(params.size_bytes()), controller_(params, store_, *this) {
  SC_HAS_PROCESS(DdrModule);
  socket.bind(*this);
  lookahead.bind(*this);
  SC_METHOD(clocks_changed);
  sensitive << ddr_clk << scr_clk;
  SC_METHOD(enabled_changed);
  sensitive << enabled;
  for (Reg* r : regs.regs()) r->on_write([this](std::uint32_t) { reconfigure(); });
}

void DdrModule::settle(Picoseconds now) {
  while (controller_.next_decision() <= now) controller_.step();
  controller_.catch_up(now);
}

void DdrModule::enabled_changed() { enabled_ = enabled.read(); }

void DdrModule::clocks_changed() {
  settle(kernel_time());
  controller_.set_clocks(ddr_clk.read(), scr_clk.read(), kernel_time());
  replanned_.notify(sc_core::SC_ZERO_TIME);
}

/// SDBCR is written with TIMUNLOCK to load CL and the timing; the write that locks it again ends
/// the initialisation (UBL's order). The controller keeps programmed values, whatever the part
/// would like.
void DdrModule::reconfigure() {
  const Picoseconds now = kernel_time();
  settle(now);
  const DdrConfig c = programmed();
  if (c.timing.CL < 2) return;  // reset pattern of a half-written register: keep the old timing
  controller_.configure(c, now);
  replanned_.notify(sc_core::SC_ZERO_TIME);
  if (!regs.sdbcr.timunlock && regs.sdbcr.sdramen) ready_ = true;
}

DdrConfig DdrModule::programmed() const { return decode(regs); }

[[gnu::flatten]] Taken DdrModule::arrive(MemRequest& m, Picoseconds at) {
  const bool outside = std::uint64_t{m.address} + m.bytes > store_.size();
  if (!ready_ || !enabled_ || outside || !controller_.running()) [[unlikely]] {
    Diagnostics::instance().guest(outside ? "access beyond the end of the SDRAM"
                                          : "access to the SDRAM before its controller runs");
    return Taken::kRefused;
  }
  DdrRequest r;
  r.cookie = &m;
  r.master = m.master;
  r.priority = m.priority;
  r.write = m.write;
  r.bytes = m.bytes;
  r.address = m.address;
  r.critical = m.critical;
  r.data = m.data;
  r.parts = m.parts;
  return controller_.submit(r, at) ? Taken::kYes : Taken::kWaits;
}

tlm::tlm_sync_enum DdrModule::nb_transport_fw(MemRequest& m, MemPhase& phase,
                                              sc_core::sc_time& delay) {
  if (phase != MemPhase::kRequest) return tlm::TLM_ACCEPTED;
  switch (arrive(m, now_() + delay.value())) {
    case Taken::kYes: return tlm::TLM_UPDATED;
    case Taken::kWaits: return tlm::TLM_ACCEPTED;
    default: return tlm::TLM_COMPLETED;
  }
}

void DdrModule::ddr_accepted(void* cookie, Picoseconds at) {
  MemPhase phase = MemPhase::kAccepted;
  static_cast<MemRequest*>(cookie)->door_opener = controller_.door_opener();
  const Picoseconds now = now_();
  sc_core::sc_time delay = ps_time(at > now ? at - now : 0);
  socket->nb_transport_bw(*static_cast<MemRequest*>(cookie), phase, delay);
}

void DdrModule::ddr_read_done(void* cookie, Picoseconds first, Picoseconds last) {
  auto& r = *static_cast<MemRequest*>(cookie);
  r.first = first;
  r.last = last;
  r.slave_waited = controller_.read_waited();
  MemPhase phase = MemPhase::kResponse;
  sc_core::sc_time delay = ps_time(first - now_());
  socket->nb_transport_bw(r, phase, delay);
}

unsigned DdrModule::transport_dbg(MemRequest& r) {
  if (r.address >= store_.size()) return 0;
  const auto n =
      static_cast<unsigned>(std::min<std::uint64_t>(r.bytes, store_.size() - r.address));
  if (r.write)
    controller_.debug_write(r.address, r.data, n);
  else
    controller_.debug_read(r.address, r.data, n);
  return n;
}

}  // namespace fovea::mem
