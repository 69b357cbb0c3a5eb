#pragma once
#include "model/mem/core/scheduler/policy.h"

namespace fovea::mem {

/// `ti`, but a row is closed with its last column command, unless a queued request wants it: for traffic
/// that seldom comes back to a row.
constexpr SchedulerPolicy closed_page(bool ready_rows_first) {
  return {.name = "closed_page", .first_ready = ready_rows_first, .closes_rows = true};
}

}  // namespace fovea::mem
