// A stretch of simulated time between two looks of the host.
#pragma once
#include <systemc>

#include "model/common/timer.h"

namespace fovea {

/// Runs the kernel a slice at a time. At the end of each an event is pending, so that a core with
/// nothing else ahead of it (an idle loop, every block asleep) comes back there too.
class Slices {
 public:
  void run(Picoseconds slice) {
    end_.move_to(kernel_time() + slice);  // a pause may have cut the last slice short
    sc_core::sc_start(ps_time(slice));
  }

 private:
  Timer end_;
};

}  // namespace fovea
