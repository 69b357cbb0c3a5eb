// The bus interface: edges of the core's and the AHB's clock, submission of accesses, and how far
// the core may run before the other agents have to act.
#pragma once
#include <cstdint>

#include "model/common/clock.h"
#include "model/cpu/core/bus_port.h"

namespace fovea::cpu {

class BusInterface {
 public:
  BusInterface(BusPort& bus_port, unsigned ahb_ratio)
      : port(bus_port),
        ratio_(ahb_ratio),
        ahb_mask_(ahb_ratio & (ahb_ratio - 1) ? 0 : ~std::uint64_t{ahb_ratio - 1}) {}

  Picoseconds time(std::uint64_t cycle) const { return clock.edge(cycle); }
  /// The first core clock from `cycle` on that is at an edge of the AHB clock.
  std::uint64_t ahb(std::uint64_t cycle) const {
    const std::uint64_t n = cycle + ratio_ - 1;
    return ahb_mask_ ? n & ahb_mask_ : n / ratio_ * ratio_;
  }
  /// Submits an access on its port.
  void submit(BusAccess& a, std::uint64_t cycle) {
    a.done = false;  // the buffers may inspect it while others act
    if ((cycle >= stop_cycle || attention) && !buffers_act) [[unlikely]]
      cycle = let_others_act(cycle);
    a.parts.clear();
    a.issued = time(cycle);
    port.submit(a, a.issued);
    if (a.outside) attention = true;  // its outcome may bring the horizon nearer
  }
  /// The first core clock after a time (kNever: none).
  std::uint64_t first_clock_after(Picoseconds t) const {
    return t == kNever ? ~std::uint64_t{0} : clock.edge_after(t);
  }
  std::uint64_t first_clock_after_horizon() { return first_clock_after(port.horizon()); }
  /// Lets all other agents do what they do before this clock. They may change the core's frequency
  /// or stop its clock.
  /// @return the clock, or the first one after a change
  std::uint64_t let_others_act(std::uint64_t cycle);
  /// Waits while the core's clock is stopped.
  void await_clock() {
    while (!clock.running()) port.sleep_until(kNever);
  }

  BusPort& port;
  Clock clock;
  std::uint64_t clock_floor = 0;  // first edge after the last change of the clock
  std::uint64_t stop_cycle = 0;   // first clock at which Core::step_attention() has to be called
  bool attention = true;          // step_attention() has to be called at the next boundary
  bool buffers_act = false;       // the port is executing the buffers' work, at its own time

 private:
  unsigned ratio_;
  std::uint64_t ahb_mask_;  // selects the core clocks at AHB edges; 0: the ratio is not a power of
                            // two
};

}  // namespace fovea::cpu
