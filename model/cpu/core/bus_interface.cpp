#include "model/cpu/core/bus_interface.h"

namespace fovea::cpu {

std::uint64_t BusInterface::let_others_act(std::uint64_t cycle) {
  for (;;) {
    await_clock();
    if (cycle < clock_floor) cycle = ahb(clock_floor);
    const Picoseconds t = time(cycle);
    if (port.horizon() >= t) return cycle;
    port.sleep_until(t);
    if (cycle >= clock_floor && clock.running() && time(cycle) == t) return cycle;
  }
}

}  // namespace fovea::cpu
