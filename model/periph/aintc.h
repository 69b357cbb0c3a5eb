// AINTC (ARM interrupt controller) as a peripheral on the configuration bus.
#pragma once
#include <systemc>

#include "model/common/bus_target.h"
#include "model/common/param.h"
#include "model/common/timer.h"
#include "model/periph/clocked_target.h"
#include "model/periph/core/aintc_core.h"

namespace fovea::periph {

struct AintcParams : ParamGroup {
  EnumParam capture{*this,
                    "capture",
                    "edge",
                    {"edge", "level"},
                    "what latches a source: its rising edge, or its level (a source still high "
                    "latches again after the acknowledge)",
                    Origin::kAssumed,
                    "the manual's text is not public; Linux serves every source as an edge",
                    {"edge", "level", "drivers work with either"}};
  AintcParams() : ParamGroup("aintc") {}
};

/// AINTC at 0x01C48000. A source that rises at time t is pending from t on, and the outputs change
/// in the same instant; the core sees them strictly after t. The rules are in core/aintc_core.h.
/// Which of two blocks drives an input is selected before the AINTC, in interrupt_mux.h.
class Aintc : public WithRegs<AintcCore>, public BusTarget {
 public:
  using Params = AintcParams;
  SC_HAS_PROCESS(Aintc);
  sc_core::sc_vector<sc_core::sc_in<bool>> source{"source", kInterruptCount};
  sc_core::sc_out<bool> irq{"irq"};  ///< true: interrupt request to the core
  sc_core::sc_out<bool> fiq{"fiq"};

  Aintc(sc_core::sc_module_name name, const AintcParams& params);
  const AintcCore& core() const { return regs; }
  /// When an input was last latched.
  Picoseconds latched_at(unsigned input) const { return latched_at_[input]; }

 private:
  void on_reset(ResetKind) override { regs.reset(); }
  void update();
  std::array<Picoseconds, kInterruptCount> latched_at_{};
  Timer written_;
};

}  // namespace fovea::periph
