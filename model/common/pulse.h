// Interrupt output that gives one pulse for each event.
#pragma once
#include <systemc>

#include "model/common/timer.h"
#include "model/common/units.h"

namespace fovea {

/// Drives `out` high for `width` after raise(), so that every event is a rising edge for the interrupt
/// controller. An event while `out` is high is lost: it neither extends the pulse nor adds an edge.
class Pulse : public sc_core::sc_module {
 public:
  sc_core::sc_out<bool> out{"out"};
  SC_HAS_PROCESS(Pulse);
  /// `width`: one period of the video's byte clock unless the source has another one.
  explicit Pulse(sc_core::sc_module_name name, Picoseconds width = kPsPerSecond / 27'000'000)
      : sc_module(name), width_(ps_time(width)) {
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
  const sc_core::sc_time width_;
  Timer raise_;
  bool high_ = false;
};

}  // namespace fovea
