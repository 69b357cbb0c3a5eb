// The scheduler: which command is issued next, and when.
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {

/// A decision is taken at the first edge at which something is ready. If its command is legal only
/// later, whatever becomes ready before that is considered too, as is a row that is due to be closed.
[[gnu::noinline]] void DdrController::plan_from(std::uint64_t edge) {
  unsigned seen = count_;  // by the scheduler: they come in the order of age
  while (entry(seen - 1).ready > edge) --seen;
  for (;;) {
    choose(edge, (1u << seen) - 1);
    std::uint64_t wake = kNoClock;
    for (; seen < count_; ++seen) {
      wake = entry(seen).ready;
      if (choice_.at < wake || !stands_with(seen, wake, (1u << seen) - 1)) break;
      wake = kNoClock;
    }
    if (return_channel_.room() > edge) wake = std::min(wake, return_channel_.room());
    if (choice_.at >= all_in_time_until_) [[unlikely]]
      if (const std::uint64_t due = first_overdue(); due > edge) wake = std::min(wake, due);
    if (choice_.at < wake) break;
    edge = wake;
    while (seen < count_ && entry(seen).ready <= edge) ++seen;
  }
  next_ = ddr_.edge(choice_.at);
}

/// True if choice_, made with the positions `ready`, need not be made again when the next one is seen
/// at `edge`: that changes nothing, or it prepares its own bank first.
bool DdrController::stands_with(unsigned position, std::uint64_t edge, Positions ready) {
  if (!plain_ || return_channel_.room() > edge || edge >= all_in_time_until_) return false;
  const Positions bit = 1u << position;
  const Entry &e = entry(position), &top = entry(first_);
  if (policy_.in_order) {
    if (ready & queue_.of_bank(e.bank)) return true;  // the oldest request decides about a bank
  } else {
    if (!(offered_ & bit)) return true;
    if (!ranks_below_first(position, edge)) return false;
    if (e.bank == top.bank) return true;
  }
  if (e.bank == choice_.entry->bank) return false;
  if (hits_ & bit) return true;
  const Cmd prepare = device_.preparation(e.bank);
  const std::uint64_t at = std::max(edge, device_.earliest(prepare, e.bank));
  if (at > choice_.at || (at == choice_.at && choice_.entry == &top)) return true;
  if (at == choice_.at || (ready & offered_ & queue_.of_bank(e.bank))) return false;
  choice_ = {&entry(position), at, prepare, static_cast<std::uint8_t>(position)};
  return true;
}

/// True if the newest request cannot rank before the first one.
inline bool DdrController::ranks_below_first(unsigned position, std::uint64_t edge) const {
  const Positions bit = 1u << position, first = 1u << first_;
  const bool write = queue_.writes() & bit, first_writes = queue_.writes() & first;
  if (urgency_ != Urgency::kMay && (write || !policy_.kinds_count)) return false;
  if (policy_.kinds_count && first_writes && !write) return false;
  if (policy_.kinds_count && first_writes != write) return true;
  const Entry &e = entry(position), &top = entry(first_);
  if (policy_.kinds_count && e.request.priority < top.request.priority) return false;
  if (!(hits_ & bit)) return true;
  if (!(hits_ & first)) return false;
  return !policy_.first_ready || earliest(e, needed(e), edge) >= earliest(top, needed(top), edge);
}

/// The position of the request that ranks first: by priority, then age.
inline unsigned DdrController::first_of(Positions set) const {
  return oldest(policy_.kinds_count ? queue_.most_urgent(set) : set);
}

/// Rules 2 and 3: reads, then writes; with the read FIFO full, writes before reads.
inline Positions DdrController::best_kind(Positions set, bool room) const {
  if (room && !policy_.kinds_count) return set;
  const Positions writes = queue_.writes(), kind = set & (room ? ~writes : writes);
  return kind ? kind : set;
}

/// Of requests whose rows are open those whose column commands are legal first.
[[gnu::noinline]] Positions DdrController::soonest(Positions open, std::uint64_t edge) const {
  Positions best = 0;
  std::uint64_t best_at = kNoClock;
  for (; open; open &= open - 1) {
    const Positions bit = open & -open;
    const Entry& e = entry(oldest(bit));
    const std::uint64_t at = earliest(e, needed(e), edge);
    best = at < best_at ? bit : at == best_at ? best | bit : best;
    best_at = std::min(best_at, at);
  }
  return best;
}

/// `fcfs`: the oldest request gets its command, and its column before all others. Meanwhile the oldest
/// request to each other bank may open its row.
[[gnu::noinline]] void DdrController::choose_in_order(std::uint64_t edge, Positions ready) {
  Positions prepares = 0;  // the oldest of each bank
  for (unsigned bank = 0; bank < DdrDevice::kMaxBanks; ++bank) {
    const Positions set = ready & queue_.of_bank(bank);
    prepares |= set & -set;
  }
  Entry& top = entry(0);
  const Cmd cmd = needed(top);
  first_ = 0;
  plain_ = return_channel_.room() <= edge;
  choice_ = {&top, earliest(top, cmd, edge), cmd, 0};
  prepares &= ~queue_.of_bank(top.bank);
  if (prepares && choice_.at > edge) prepare_others(edge, prepares, true);
}

/// The command to issue if only the requests at the positions `ready` are there.
inline void DdrController::choose(std::uint64_t edge, Positions ready) {
  const Positions seen = ready;
  ready &= policy_.in_order ? 1u : offered_;
  plain_ = false;
  if (edge >= calm_until_) [[unlikely]] {
    const Urgency refresh = refresh_urgency(edge);
    if (refresh == Urgency::kMust || (refresh == Urgency::kNeed && refresh_goes_first(ready)))
      return choose_refresh(edge);
    if (edge >= all_in_time_until_ && choose_overdue_row(edge)) return;
  }
  if (policy_.in_order) [[unlikely]]
    return choose_in_order(edge, seen);
  // By kind; in each open rows first, then priority, then age (rules 2 and 3).
  const bool room = return_channel_.room() <= edge;
  unsigned first = 0;
  // Rule 5: the oldest command, passed by too often, is raised.
  if (served_while_oldest_ <= config_.old_count || config_.old_count == 0xFF) [[likely]] {
    plain_ = room;
    const Positions kind = best_kind(ready, room);
    Positions open = kind & hits_;
    if (policy_.first_ready) [[unlikely]]
      open = soonest(open, edge);
    first = first_of(open ? open : kind);
  }
  // The first in rank gets its command; others may only prepare banks that nobody above them needs.
  first_ = first;
  Entry& top = entry(first);
  const Cmd cmd = needed(top);
  choice_ = {&top, earliest(top, cmd, edge), cmd, static_cast<std::uint8_t>(first)};
  if (choice_.at == edge) return;
  ready &= ~queue_.of_bank(top.bank);
  if (ready) prepare_others(edge, ready, room);
}

/// Puts the ACT or PRE of another bank before choice_, if it is legal earlier; of several at
/// the same clock the one that ranks first.
inline void DdrController::prepare_others(std::uint64_t edge, Positions ready, bool room) {
  const Positions preferred = !room ? queue_.writes() : policy_.kinds_count ? ~queue_.writes() : ~0u;
  QueuePositions::ByBank kinds;
  unsigned banks = queue_.by_bank(ready, preferred, hits_, kinds);
  std::uint64_t best = choice_.at - 1;
  Positions at_best = 0;
  for (; banks; banks &= banks - 1) {
    const unsigned bank = oldest(banks);
    const std::uint64_t at = std::max(edge, device_.earliest(device_.preparation(bank), bank));
    const Positions kind = kinds.places[bank];
    at_best = at < best ? kind : at == best ? at_best | kind : at_best;
    best = std::min(best, at);
  }
  if (at_best == 0) return;
  const unsigned position = first_of(best_kind(at_best, room));
  Entry& e = entry(position);
  choice_ = {&e, best, device_.preparation(e.bank), static_cast<std::uint8_t>(position)};
}

/// Rule 4: a needed refresh goes before writes and before a read that has a more urgent write. Each
/// is the first of its kind among the positions `set`.
inline bool DdrController::refresh_goes_first(Positions set) const {
  const Positions writes = set & queue_.writes(), reads = set ^ writes;
  if (!reads || !writes) return !reads;
  const auto priority = [&](Positions kind) {
    const Positions open = kind & hits_;
    return queue_.urgency(open ? open : kind);
  };
  return priority(writes) < priority(reads);
}

void DdrController::choose_refresh(std::uint64_t edge) {
  if (device_.all_closed())
    choice_ = {nullptr, std::max(edge, device_.earliest_refresh()), Cmd::kRef};
  else
    choice_ = {nullptr, std::max(edge, device_.earliest_pre_all()), Cmd::kPreAll};
}

}  // namespace fovea::mem
