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

void TcmDma::at(Picoseconds t) {
  const Picoseconds when = std::max(t, kernel_time());
  const InstantRank rank = instant_rank(queue_.front().request->master);
  end_of_instant_.at(when, rank, [this, plan = ++plan_] {
    if (plan == plan_) act();
  });
}

void TcmDma::act() {
  if (clk.read().stopped()) return;  // clock_changed() continues
  MemRequest& r = *queue_.front().request;
  if (!begun_) {
    begun_ = true;
    core_.tcm_burst_begins({r.address, r.bytes, r.master}, kernel_time());
  }
  const Picoseconds over = core_.tcm_burst_over();
  if (over > kernel_time()) return at(over);  // the core has postponed the end since
  finish(r);
}

void TcmDma::finish(MemRequest& r) {
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
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  socket->nb_transport_bw(r, phase, delay);
  if (!queue_.empty()) at(queue_.front().arrival);
}

/// The core has applied the new clock by the time EndOfInstant calls act().
void TcmDma::clock_changed() {
  if (!queue_.empty() && !clk.read().stopped()) at(std::max(queue_.front().arrival, kernel_time()));
}

}  // namespace fovea::cpu
