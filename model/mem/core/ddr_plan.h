// Inline functions on the path of every request and of every command: planning of the common cases, a count,
// submission and the commands themselves. The memory system includes it, so that a request is one piece of host
// code from the crossbar's grant to its entry in the queue.
#pragma once
#include <algorithm>

#include "model/mem/core/ddr_controller.h"
#include "model/mem/core/move_bytes.h"

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

/// Field by field: a copy of the whole, or by way of another one, would read bytes just written as
/// wide words, for which the host has to wait.
[[gnu::always_inline]] inline void put(QueuedRequest& r, MemRequest& from, std::uint32_t offset) {
  r.origin = &from;
  r.master = from.master;
  r.priority = from.in_path.priority;
  r.write = from.write;
  r.bytes = from.bytes;
  r.address = offset;
  r.data = from.data;
  r.parts = from.parts;
}

/// What follows from the entry's request.
inline void DdrController::fill(Entry& e, std::uint64_t arrived) const {
  const Queued& r = e.request;
  __builtin_prefetch(store_.at(r.address));  // the host's own memory is slow as well
  e.ready = arrived + request_latency_;
  e.bank = bank_of(r.address);
  e.row = row_of(r.address);
  e.chunks = static_cast<std::uint8_t>(((r.address & 15u) + r.bytes + 15u) / 16u);
  e.classified = false;
  e.prepared = 0;
  if (r.write) move_bytes(e.data.data(), r.data, r.bytes);
}

[[gnu::always_inline]] inline bool DdrController::take_in(MemRequest& request, std::uint32_t offset,
                                                          Picoseconds at) {
  // Counted at the request, as the crossbar does, so that both sums agree at any instant.
  (request.write ? stats.write_bytes : stats.read_bytes) += request.bytes;
  const std::uint64_t arrived = std::max(ddr_.edge_after(at), last_arrival_);
  if (queue_.count() != 0) return queue(request, offset, arrived);
  if (idle_calm_ < arrived) [[unlikely]] {
    idle(arrived);
    wake(arrived);
  }
  last_arrival_ = queued_since_ = arrived;
  Entry& e = queue_.begin_single();
  put(e.request, request, offset);
  fill(e, arrived);
  plan_one(e);
  return true;
}

inline bool DdrController::submit_inside(MemRequest& request, std::uint32_t offset,
                                         Picoseconds at) {
  return take_in(request, offset, at);
}

inline void DdrController::take_decision() {
  count_owed(plan_.choice.at);
  if (plan_.choice.cmd == Cmd::kWr) return in_burst_ ? last_column<Cmd::kWr>() : first_column<Cmd::kWr>();
  if (plan_.choice.cmd == Cmd::kRd) return in_burst_ ? last_column<Cmd::kRd>() : first_column<Cmd::kRd>();
  prepare();
}

}  // namespace fovea::mem
