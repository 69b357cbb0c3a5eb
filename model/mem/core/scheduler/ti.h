#pragma once
#include "model/mem/core/scheduler/policy.h"

namespace fovea::mem {

/// The chip's own scheduler (SPRU986B, SPRUEM4A and sisters). Each master offers its oldest request, and a
/// read that may pass its writes. Reads go before writes; in each kind open rows first, then priority, then
/// age. Which of several open rows goes first is `ddr.ti_open_row` (decision 0010).
constexpr SchedulerPolicy ti(bool ready_rows_first) {
  return {.name = "ti", .first_ready = ready_rows_first};
}

}  // namespace fovea::mem
