// The schedulers that `ddr.scheduler` can choose.
#pragma once
#include <variant>

#include "model/common/check.h"
#include "model/mem/core/ddr_params.h"
#include "model/mem/core/scheduler/closed_page.h"
#include "model/mem/core/scheduler/fcfs.h"
#include "model/mem/core/scheduler/frfcfs.h"
#include "model/mem/core/scheduler/ti.h"

namespace fovea::mem {

/// A scheduler with each of its variants is a type of its own, so that the planning is compiled for it.
template <Scheduler... S>
using OneScheduler = std::variant<S...>;
using AnyScheduler =
    OneScheduler<TiScheduler<OpenRow::kActivated>, TiScheduler<OpenRow::kReady>, FcfsScheduler,
                 FrfcfsScheduler, ClosedPageScheduler<OpenRow::kActivated>,
                 ClosedPageScheduler<OpenRow::kReady>>;

/// The scheduler that the parameters name.
inline AnyScheduler scheduler_of(const DdrParams& params) {
  const bool ready = params.ti_open_row.is("ready");
  const auto is = [&]<class S>(S) { return params.scheduler.is(S::kName); };
  if (is(FcfsScheduler())) return FcfsScheduler();
  if (is(FrfcfsScheduler())) return FrfcfsScheduler();
  if (is(ClosedPageScheduler<OpenRow::kReady>())) {
    if (ready) return ClosedPageScheduler<OpenRow::kReady>();
    return ClosedPageScheduler<OpenRow::kActivated>();
  }
  FOVEA_CHECK(is(TiScheduler<OpenRow::kReady>()), "a scheduler without its class");
  if (ready) return TiScheduler<OpenRow::kReady>();
  return TiScheduler<OpenRow::kActivated>();
}

}  // namespace fovea::mem
