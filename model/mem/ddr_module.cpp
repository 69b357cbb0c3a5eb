#include "model/mem/ddr_module.h"

#include <algorithm>

#include "model/mem/ddr_decode.h"

namespace fovea::mem {
namespace {

/// The part of the chip's memory map that belongs to the SDRAM (SPRS457E, memory map).
constexpr std::uint64_t kWindow = 256u << 20;

}  // namespace

DdrModule::DdrModule(sc_core::sc_module_name name, const DdrParams& params)
    : BusTarget(name, regs),
      params_(params),
      store_(params.size_bytes()),
      controller_(params, store_, *this),
      check_(params, controller_),
      sdtimr_(regs.sdtimr.get()),
      sdtimr2_(regs.sdtimr2.get()),
      cl_(regs.sdbcr.cl.get()) {
  add_power_gate(enabled);
  SC_HAS_PROCESS(DdrModule);
  socket.bind(*this);
  lookahead.bind(*this);
  add_statistics(controller_.stats);
  SC_METHOD(clocks_changed);
  sensitive << ddr_clk << scr_clk;
  SC_METHOD(enabled_changed);
  sensitive << enabled;
  for (Reg* r : regs.regs()) r->on_write([this](std::uint32_t) { reconfigure(); });
  regs.sdbcr.on_write([this](std::uint32_t) {
    keep_latency_while_locked();
    reconfigure();
  });
  regs.sdtimr.on_write([this](std::uint32_t) { keep_while_locked(regs.sdtimr, sdtimr_); });
  regs.sdtimr2.on_write([this](std::uint32_t) { keep_while_locked(regs.sdtimr2, sdtimr2_); });
  regs.sdrstat.on_read([this] {
    settle(kernel_time());
    regs.sdrstat.phyrdy.set(controller_.asleep() != LowPower::kClockStop);
  });
}

void DdrModule::settle(Picoseconds now) {
  while (controller_.next_decision() <= now) controller_.step();
  controller_.catch_up(now);
}

void DdrModule::enabled_changed() {
  enabled_ = enabled.read();
  open_ = ready_ && enabled_ && examined_;
  note_initialised();
}

void DdrModule::note_initialised() {
  const auto& r = regs.sdbcr;
  initialised.write(ready_ && timed_ && !r.timunlock && !r.bootunlock && enabled_ &&
                    controller_.running());
}

void DdrModule::clocks_changed() {
  const Picoseconds now = kernel_time();
  settle(now);
  if (ready_ && ddr_clk.read().stopped() && !refreshes_itself(controller_.asleep()))
    Diagnostics::instance().guest(
        "the SDRAM's clock stops outside self-refresh: nothing refreshes it; the model keeps its data");
  controller_.set_clocks(ddr_clk.read(), scr_clk.read(), now);
  examined_ = open_ = false;
  replanned_.soon();
  note_initialised();
}

/// SDTIMR and SDTIMR2 can be written while SDBCR.TIMUNLOCK is set.
void DdrModule::keep_while_locked(Reg& timing, std::uint32_t& kept) {
  if (regs.sdbcr.timunlock) {
    kept = timing.get();
  } else if (timing.get() != kept) {
    Diagnostics::instance().guest(timing.name() + " written without SDBCR TIMUNLOCK: write lost");
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
    Diagnostics::instance().guest("SDBCR CL written without TIMUNLOCK or BOOTUNLOCK: write lost");
    r.cl.set(cl_);
  }
  cl_ = r.cl.get();
  unlocked_ = unlocks;
}

/// SDBCR is written with TIMUNLOCK to load CL and the timing; the write that locks it again ends
/// the initialisation (UBL's order). The controller keeps programmed values, whatever the part
/// would like.
void DdrModule::reconfigure() {
  const Picoseconds now = kernel_time();
  settle(now);
  controller_.configure(programmed(), now);
  replanned_.soon();
  if (!regs.sdbcr.sdramen)
    ready_ = false;
  else if (!regs.sdbcr.timunlock)
    ready_ = true;
  if (regs.sdbcr.timunlock) timed_ = true;
  examined_ = open_ = false;
  note_initialised();
}

DdrConfig DdrModule::programmed() const { return decode(regs); }

/// True if the controller takes the request. False: it ends in a bus error.
bool DdrModule::admit(const MemRequest& m) {
  const bool outside = std::uint64_t{m.address} + m.bytes > kWindow;
  if (outside || !ready_ || !enabled_ || !controller_.running()) {
    Diagnostics::instance().guest(outside ? "access beyond the SDRAM's 256 MiB of the memory map"
                                          : "access to the SDRAM before its controller runs");
    return false;
  }
  if (!examined_) {
    examined_ = open_ = true;
    for (const std::string& line : nonsense(regs, params_)) Diagnostics::instance().guest(line);
    check_.remark(programmed(), ddr_clk.read());
  }
  if (std::uint64_t{m.address} + m.bytes > store_.size())
    Diagnostics::instance().guest("access beyond the SDRAM's end (ddr.part, " +
                                  std::to_string(store_.size() >> 20) +
                                  " MiB): it repeats from its beginning");
  return true;
}

/// The controller is stopped or not examined since it was programmed, or the address is beyond the part.
[[gnu::noinline]] Taken DdrModule::arrive_slowly(MemRequest& m, Picoseconds at) {
  if (!admit(m)) return refuse_in_order(m, at);
  FOVEA_CHECK(!controller_.shut(), "a request while another one waits at the door");
  const std::uint32_t address = m.address;
  m.address &= static_cast<std::uint32_t>(store_.size() - 1);
  const bool taken = controller_.submit_inside(m, at);
  m.address = address;
  return taken ? Taken::kYes : Taken::kWaits;
}

[[gnu::flatten]] Taken DdrModule::arrive(MemRequest& m, Picoseconds at) {
  const bool outside = std::uint64_t{m.address} + m.bytes > store_.size();
  if (!open_ || outside || controller_.shut()) [[unlikely]]
    return arrive_slowly(m, at);
  return controller_.submit_inside(m, at) ? Taken::kYes : Taken::kWaits;
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
  if (!refused_.empty()) [[unlikely]]
    refuse_after(cookie, last);
}

/// A refusal takes no time here, so it waits for the older reads of its master: a master's reads end
/// in their order.
[[gnu::noinline]] Taken DdrModule::refuse_in_order(MemRequest& m, Picoseconds at) {
  const void* older = m.write ? nullptr : controller_.newest_read(m.master);
  if (!older) return Taken::kRefused;
  refused_.push_back({&m, older, at});
  return Taken::kYes;
}

void DdrModule::refuse_after(const void* read, Picoseconds last) {
  const auto begin =
      std::stable_partition(refused_.begin(), refused_.end(),
                            [&](const Refused& r) { return r.behind != read; });
  const std::vector<Refused> now(begin, refused_.end());
  refused_.erase(begin, refused_.end());
  for (const Refused& refused : now) {
    MemRequest& r = *refused.request;
    r.first = r.last = std::max(refused.at, last);
    r.slave_waited = 0;
    MemPhase phase = MemPhase::kRefused;
    sc_core::sc_time delay = ps_time(r.first - now_());
    socket->nb_transport_bw(r, phase, delay);
  }
}

unsigned DdrModule::transport_dbg(MemRequest& r) {
  if (r.address >= kWindow) return 0;
  const auto address = static_cast<std::uint32_t>(r.address & (store_.size() - 1));
  const auto n = static_cast<unsigned>(std::min<std::uint64_t>(r.bytes, store_.size() - address));
  if (r.write)
    controller_.debug_write(address, r.data, n);
  else
    controller_.debug_read(address, r.data, n);
  return n;
}

}  // namespace fovea::mem
