// The schedulers that `ddr.scheduler` can choose.
#pragma once
#include "model/mem/core/ddr_params.h"
#include "model/mem/core/scheduler/closed_page.h"
#include "model/mem/core/scheduler/fcfs.h"
#include "model/mem/core/scheduler/frfcfs.h"
#include "model/mem/core/scheduler/ti.h"

namespace fovea::mem {

inline SchedulerPolicy scheduler_policy(const DdrParams& params) {
  const bool ready = params.ti_open_row.is("ready");
  for (const SchedulerPolicy& p : {ti(ready), closed_page(ready), kFcfs, kFrfcfs})
    if (params.scheduler.is(p.name)) return p;
  return ti(ready);
}

}  // namespace fovea::mem
