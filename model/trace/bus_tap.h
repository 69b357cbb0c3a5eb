// Where a bus trace listens on the chip beside the crossbar: core clock and interrupt lines.
#pragma once
#include <systemc>

#include "model/common/observers.h"
#include "model/common/sc_ports.h"
#include "model/common/timer.h"
#include "model/trace/core/recorder.h"

namespace fovea::trace {

class BusTap : public sc_core::sc_module {
 public:
  ClockIn core_clk{"core_clk"}, scr_clk{"scr_clk"}, ddr_clk{"ddr_clk"};
  sc_core::sc_in<bool> irq{"irq"}, fiq{"fiq"};

  explicit BusTap(sc_core::sc_module_name name) : sc_module(name) {
    SC_HAS_PROCESS(BusTap);
    SC_METHOD(clocks_changed);
    sensitive << core_clk << scr_clk << ddr_clk;
    SC_METHOD(interrupt_changed);
    sensitive << irq << fiq;
  }

  /// The recorder gets interrupts as long as the subscription lives.
  Subscription attach(BusRecorder& recorder) { return recorders_.add(&recorder); }
  const ClockInfo& core() const { return core_; }
  const ClockInfo& scr() const { return scr_; }
  const ClockInfo& ddr() const { return ddr_; }

 private:
  void clocks_changed() {
    follow(core_clk, core_);
    follow(scr_clk, scr_);
    follow(ddr_clk, ddr_);
  }
  static void follow(const ClockIn& clk, ClockInfo& c) {
    if (!(clk.read() == c.frequency)) c = {clk.read(), kernel_time()};
  }
  void interrupt_changed() {
    if (irq.read() || fiq.read())
      recorders_.each([](BusRecorder* r) { r->interrupt(kernel_time()); });
  }

  Observers<BusRecorder*> recorders_;
  ClockInfo core_, scr_, ddr_;
};

}  // namespace fovea::trace
