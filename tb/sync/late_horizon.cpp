#include "tb/sync/late_horizon.h"

#include "model/common/timer.h"

namespace fovea {

Picoseconds kernel_horizon() {
  if (sc_core::sc_pending_activity_at_current_time()) return kernel_time() + planted_late_horizon;
  if (!sc_core::sc_pending_activity_at_future_time()) return kNever;
  return kernel_time() + sc_core::sc_time_to_pending_activity().value() + planted_late_horizon;
}

}  // namespace fovea
