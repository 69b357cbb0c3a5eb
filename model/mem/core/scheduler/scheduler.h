// The interface of a scheduler: which SDRAM command comes next, and when.
#pragma once
#include <algorithm>
#include <concepts>
#include <cstdint>

#include "model/mem/core/command_queue.h"
#include "model/mem/core/ddr_timing.h"

namespace fovea::mem {

/// A command and its clock. PREA and REF, and the PRE of a row that has been open for too long, belong to
/// no request.
struct Choice {
  QueueEntry* entry = nullptr;
  std::uint64_t at = 0;
  Cmd cmd = Cmd::kAct;
  std::uint8_t position = 0;  ///< of the entry
  std::uint8_t bank = 0;      ///< of a PRE without an entry
};

/// The command to be issued next, as things stand.
struct Plan {
  Choice choice;
  unsigned first = 0;  ///< position of the request that ranked first when this was chosen
  /// It was chosen by rank and with room for read data: only then may Scheduler::stands() be asked.
  bool by_rank = false;
};

/// What a scheduler decides by.
struct SchedulerInput {
  CommandQueue& queue;
  const DdrDevice& device;
  std::uint64_t room = 0;      ///< first clock at which a RD finds room for its data
  bool oldest_raised = false;  ///< the oldest request was passed by too often (PBBPR.PR_OLD_COUNT)
  bool refresh_waits = false;  ///< a refresh may go before writes

  Cmd needed(const QueueEntry& e) const {
    const std::uint32_t open = device.row(e.bank);
    if (open == e.row) return e.request.write ? Cmd::kWr : Cmd::kRd;
    return open == DdrDevice::kClosed ? Cmd::kAct : Cmd::kPre;
  }
  std::uint64_t earliest(const QueueEntry& e, Cmd cmd, std::uint64_t edge) const {
    const std::uint64_t at = std::max(edge, device.earliest(cmd, e.bank));
    return cmd == Cmd::kRd ? std::max(at, room) : at;
  }
};

/// A scheduler has no state: it plans from the queue and the part as they are, so that it does not matter
/// when or how often it is asked. The controller calls it through its type (ddr_schedule.cpp), and looks
/// after refresh and rows that are due.
template <class S>
concept Scheduler = requires(const SchedulerInput& in, const CommandQueue& queue,
                             const QueueEntry& entry, Positions set, std::uint64_t edge,
                             unsigned position, Plan& plan) {
  /// `ddr.scheduler`.
  { S::kName } -> std::convertible_to<const char*>;
  /// Reads of one master may get their data in another order than that of their issue.
  { S::kReordersReads } -> std::convertible_to<bool>;
  /// A row is closed after its access, if no other request wants it.
  { S::kClosesRows } -> std::convertible_to<bool>;
  /// True if the request, the newest, competes at once; `set`: the older ones of its master.
  { S::competes(queue, entry, set) } -> std::same_as<bool>;
  /// Those of a master's requests, `set`, that compete after one of its requests has left.
  { S::competing(queue, set) } -> std::same_as<Positions>;
  /// Of the requests `set` those whose data command may come next.
  { S::considered(queue, set) } -> std::same_as<Positions>;
  /// Chooses the command to issue if only the requests `set`, not empty, had come through the
  /// controller's pipeline by `edge`; its clock is the first at or after `edge` at which it is legal.
  S::choose(in, edge, set, plan);
  /// After choose(in, ..., set, plan) the request at `position`, younger than all in `set`, comes through
  /// the pipeline at `edge`. True if the choice need not be made again; it may have been changed.
  { S::stands(in, position, edge, set, plan) } -> std::same_as<bool>;
};

/// The newcomer's bank is prepared ahead of the present choice if that is possible earlier. False if the
/// choice must be made again. For Scheduler::stands(), if neither the newcomer's data command nor that of
/// another one in its bank, but those in `rivals`, can be the next.
inline bool prepare_bank(const SchedulerInput& in, unsigned position, std::uint64_t edge,
                         Positions rivals, Plan& plan) {
  QueueEntry& e = in.queue.entry(position);
  Choice& choice = plan.choice;
  if (e.bank == choice.entry->bank) return false;
  if (in.queue.hits() >> position & 1u) return true;
  const Cmd prepare = in.device.preparation(e.bank);
  const std::uint64_t at = std::max(edge, in.device.earliest(prepare, e.bank));
  const bool of_first = choice.entry == &in.queue.entry(plan.first);
  if (at > choice.at || (at == choice.at && of_first)) return true;
  if (at == choice.at || (rivals & in.queue.order().of_bank(e.bank))) return false;
  choice = {&e, at, prepare, static_cast<std::uint8_t>(position)};
  return true;
}

}  // namespace fovea::mem
