#pragma once
#include "model/mem/core/scheduler/policy.h"

namespace fovea::mem {

/// First ready, first come, first served, the textbook's policy: of the requests whose row is open the one
/// whose data command is legal first, then the oldest. Kinds and priorities do not count.
inline constexpr SchedulerPolicy kFrfcfs{
    .name = "frfcfs", .kinds_count = false, .free_order = true, .first_ready = true};

}  // namespace fovea::mem
