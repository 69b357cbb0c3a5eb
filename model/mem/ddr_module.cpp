#include "model/mem/ddr_module.h"

namespace fovea::mem {

DdrModule::DdrModule(sc_core::sc_module_name name, const DdrParams& params)
    : BusTarget(name, regs), store_(params.size_bytes()), controller_(params, store_, *this) {
  SC_HAS_PROCESS(DdrModule);
  socket.bind(*this);
  lookahead.bind(*this);
  SC_METHOD(clocks_changed);
  sensitive << ddr_clk << scr_clk;
  for (Reg* r : regs.regs()) r->on_write([this](std::uint32_t) { reconfigure(); });
}

void DdrModule::settle(Picoseconds now) {
  while (controller_.next_decision() <= now) controller_.step();
  controller_.catch_up(now);
}

void DdrModule::clocks_changed() {
  settle(kernel_time());
  controller_.set_clocks(ddr_clk.read(), scr_clk.read(), kernel_time());
}

/// SDBCR is written with TIMUNLOCK to load CL and the timing; the write that locks it again ends
/// the initialisation (UBL's order). The controller keeps programmed values, whatever the part
/// would like.
void DdrModule::reconfigure() {
  const Picoseconds now = kernel_time();
  settle(now);
  DdrConfig c;
  c.timing.CL = regs.sdbcr.cl.get();
  c.timing.banks = std::min(1u << regs.sdbcr.ibank.get(), DdrDevice::kMaxBanks);
  c.timing.nRFC = regs.sdtimr.rfc.get() + 1;
  c.timing.nRP = regs.sdtimr.rp.get() + 1;
  c.timing.nRCD = regs.sdtimr.rcd.get() + 1;
  c.timing.nWR = regs.sdtimr.wr.get() + 1;
  c.timing.nRAS = regs.sdtimr.ras.get() + 1;
  c.timing.nRC = regs.sdtimr.rc.get() + 1;
  c.timing.nRRD = regs.sdtimr.rrd.get() + 1;
  c.timing.nWTR = regs.sdtimr.wtr.get() + 1;
  c.timing.nRTP = regs.sdtimr2.rtp.get() + 1;
  c.read_latency = regs.ddrphycr.rl.get();
  c.refresh_interval = regs.sdrcr.rr.get();
  c.old_count = regs.pbbpr.pr_old_count.get();
  c.page_log2 = 9 + regs.sdbcr.pagesize.get();  // 256 words of 2 bytes
  c.bank_on_top = regs.sdbcr.ibank_pos.get() != 0;
  if (c.timing.CL < 2) return;  // reset pattern of a half-written register: keep the old timing
  controller_.configure(c, now);
  if (!regs.sdbcr.timunlock && regs.sdbcr.sdramen) ready_ = true;
}

tlm::tlm_sync_enum DdrModule::nb_transport_fw(tlm::tlm_generic_payload& gp, tlm::tlm_phase& phase,
                                              sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_REQ) return tlm::TLM_ACCEPTED;
  if (!ready_ || !enabled.read() || gp.get_address() + gp.get_data_length() > store_.size()) {
    Diagnostics::instance().guest(gp.get_address() + gp.get_data_length() > store_.size()
                                      ? "access beyond the end of the SDRAM"
                                      : "access to the SDRAM before its controller runs");
    gp.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
    return tlm::TLM_COMPLETED;
  }
  MemExtension* ext = nullptr;
  gp.get_extension(ext);
  DdrRequest r;
  ext->payload = &gp;
  r.cookie = ext;
  r.master = ext->master;
  r.priority = ext->priority;
  r.write = gp.is_write();
  r.bytes = static_cast<std::uint8_t>(gp.get_data_length());
  r.address = static_cast<std::uint32_t>(gp.get_address());
  r.critical = ext->critical;
  r.data = gp.get_data_ptr();
  if (!controller_.submit(r, now_() + delay.value())) return tlm::TLM_ACCEPTED;
  phase = tlm::END_REQ;
  return tlm::TLM_UPDATED;
}

void DdrModule::ddr_accepted(void* cookie, Picoseconds at) {
  auto& gp = *static_cast<MemExtension*>(cookie)->payload;
  tlm::tlm_phase phase = tlm::END_REQ;
  const Picoseconds now = now_();
  sc_core::sc_time delay = ps_time(at > now ? at - now : 0);
  socket->nb_transport_bw(gp, phase, delay);
}

void DdrModule::ddr_read_done(void* cookie, Picoseconds first, Picoseconds last) {
  auto* ext = static_cast<MemExtension*>(cookie);
  tlm::tlm_generic_payload& gp = *ext->payload;
  ext->first = first;
  ext->last = last;
  gp.set_response_status(tlm::TLM_OK_RESPONSE);
  tlm::tlm_phase phase = tlm::BEGIN_RESP;
  sc_core::sc_time delay = ps_time(first - now_());
  socket->nb_transport_bw(gp, phase, delay);
}

void DdrModule::b_transport(tlm::tlm_generic_payload& gp, sc_core::sc_time&) {
  // Untimed access would bypass the order of the path.
  gp.set_response_status(tlm::TLM_COMMAND_ERROR_RESPONSE);
}

unsigned DdrModule::transport_dbg(tlm::tlm_generic_payload& gp) {
  const std::uint64_t a = gp.get_address();
  if (a >= store_.size()) return 0;
  const auto n = static_cast<unsigned>(
      std::min<std::uint64_t>(gp.get_data_length(), store_.size() - a));
  if (gp.is_write())
    std::memcpy(store_.at(a), gp.get_data_ptr(), n);
  else
    std::memcpy(gp.get_data_ptr(), store_.at(a), n);
  return n;
}

}  // namespace fovea::mem
