// Two initiators on one port of the crossbar.
#pragma once
#include <algorithm>
#include <array>
#include <systemc>
#include <utility>
#include <vector>

#include "model/common/check.h"
#include "model/common/mem_sockets.h"

namespace fovea::bus {

/// Forwards the requests of two initiators to one port, in the order of their calls, and each response
/// to whom it belongs. Synthetic traffic uses it on the port of a block of the chip: both share the
/// port's queue and its order.
class SharedPort : public sc_core::sc_module {
 public:
  MemTargetSocket<32> first{"first"}, second{"second"};
  MemInitiatorSocket<32> port{"port"};

  explicit SharedPort(sc_core::sc_module_name name) : sc_module(name) {
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
      if (phase == MemPhase::kRequest) owner->under_way_.emplace_back(&r, this);
      return owner->port->nb_transport_fw(r, phase, delay);
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
  std::array<Side, 2> sides_;
  Back back_;
  std::vector<std::pair<const MemRequest*, Side*>> under_way_;
};

}  // namespace fovea::bus
