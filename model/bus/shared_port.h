// Two initiators on one port of the crossbar.
#pragma once
#include <algorithm>
#include <array>
#include <systemc>
#include <utility>
#include <vector>

#include "model/common/check.h"
#include "model/common/mem_sockets.h"
#include "model/common/timer.h"

namespace fovea::bus {

/// Forwards the requests of two initiators to one port, and each response to whom it belongs.
/// Synthetic traffic uses it on the port of a block of the chip: both share the port's queue and
/// its order. Requests are passed on 1 ps after they were made, those of `first` first: if both
/// make one at the same instant, the order of the kernel's processes must not decide.
class SharedPort : public sc_core::sc_module {
 public:
  MemTargetSocket<32> first{"first"}, second{"second"};
  MemInitiatorSocket<32> port{"port"};

  explicit SharedPort(sc_core::sc_module_name name) : sc_module(name) {
    SC_HAS_PROCESS(SharedPort);
    SC_METHOD(pass_on);
    sensitive << due_.event();
    dont_initialize();
    for (auto& side : sides_) side.owner = this;
    sides_[0].socket = &first;
    sides_[1].socket = &second;
    first.bind(sides_[0]);
    second.bind(sides_[1]);
    back_.owner = this;
    port.bind(back_);
  }

 private:
  struct Side final : MemTargetIf {
    SharedPort* owner = nullptr;
    MemTargetSocket<32>* socket = nullptr;
    tlm::tlm_sync_enum nb_transport_fw(MemRequest& r, MemPhase& phase,
                                       sc_core::sc_time& delay) override {
      if (phase != MemPhase::kRequest) return owner->port->nb_transport_fw(r, phase, delay);
      owner->take(*this, r);
      return tlm::TLM_ACCEPTED;
    }
    unsigned transport_dbg(MemRequest& r) override { return owner->port->transport_dbg(r); }
  };
  struct Back final : MemInitiatorIf {
    SharedPort* owner = nullptr;
    tlm::tlm_sync_enum nb_transport_bw(MemRequest& r, MemPhase& phase,
                                       sc_core::sc_time& delay) override {
      auto& list = owner->under_way_;
      const auto found =
          std::find_if(list.begin(), list.end(), [&](const auto& u) { return u.first == &r; });
      FOVEA_CHECK(found != list.end(), "a response that belongs to no request");
      Side* const side = found->second;
      if (phase == MemPhase::kResponse) list.erase(found);
      return (*side->socket)->nb_transport_bw(r, phase, delay);
    }
  };
  struct Waiting {
    Picoseconds at;
    MemRequest* request;
    Side* side;
  };

  void take(Side& side, MemRequest& r) {
    under_way_.emplace_back(&r, &side);
    waiting_.push_back({kernel_time() + 1, &r, &side});
    due_.at(waiting_.front().at);
  }

  void pass_on() {
    const Picoseconds now = kernel_time();
    const auto end = std::find_if(waiting_.begin(), waiting_.end(),
                                  [&](const Waiting& w) { return w.at > now; });
    std::vector<Waiting> batch(waiting_.begin(), end);
    waiting_.erase(waiting_.begin(), end);
    std::stable_sort(batch.begin(), batch.end(),
                     [](const Waiting& a, const Waiting& b) { return a.side < b.side; });
    for (const Waiting& w : batch) {
      MemPhase phase = MemPhase::kRequest;
      sc_core::sc_time delay;
      port->nb_transport_fw(*w.request, phase, delay);
    }
    if (!waiting_.empty()) due_.at(waiting_.front().at);
  }

  std::array<Side, 2> sides_;
  Back back_;
  Timer due_;
  std::vector<Waiting> waiting_;
  std::vector<std::pair<const MemRequest*, Side*>> under_way_;
};

}  // namespace fovea::bus
