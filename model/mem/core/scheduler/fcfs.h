#pragma once
#include "model/mem/core/scheduler/policy.h"

namespace fovea::mem {

/// First come, first served: data commands in the order of age, whatever their kind or priority. The
/// oldest request of each bank may close and open rows ahead of its turn.
inline constexpr SchedulerPolicy kFcfs{.name = "fcfs", .in_order = true, .kinds_count = false};

}  // namespace fovea::mem
