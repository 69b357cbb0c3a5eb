// A stretch of simulated time between two looks of the host.
#pragma once
#include <systemc>

#include "model/common/lookahead.h"

namespace fovea {

/// Runs the kernel a slice at a time. At the end of each an event is pending, so that a core with
/// nothing else ahead of it (an idle loop, every block asleep) comes back there too.
class Slices {
 public:
  void run(Picoseconds slice) {
    end_.cancel();  // of a slice that the simulation's pause cut short
    end_.notify(ps_time(slice));
    sc_core::sc_start(ps_time(slice));
  }

 private:
  sc_core::sc_event end_;
};

}  // namespace fovea
