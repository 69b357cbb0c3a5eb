// ARM interrupt controller on the configuration bus.
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

/// AINTC at 0x01C48000. A source that rises at t is pending from t on; the pins change in the same
/// instant, which the core sees after t. Rules: core/aintc_core.h.
/// Which block feeds an input is decided in front of it (interrupt_mux.h).
class Aintc : public WithRegs<AintcCore>, public BusTarget {
 public:
  using Params = AintcParams;
  SC_HAS_PROCESS(Aintc);
  sc_core::sc_vector<sc_core::sc_in<bool>> source{"source", kInterruptCount};
  sc_core::sc_out<bool> irq{"irq"};  ///< true: interrupt the core
  sc_core::sc_out<bool> fiq{"fiq"};

  Aintc(sc_core::sc_module_name name, const AintcParams& params);
  const AintcCore& core() const { return regs; }

 private:
  void update();
  Timer written_;
};

}  // namespace fovea::periph
