// Base class of clocked peripherals, with a clock whose edges are numbered and which stops while the
// module is gated; ports that may stay unbound.
#pragma once
#include <systemc>

#include "model/common/bus_target.h"
#include "model/common/clock.h"
#include "model/common/sc_ports.h"
#include "model/common/timer.h"

namespace fovea::periph {

/// An output that may stay unbound, on boards where nothing uses it.
template <class T>
class OptionalOut
    : public sc_core::sc_port<sc_core::sc_signal_inout_if<T>, 1, sc_core::SC_ZERO_OR_MORE_BOUND> {
 public:
  using sc_core::sc_port<sc_core::sc_signal_inout_if<T>, 1,
                         sc_core::SC_ZERO_OR_MORE_BOUND>::sc_port;
  void write(const T& value) {
    if (this->size()) (*this)->write(value);
  }
};

/// An input that may stay unbound.
template <class T>
using OptionalIn = sc_core::sc_port<sc_core::sc_signal_in_if<T>, 1, sc_core::SC_ZERO_OR_MORE_BOUND>;

/// A peripheral with one functional clock. Time is counted in ticks: tick n ends at clock edge n,
/// and ticks() is the number of edges up to now since the start of the run. While the clock is
/// stopped there are no edges. An action that software starts at time t counts from the first edge
/// after t.
class ClockedTarget : public BusTarget {
 public:
  SC_HAS_PROCESS(ClockedTarget);
  ClockIn clk{"clk"};
  /// The module's clock enable from the PSC; if unbound, the module is always clocked.
  OptionalIn<bool> lpsc{"lpsc"};

 protected:
  ClockedTarget(sc_core::sc_module_name name, RegBank& bank);
  bool clocked() const override;

  bool running() const { return clock_.running(); }
  std::uint64_t ticks() const;
  /// Time at which tick n (> ticks()) ends; kNever while the clock is stopped, or if n is kNever.
  Picoseconds time_of(std::uint64_t tick) const;
  /// Warns once if PINMUX assigns the block's pins to another function, so that the chip would do
  /// nothing visible. In the model the pins stay connected.
  void check_pins(const OptionalIn<bool>& pins, const char* selection);

  /// Called after a change of the frequency or of the clock gate: pending events must be scheduled
  /// again.
  virtual void clock_changed() = 0;

 private:
  void take_clock();
  Clock clock_;
  std::uint64_t stopped_at_ = 0;
  bool pins_checked_ = false;
};

}  // namespace fovea::periph
