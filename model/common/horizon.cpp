// Alone in its file, so that a test can link its own kernel_horizon() and show that a horizon which is
// late by one picosecond is noticed.
#include "model/common/timer.h"

namespace fovea {

Picoseconds kernel_horizon() {
  if (sc_core::sc_pending_activity_at_current_time()) return kernel_time();
  if (!sc_core::sc_pending_activity_at_future_time()) return kNever;
  return kernel_time() + sc_core::sc_time_to_pending_activity().value();
}

}  // namespace fovea
