// EDMA3 channel controller: only the registers that set the priorities of the transfer controllers.
#pragma once
#include <array>
#include <cstdint>
#include <systemc>

#include "model/common/bus_target.h"
#include "model/common/masters.h"
#include "model/common/param.h"
#include "model/common/timer.h"

namespace fovea::dma {

struct EdmaParams : ParamGroup {
  IntParam reset_priority{*this,
                          "reset_priority",
                          IntParam::Unit::kCount,
                          7,
                          0,
                          7,
                          "QUEPRI out of reset, for each queue; 0 highest",
                          Origin::kAssumed,
                          "no public figure; Linux writes 7, 7, 7, 0",
                          {"0", "7", "0 on some sister chips; firmware that cares writes QUEPRI"}};
  EdmaParams() : ParamGroup("edma") {}
};

/// Offsets: Linux dma.c. Each register has a 3-bit field for each queue, at a pitch of 4 bits.
struct EdmaRegs : RegBank {
  struct PerQueue : Reg {
    using Reg::Reg;
    Field q0{*this, "Q0", 0, 3, Mode::kRw, "of queue 0"};
    Field q1{*this, "Q1", 4, 3, Mode::kRw, "of queue 1"};
    Field q2{*this, "Q2", 8, 3, Mode::kRw, "of queue 2"};
    Field q3{*this, "Q3", 12, 3, Mode::kRw, "of queue 3"};
  };
  PerQueue quetcmap{*this, "QUETCMAP", 0x280, "number of the queue's transfer controller", 0x3210};
  PerQueue quepri;
  explicit EdmaRegs(unsigned reset_priority)
      : RegBank("EDMACC"),
        quepri(*this, "QUEPRI", 0x284, "priority on the crossbar, 0 highest",
               0x1111u * reset_priority) {}
};

/// EDMA3CC at 0x01C00000. A transfer controller has the priority of the queue that is mapped to it;
/// if several are, the most urgent of them; if none is, the lowest priority.
class EdmaCc : public WithRegs<EdmaRegs>, public BusTarget {
 public:
  using Params = EdmaParams;
  SC_HAS_PROCESS(EdmaCc);
  static constexpr unsigned kQueues = 4;
  sc_core::sc_in<bool> lpsc{"lpsc"};
  /// Priority of each transfer controller, for its read and its write port.
  sc_core::sc_vector<sc_core::sc_out<std::uint32_t>> priority{"priority", kTransferControllers};

  EdmaCc(sc_core::sc_module_name name, const EdmaParams& params);

 protected:
  bool clocked() const override { return lpsc.read(); }
  /// A hole must not read 0: for CCCFG, that would mean a controller with two channels.
  bool holes_answer() const override { return false; }

 private:
  void on_reset(ResetKind) override { written_.soon(); }
  void update();
  Timer written_;
};

}  // namespace fovea::dma
