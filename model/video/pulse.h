// Interrupt output that gives one pulse for each event.
#pragma once
#include <systemc>

#include "model/common/timer.h"
#include "model/common/units.h"

namespace fovea::video {

/// Drives `out` high for one period of the byte clock (37.037 ns) after raise(), so that every
/// event is a rising edge for the interrupt controller. An event while `out` is high is lost: it
/// neither extends the pulse nor adds an edge.
class Pulse : public sc_core::sc_module {
 public:
  sc_core::sc_out<bool> out{"out"};
  SC_HAS_PROCESS(Pulse);
  explicit Pulse(sc_core::sc_module_name name) : sc_module(name) {
    SC_METHOD(drive);
    sensitive << raise_.event();
    dont_initialize();
  }
  void raise() { raise_.soon(); }

 private:
  void drive() {
    high_ = !high_;
    out.write(high_);
    if (high_) next_trigger(width_);
  }
  const sc_core::sc_time width_ = sc_core::sc_time::from_value(kPsPerSecond / 27'000'000);
  Timer raise_;
  bool high_ = false;
};

}  // namespace fovea::video
