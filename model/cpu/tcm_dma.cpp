#include "model/cpu/tcm_dma.h"

#include <algorithm>

#include "model/common/check.h"

namespace fovea::cpu {

TcmDma::TcmDma(sc_core::sc_module_name name, Core& core, EndOfInstant& end_of_instant)
    : sc_module(name), core_(core), end_of_instant_(end_of_instant) {
  socket.bind(*this);
  add_statistics(stats);
  SC_HAS_PROCESS(TcmDma);
  SC_METHOD(clock_changed);
  sensitive << clk;
  dont_initialize();
}

/// The request's address is an offset in the RAM.
tlm::tlm_sync_enum TcmDma::nb_transport_fw(MemRequest& r, MemPhase& phase,
                                           sc_core::sc_time& delay) {
  if (phase != MemPhase::kRequest) return tlm::TLM_ACCEPTED;
  queue_.push_back({&r, kernel_time() + delay.value()});
  if (queue_.size() == 1) at(queue_.front().arrival);
  return tlm::TLM_UPDATED;
}

/// Plans the next act.
void TcmDma::at(Picoseconds t) {
  ++plan_;
  const bool ahead = t > kernel_time();
  path->memory().passive_acts_at(ahead ? t : kNever);
  if (!ahead) act_at_present();
}

void TcmDma::act_at_present() {
  const Picoseconds now = kernel_time();
  end_of_instant_.at(now, instant_rank(queue_.front().request->master), [this, now, plan = ++plan_] {
    if (plan == plan_) act(now);
  });
}

/// @param now the time of the act, which may lie ahead of the kernel's
void TcmDma::act(Picoseconds now) {
  if (clk.read().stopped()) return;  // clock_changed() continues
  MemRequest& r = *queue_.front().request;
  if (!begun_) {
    begun_ = true;
    core_.tcm_burst_begins({r.address, r.bytes, r.master}, now);
  }
  const Picoseconds over = core_.tcm_burst_over();
  if (over > now) return at(over);  // the core has postponed the end since
  finish(r, now);
}

void TcmDma::finish(MemRequest& r, Picoseconds now) {
  core_.tcm_burst_ends(r.write, r.data);
  begun_ = false;
  queue_.pop_front();
  ++(r.write ? stats.writes : stats.reads);
  (r.write ? stats.write_bytes : stats.read_bytes) += r.bytes;
  const auto fetch = core_.tcm_port().waited(TcmPort::Side::kFetch);
  const auto data = core_.tcm_port().waited(TcmPort::Side::kData);
  stats.wait_fetch += fetch - std::exchange(waited_fetch_, fetch);
  stats.wait_data += data - std::exchange(waited_data_, data);
  r.error = false;
  MemPhase phase = MemPhase::kResponse;
  sc_core::sc_time delay = ps_time(now - kernel_time());
  socket->nb_transport_bw(r, phase, delay);
  if (!queue_.empty()) at(std::max(queue_.front().arrival, now));
}

/// The core has applied the new clock by the time EndOfInstant calls act().
void TcmDma::clock_changed() {
  if (!queue_.empty() && !clk.read().stopped()) at(queue_.front().arrival);
}

}  // namespace fovea::cpu
