// Planning: which command is issued next, and when. The scheduler ranks the requests; refresh and rows
// that are due come before it.
#include "model/mem/core/ddr_plan.h"

namespace fovea::mem {

/// The same as plan() after a change from outside: a burst may be under way or the clock stopped.
void DdrController::plan_anew() {
  next_ = kNever;
  if (queue_.count() == 0 || !running_) return;
  if (queue_.single()) join_single();
  if (!in_burst_) return plan_many();
  if (next_column_ < command_free_) {  // it is finished before anything else
    plan_.choice.at += command_free_ - next_column_;
    next_column_ = command_free_;
  }
  next_ = ddr_.edge(plan_.choice.at);
}

/// Plans from the requests that have come through the pipeline by `edge`, one at least.
[[gnu::noinline]] void DdrController::plan_from(std::uint64_t edge) {
  with_scheduler([&]<Scheduler S>(S) { plan_by<S>(edge); });
}

/// Plans with the newest request, which comes through the pipeline at `edge` and was not known before.
[[gnu::noinline]] void DdrController::plan_with_newest(std::uint64_t edge) {
  with_scheduler([&]<Scheduler S>(S) {
    if (stands<S>(scheduler_input(), queue_.count() - 1, edge))
      next_ = ddr_.edge(plan_.choice.at);
    else
      plan_by<S>(edge);
  });
}

/// A decision is taken at the first edge at which something is ready. If its command is legal only
/// later, whatever becomes ready before that is considered too, as is a row that is due to be closed.
template <Scheduler S>
inline void DdrController::plan_by(std::uint64_t edge) {
  const SchedulerInput in = scheduler_input();
  const unsigned count = queue_.count();
  unsigned seen = count;  // by the scheduler: they come in the order of age
  while (queue_.entry(seen - 1).ready > edge) --seen;
  for (;;) {
    choose<S>(in, edge, (1u << seen) - 1);
    std::uint64_t wake = kNoClock;
    for (; seen < count; ++seen) {
      wake = queue_.entry(seen).ready;
      if (plan_.choice.at < wake || !stands<S>(in, seen, wake)) break;
      wake = kNoClock;
    }
    if (in.room > edge) wake = std::min(wake, in.room);
    if (plan_.choice.at >= all_in_time_until_) [[unlikely]]
      if (const std::uint64_t due = rows_.first_overdue(device_); due > edge)
        wake = std::min(wake, due);
    if (plan_.choice.at < wake) break;
    edge = wake;
    while (seen < count && queue_.entry(seen).ready <= edge) ++seen;
  }
  next_ = ddr_.edge(plan_.choice.at);
}

/// The command to issue if only the oldest requests `seen` are there.
template <Scheduler S>
[[gnu::always_inline]] inline void DdrController::choose(const SchedulerInput& in,
                                                         std::uint64_t edge, Positions seen) {
  plan_.by_rank = false;
  if (edge >= calm_until_) [[unlikely]] {
    const Urgency refresh = refresh_.urgency(edge);
    if (refresh == Urgency::kMust ||
        (refresh == Urgency::kNeed && refresh_goes_first(S::considered(queue_, seen))))
      return choose_refresh(edge);
    if (edge >= all_in_time_until_ && choose_overdue_row(edge)) return;
  }
  S::choose(in, edge, seen, plan_);
}

/// True if the plan, made for the requests older than this one, need not be made again when it comes
/// through the pipeline at `edge`.
template <Scheduler S>
[[gnu::always_inline]] inline bool DdrController::stands(const SchedulerInput& in,
                                                         unsigned position, std::uint64_t edge) {
  if (!plan_.by_rank || in.room > edge || edge >= all_in_time_until_) return false;
  return S::stands(in, position, edge, (1u << position) - 1, plan_);
}

/// Rule 4 of SPRU986B: a needed refresh goes before writes and before a read that has a more urgent
/// write. Each is the first of its kind among the positions `set`.
bool DdrController::refresh_goes_first(Positions set) const {
  const QueuePositions& order = queue_.order();
  const Positions writes = set & order.writes(), reads = set ^ writes;
  if (!reads || !writes) return !reads;
  const auto priority = [&](Positions kind) {
    const Positions open = kind & queue_.hits();
    return order.urgency(open ? open : kind);
  };
  return priority(writes) < priority(reads);
}

void DdrController::choose_refresh(std::uint64_t edge) {
  if (device_.all_closed())
    plan_.choice = {nullptr, std::max(edge, device_.earliest_refresh()), Cmd::kRef};
  else
    plan_.choice = {nullptr, std::max(edge, device_.earliest_pre_all()), Cmd::kPreAll};
}

/// The REF that follows a PREA does not wait until the requests behind it have come through the pipeline.
void DdrController::plan_refresh() {
  plan_.by_rank = false;
  choose_refresh(command_free_);
  next_ = ddr_.edge(plan_.choice.at);
}

/// The row that is due first goes before all requests; refresh, which closes all rows, before it.
bool DdrController::choose_overdue_row(std::uint64_t edge) {
  if (rows_.first_overdue(device_) > edge) return false;
  const unsigned bank = RowPolicy::longest_open(device_);
  plan_.choice = {nullptr, std::max(edge, device_.earliest(Cmd::kPre, bank)), Cmd::kPre, 0,
                  static_cast<std::uint8_t>(bank)};
  return true;
}

/// After every change of refresh, rows that were due, or registers. T_RASMAX counts refresh intervals, so
/// a row that opens now is due after the present interval's end: looking at the open rows when an interval
/// ends is early enough.
void DdrController::update_deadlines() {
  all_in_time_until_ = std::min(refresh_.next_expiry(), rows_.first_overdue(device_));
  calm_until_ = refresh_.urgent() ? 0 : all_in_time_until_;
  idle_calm_ =
      refresh_.owed() || config_.low_power != LowPower::kOff ? 0 : refresh_.next_expiry();
}

}  // namespace fovea::mem
