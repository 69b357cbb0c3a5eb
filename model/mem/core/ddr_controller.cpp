// Requests and commands: what the controller takes in, and what it issues for them.
#include "model/mem/core/ddr_controller.h"

#include <bit>
#include <utility>

#include "model/common/check.h"
#include "model/mem/core/ddr_plan.h"

namespace fovea::mem {

void DdrController::catch_up(Picoseconds at) {
  if (!running_) return;
  const std::uint64_t until = ddr_.edge_after(at);
  if (in_burst_)
    columns_before(until);
  else if (queue_.count() == 0)
    idle(until);
  if (queue_.count()) count_queued(until);
  power_.count(until, device_.all_closed());
  stats.row_open_clocks += device_.take_open_clocks(until);
}

bool DdrController::submit(MemRequest& r, std::uint32_t offset, Picoseconds at) {
  FOVEA_CHECK(running_, "request to a DDR controller without a clock");
  FOVEA_CHECK(!input_blocked_, "request to a DDR controller whose input register is taken");
  FOVEA_CHECK(r.bytes <= 64 && std::uint64_t{offset} + r.bytes <= size_,
              "request outside the SDRAM reached the controller");
  return take_in(r, offset, at);
}

bool DdrController::queue(MemRequest& request, std::uint32_t offset, std::uint64_t arrived) {
  const bool was_single = queue_.single();
  if (was_single) join_single();
  if (!fits(request.write, offset, request.bytes)) {
    input_taken_ = input_blocked_ = true;
    put(input_, request, offset);
    input_arrived_ = arrived;
    return false;
  }
  Entry& e = queue_.free_entry();
  put(e.request, request, offset);
  take(e, arrived);
  // A command chosen for a clock before the newcomer is ready stands; no other can come before then.
  if (in_burst_ || e.ready > plan_.choice.at) return true;
  const std::uint64_t edge = std::max(command_free_, e.ready);
  if (was_single)
    plan_from(edge);
  else
    plan_with_newest(edge);
  return true;
}

/// The single request becomes the first of the queue.
void DdrController::join_single() {
  const Entry& e = queue_.entry(0);
  queue_.join_single(device_.row(e.bank) == e.row);
  attribution_.begin_queue(e.ready);
}

/// The request in this entry joins the queue as the newest one.
void DdrController::take(Entry& e, std::uint64_t arrived) {
  last_arrival_ = arrived;
  fill(e, arrived);
  attribution_.joined(queue_.count(), e.ready);
  const Positions older = queue_.order().of_master(e.request.master);
  const unsigned position = queue_.add(e, device_.row(e.bank) == e.row);
  if (with_scheduler([&]<Scheduler S>(S) { return S::competes(queue_, e, older); }))
    queue_.compete(1u << position);
}

template <Cmd kCmd>
inline void DdrController::note(std::uint64_t clock, Picoseconds at, unsigned burst) {
  constexpr bool kColumn = kCmd == Cmd::kRd || kCmd == Cmd::kWr;
  Entry* const entry = plan_.choice.entry;
  IssuedCommand& g = attribution_.add(clock, at, kColumn ? entry : nullptr);
  g.cmd = kCmd;
  g.burst = static_cast<std::uint8_t>(burst);
  if constexpr (kCmd == Cmd::kRef || kCmd == Cmd::kPreAll)
    g.cause = WaitAttribution::kRefreshed;
  else
    g.cause = static_cast<std::uint8_t>(index(entry->request.master));
  if constexpr (kCmd == Cmd::kAct || kCmd == Cmd::kPre)
    g.before = std::exchange(entry->prepared, attribution_.count());
}

/// Whatever is no column command.
template <Cmd kCmd>
inline void DdrController::issue(unsigned bank, std::uint32_t row, std::uint64_t clock,
                                 Picoseconds at) {
  device_.issue<kCmd>(bank, row, clock);
  if constexpr (kCmd == Cmd::kAct) queue_.row_opened(bank, row);
  if constexpr (kCmd == Cmd::kPre) queue_.row_closed(bank);
  if constexpr (kCmd == Cmd::kPreAll) queue_.all_rows_closed();
  command_free_ = clock + 1;
  note<kCmd>(clock, at);
  call_hook(kCmd, bank, row, clock);
}
// For ddr_idle.cpp.
template void DdrController::issue<Cmd::kPreAll>(unsigned, std::uint32_t, std::uint64_t, Picoseconds);
template void DdrController::issue<Cmd::kRef>(unsigned, std::uint32_t, std::uint64_t, Picoseconds);

void DdrController::step() { take_decision(); }

/// Whatever is no column command.
[[gnu::noinline]] void DdrController::prepare() {
  const auto [e, clock, cmd, position, bank] = plan_.choice;
  switch (cmd) {
    case Cmd::kAct:
      if (!e->classified) {
        ++stats.row_misses;
        ++stats.bank[e->bank].row_misses;
      }
      e->classified = true;
      ++stats.activates;
      issue<Cmd::kAct>(e->bank, e->row, clock, next_);
      break;
    case Cmd::kPre:
      if (!e) {
        close_overdue_row(clock);
        break;
      }
      if (!e->classified) {
        ++stats.row_conflicts;
        ++stats.bank[e->bank].row_conflicts;
      }
      e->classified = true;
      issue<Cmd::kPre>(e->bank, e->row, clock, next_);
      break;
    case Cmd::kPreAll:
      begin_refresh();
      issue<Cmd::kPreAll>(0, 0, clock, next_);
      break;
    default:
      begin_refresh();
      issue_refresh(clock, next_);
      break;
  }
  plan();
}

/// Closes a row that has been open for too long. A wait for this PRE is charged to the upkeep of the SDRAM
/// device, as a wait for refresh is.
void DdrController::close_overdue_row(std::uint64_t clock) {
  const unsigned bank = plan_.choice.bank;
  device_.issue<Cmd::kPre>(bank, 0, clock);
  queue_.row_closed(bank);
  ++stats.overdue_rows;
  command_free_ = clock + 1;
  IssuedCommand& g = attribution_.add(clock, next_);
  g.cause = WaitAttribution::kRefreshed;
  g.before = 0;
  g.cmd = Cmd::kPreAll;
  call_hook(Cmd::kPre, bank, 0, clock);
  update_deadlines();
}

/// The first BL8 column command of a request. All its data moves now, since nothing can come
/// between its bursts; for the same reason the next decision is its last column.
template <Cmd kCmd>
void DdrController::first_column() {
  const Entry& e = *plan_.choice.entry;
  const Queued& r = e.request;
  const std::uint64_t clock = plan_.choice.at;
  if (!e.classified) {
    ++stats.row_hits;
    ++stats.bank[e.bank].row_hits;
  }
  const WaitAttribution::Column column{e.ready, clock, e.prepared, attribution_.count()};
  if constexpr (kCmd == Cmd::kRd) {
    attribution_.waited = 0;
    if (clock > e.ready) attribution_.attribute(e, clock, next_, !queue_.single());
  }
  const unsigned burst = (e.chunks - 1u) * DdrTiming::kBurstClocks;
  note<kCmd>(clock, next_, burst);
  ++stats.bursts;
  if constexpr (kCmd == Cmd::kWr) {
    move_bytes(store_.at(r.address), e.data.data(), r.bytes);
  } else {
    move_bytes(r.data, store_.at(r.address), r.bytes);
    if (returns_.reorders()) [[unlikely]] {
      send_in_order(e, column);
    } else {
      const ReturnChannel::Span data = returns_.send(e, clock);
      news_.reads.add({r.origin, data.first, data.last, attribution_.waited, column});
      news_.any = true;
    }
  }
  if (burst == 0) {
    issue_last_column<kCmd>(e, clock);
    return finish(clock);
  }
  call_hook(kCmd, e.bank, e.row, clock);
  command_free_ = clock + 1;
  newest_column_ = clock;
  in_burst_ = true;
  columns_left_ = e.chunks - 1u;
  next_column_ = clock + DdrTiming::kBurstClocks;
  plan_.choice.at = clock + burst;
  next_ = ddr_.edge(plan_.choice.at);
}

/// The data of this read may come before those of older reads of its master.
[[gnu::noinline]] void DdrController::send_in_order(const Entry& e, const WaitAttribution::Column& column) {
  const QueuePositions& order = queue_.order();
  Positions older = order.of_master(e.request.master) & ~order.writes() &
                    ((1u << plan_.choice.position) - 1);
  std::uint32_t slots = 0;
  for (; older; older &= older - 1) slots |= 1u << order.slot(oldest(older));
  returns_.send_in_order(e, 1u << queue_.slot_of(e), slots, column, news_.reads);
  news_.any |= news_.reads.size() != 0;
}

/// The last column command, and those inside the burst that catch_up() has not issued yet. Every
/// constraint that they would set, the last one sets later.
template <Cmd kCmd>
void DdrController::last_column() {
  const Entry& e = *plan_.choice.entry;
  const std::uint64_t clock = plan_.choice.at;
  stats.bursts += columns_left_;
  if (!hooks_.empty()) [[unlikely]] {
    for (; columns_left_ > 1; --columns_left_, next_column_ += DdrTiming::kBurstClocks)
      call_hooks(kCmd, e.bank, e.row, next_column_);
  }
  issue_last_column<kCmd>(e, clock);
  in_burst_ = false;
  finish(clock);
}

// For take_decision().
template void DdrController::first_column<Cmd::kRd>();
template void DdrController::first_column<Cmd::kWr>();
template void DdrController::last_column<Cmd::kRd>();
template void DdrController::last_column<Cmd::kWr>();

template <Cmd kCmd>
[[gnu::always_inline]] inline void DdrController::issue_last_column(const Entry& e,
                                                                    std::uint64_t clock) {
  device_.issue<kCmd>(e.bank, e.row, clock);
  command_free_ = clock + 1;
  if (rows_.closes_after_access()) [[unlikely]]
    if (rows_.closes_row_of(e, queue_)) {
      device_.close_when_legal(e.bank);
      queue_.row_closed(e.bank);
      return call_hook(kCmd == Cmd::kRd ? Cmd::kRda : Cmd::kWra, e.bank, e.row, clock);
    }
  call_hook(kCmd, e.bank, e.row, clock);
}

/// Issues the columns inside the burst under way that come before `until`.
[[gnu::noinline]] void DdrController::columns_before(std::uint64_t until) {
  const Entry& e = *plan_.choice.entry;
  for (; columns_left_ > 1 && next_column_ < until; --columns_left_) {
    count_owed(next_column_);
    newest_column_ = next_column_;
    command_free_ = next_column_ + 1;
    call_hook(plan_.choice.cmd, e.bank, e.row, next_column_);
    ++stats.bursts;
    next_column_ += DdrTiming::kBurstClocks;
  }
}

/// The timing changes within a burst: the constraints of the columns up to now are those of the timing
/// that was in force.
void DdrController::columns_take_effect() {
  if (!in_burst_ || newest_column_ == kNoClock) return;
  const Entry& e = *plan_.choice.entry;
  if (e.request.write)
    device_.issue<Cmd::kWr>(e.bank, e.row, newest_column_);
  else
    device_.issue<Cmd::kRd>(e.bank, e.row, newest_column_);
  newest_column_ = kNoClock;
}

/// The last column command is issued: the entry is free, and the request in the input register may
/// enter.
[[gnu::always_inline]] inline void DdrController::finish(std::uint64_t clock) {
  if (!queue_.single()) return finish_queued(clock);
  queue_.end_single();
  served_while_oldest_ = 0;
  count_queued(clock + 1);
  next_ = kNever;
}

[[gnu::noinline]] void DdrController::finish_queued(std::uint64_t clock) {
  leave_queue();
  if (input_taken_) accept_waiting(clock);
  if (queue_.count() == 0)
    count_queued(clock + 1);
  else if (queue_.entry(0).ready > clock + 1 + request_latency_) [[unlikely]]
    idle_until_arrival(clock);
  plan();
}

inline void DdrController::leave_queue() {
  const Entry& e = *plan_.choice.entry;
  const unsigned position = plan_.choice.position;
  queue_.leave(position);
  attribution_.left(position);
  served_while_oldest_ = position == 0 ? 0 : served_while_oldest_ + e.chunks;
  if (const Positions others = queue_.order().of_master(e.request.master))
    queue_.compete(with_scheduler([&]<Scheduler S>(S) { return S::competing(queue_, others); }));
}

void DdrController::accept_waiting(std::uint64_t clock) {
  if (!fits(input_.write, input_.address, input_.bytes)) return;
  input_taken_ = input_blocked_ = false;
  // The free entry may be the one that the departing request has left.
  const Master unblocked_by = plan_.choice.entry->request.master;
  Entry& e = queue_.free_entry();
  e.request = input_;
  take(e, std::max(input_arrived_, clock + 1));
  news_.accepted = {input_.origin, ddr_.edge(clock), unblocked_by};
  news_.any = true;
}

}  // namespace fovea::mem
