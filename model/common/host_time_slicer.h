// Runs the simulation in slices of simulated time, with the host in control between them.
#pragma once
#include <systemc>

#include "model/common/timer.h"

namespace fovea {

/// Runs the kernel for one slice at a time. An event is pending at the end of each slice, so that a
/// core that runs ahead (in an idle loop, while every other block sleeps) stops there too.
class HostTimeSlicer {
 public:
  void run(Picoseconds slice) {
    end_.move_to(kernel_time() + slice);  // sc_pause() may have ended the last slice early
    sc_core::sc_start(ps_time(slice));
  }

 private:
  Timer end_;
};

}  // namespace fovea
