#include "model/bus/agent.h"

#include <algorithm>

#include "model/common/check.h"

namespace fovea::bus {

Agent::Agent(sc_core::sc_module_name name, unsigned ports) : sc_module(name) {
  SC_HAS_PROCESS(Agent);
  for (unsigned i = 0; i < ports; ++i) {
    sockets.push_back(std::make_unique<tlm::tlm_initiator_socket<32>>(
        ("socket_" + std::to_string(i)).c_str()));
    sockets.back()->bind(*this);
  }
  SC_METHOD(background);
  sensitive << background_due_;
  dont_initialize();
}

void Agent::enter() {
  running_ = true;
  strict_ = path->strict();
  now_ = kernel_();
  path_ = path.operator->();
  background_due_.cancel();
  ++horizon_epoch;
  path->hold();
}

void Agent::leave() {
  running_ = false;
  arm_background();
  path->release();
}

void Agent::arm_background() {
  const Picoseconds t = background_next();
  if (t == kNever) return;
  const Picoseconds now = kernel_time();
  background_due_.notify(ps_time(t > now ? t - now : 0));
}

void Agent::background() {
  if (running_) return;
  while (background_next() <= kernel_time()) background_act();
  arm_background();
}

void Agent::sleep_until(Picoseconds until) {
  const Picoseconds now = now_;
  if (until <= now) return;
  if (!strict_) {
    // No process switch if all that lies before `until` is in the path and can be played here.
    for (;;) {
      const Picoseconds t = path_->next_decision();
      const Picoseconds b = background_next();
      const Picoseconds h = next_event();
      if (std::min({t, b, h}) >= until) return;
      if (std::min(t, b) >= h) break;
      if (b <= t)
        background_act();
      else
        path_->step_before(std::min({until, b, h}));
    }
  }
  leave();
  sc_core::wait(ps_time(until - now));
  enter();
}

void Agent::wait_for(sc_core::sc_event& event) {
  leave();
  sc_core::wait(event);
  enter();
}

void Agent::submit(Transaction& tx, Picoseconds at) {
  const Picoseconds now = running_ ? now_ : kernel_();
  // Ahead of the kernel only strictly before H; at `now` the order within the instant is harmless.
  if (at > now && (strict_ || at >= next_event())) sleep_until(at);
  tx.done = false;
  ++own_undecided_;
  tx.gp.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  tlm::tlm_phase phase = tlm::BEGIN_REQ;
  sc_core::sc_time delay = ps_time(at - (running_ ? now_ : now));
  (*sockets[tx.port])->nb_transport_fw(tx.gp, phase, delay);
}

bool Agent::poll(Transaction& tx, Picoseconds until) {
  if (strict_) {
    sleep_until(until);
    return tx.done && tx.ext.last <= until;
  }
  for (;;) {
    if (tx.done) return tx.ext.last <= until;
    const Picoseconds t = path_->next_decision();
    const Picoseconds h = next_event();
    if (std::min(t, h) >= until) return false;
    if (t >= h) {
      // Somebody else may still act before `until`: let the kernel get there.
      sleep_until(until);
      return tx.done && tx.ext.last <= until;
    }
    path_->step_before(std::min(until, h));
  }
}

void Agent::finish(Transaction& tx) {
  while (!tx.done) {
    if (!strict_) {
      const Picoseconds t = path_->next_decision();
      const Picoseconds b = background_next();
      const Picoseconds h = next_event();
      if (std::min(t, b) < h) {
        if (b <= t)
          background_act();
        else
          path_->step_before(std::min(b, h));
        continue;
      }
    }
    waiting_ = &tx;
    wait_for(done_);
    waiting_ = nullptr;
  }
}

tlm::tlm_sync_enum Agent::nb_transport_bw(tlm::tlm_generic_payload& gp, tlm::tlm_phase& phase,
                                          sc_core::sc_time&) {
  if (phase != tlm::BEGIN_RESP) return tlm::TLM_ACCEPTED;
  MemExtension* ext = nullptr;
  gp.get_extension(ext);
  auto& tx = *static_cast<Transaction*>(ext->owner);
  tx.done = true;
  --own_undecided_;
  completed(tx);
  if (!running_) {
    ++horizon_epoch;  // another agent plays the path: it must see what is notified here
    if (waiting_ == &tx) {
      const Picoseconds now = kernel_time();
      done_.notify(ps_time(ext->first > now ? ext->first - now : 0));
    }
    arm_background();
  }
  return tlm::TLM_COMPLETED;
}

}  // namespace fovea::bus
