// What several files of the controller need in line: planning of the common cases, and a count.
#pragma once
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {

/// Chooses the next command and its clock from the present state alone, so it does not matter when
/// or how often it is called.
inline void DdrController::plan() {
  if (queue_.count() == 0)
    next_ = kNever;
  else if (queue_.count() > 1)
    return plan_many();
  else
    plan_one(queue_.entry(0));
  plan_.by_rank = false;
}

inline void DdrController::plan_many() {
  if (refresh_.cycle_begun()) [[unlikely]]
    return plan_refresh();
  plan_from(std::max(command_free_, queue_.entry(0).ready));
}

/// The usual case: one request, nothing to choose from, and no refresh that is urgent.
inline void DdrController::plan_one(Entry& e) {
  const SchedulerInput in = scheduler_input();
  const Cmd cmd = in.needed(e);
  const std::uint64_t at = in.earliest(e, cmd, std::max(command_free_, e.ready));
  if (at >= calm_until_) [[unlikely]] {
    if (queue_.single()) join_single();
    return plan_many();
  }
  plan_.choice = {&e, at, cmd};
  next_ = ddr_.edge(at);
}

/// Clocks since the queue filled, or since these were counted last.
inline void DdrController::count_queued(std::uint64_t until) {
  if (until <= queued_since_) return;
  stats.queued_clocks += until - queued_since_;
  queued_since_ = until;
}

}  // namespace fovea::mem
