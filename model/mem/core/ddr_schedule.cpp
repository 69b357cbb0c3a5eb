// The scheduler: which command is given next, and when.
#include <bit>

#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {

/// A decision is taken at the first edge at which something is ready; if its command can only be
/// given later, whatever becomes ready before has its say, a row that is due to be closed too.
[[gnu::noinline]] void DdrController::plan_many() {
  if (alone_) join_queue();
  const std::uint64_t first = command_free_;
  if (in_burst_) {  // a burst under way is finished before anything else
    if (next_column_ < first) {
      choice_.at += first - next_column_;
      next_column_ = first;
    }
    next_ = ddr_.edge(choice_.at);
    return;
  }
  plan_from(std::max(first, slots_[order_[0]].ready));
}

/// The same from an edge on before which nothing can be given.
void DdrController::plan_from(std::uint64_t edge) {
  std::uint32_t ready = ~free_slots_;
  std::size_t not_ready = count_;  // place in order_ of the first that the scheduler does not see
  while (slots_[order_[not_ready - 1]].ready > edge) ready ^= 1u << order_[--not_ready];
  for (;;) {
    std::uint64_t wake = not_ready < count_ ? slots_[order_[not_ready]].ready : kNoClock;
    if (lane_.room() > edge) wake = std::min(wake, lane_.room());
    choose(edge, ready);
    if (choice_.at >= all_in_time_until_) [[unlikely]] {
      if (const std::uint64_t due = first_overdue(); due > edge) wake = std::min(wake, due);
      if (choice_.at < wake) break;
    } else if (choice_.at < wake ||
               (not_ready + 1 == count_ && stands_with(order_[not_ready], wake, ready))) {
      break;
    }
    edge = wake;
    for (; not_ready < count_ && slots_[order_[not_ready]].ready <= edge; ++not_ready)
      ready |= 1u << order_[not_ready];
  }
  next_ = ddr_.edge(choice_.at);
}

/// True if choice_, made with the slots `ready`, need not be made again when the one in `slot`, the
/// newest, is seen at `edge`: it changes nothing, or it prepares its own bank first.
bool DdrController::stands_with(unsigned slot, std::uint64_t edge, std::uint32_t ready) {
  if (!plain_ || lane_.room() > edge || edge >= all_in_time_until_) return false;
  const std::uint32_t bit = 1u << slot;
  if (in_order_ || !(offered_ & bit)) return true;
  const bool write = writes_ & bit;
  if (urgency_ != Urgency::kMay && (write || !kinds_count_)) return false;
  // It must rank below the first.
  const std::uint32_t first = 1u << first_;
  const bool first_writes = writes_ & first;
  if (kinds_count_ && first_writes && !write) return false;
  if (!kinds_count_ || first_writes == write) {
    const bool hits_first = (hits_ & bit) && !(hits_ & first);
    if (hits_first || (ranks_[slot] & rank_mask_) < (ranks_[first_] & rank_mask_)) return false;
  }
  const Entry& e = slots_[slot];
  if (e.bank == slots_[first_].bank) return true;
  if (e.bank == choice_.entry->bank) return false;
  if (hits_ & bit) return true;
  const Cmd prepare = device_.row(e.bank) == DdrDevice::kClosed ? Cmd::kAct : Cmd::kPre;
  const std::uint64_t at = std::max(edge, device_.earliest(prepare, e.bank));
  if (at > choice_.at || (at == choice_.at && choice_.entry == &slots_[first_])) return true;
  if (at == choice_.at || (ready & offered_ & of_bank_[e.bank])) return false;
  choice_ = {&slots_[slot], at, prepare};
  return true;
}

/// The slot whose request has the lowest rank.
inline unsigned DdrController::first_of(std::uint32_t slots) const {
  auto first = static_cast<unsigned>(std::countr_zero(slots));
  if ((slots &= slots - 1) == 0) return first;
  Rank lowest = ranks_[first] & rank_mask_;
  for (; slots; slots &= slots - 1)
    lowest = std::min(lowest, ranks_[static_cast<unsigned>(std::countr_zero(slots))] & rank_mask_);
  return static_cast<unsigned>(lowest % kMaxEntries);
}

/// Rules 2 and 3: reads, then writes; with the read FIFO full, writes before reads.
inline std::uint32_t DdrController::best_kind(std::uint32_t slots, bool room) const {
  if (room && !kinds_count_) return slots;
  const std::uint32_t kind = slots & (room ? ~writes_ : writes_);
  return kind ? kind : slots;
}

/// The command to give if only the requests in the slots `ready` are there.
inline void DdrController::choose(std::uint64_t edge, std::uint32_t ready) {
  ready &= in_order_ ? 1u << order_[0] : offered_;
  plain_ = false;
  if (edge >= calm_until_) [[unlikely]] {
    const Urgency refresh = refresh_urgency(edge);
    if (refresh == Urgency::kMust || (refresh == Urgency::kNeed && refresh_goes_first(ready)))
      return choose_refresh(edge);
    if (edge >= all_in_time_until_ && choose_overdue_row(edge)) return;
  }
  // By kind; in each open rows first, then priority, then age (rules 2 and 3).
  const bool room = lane_.room() <= edge;
  unsigned first;
  // Rule 5: the oldest command, passed by too often, is raised.
  if (served_while_oldest_ > config_.old_count && config_.old_count != 0xFF) [[unlikely]] {
    first = order_[0];
  } else {
    plain_ = room;
    const std::uint32_t kind = best_kind(ready, room), open = kind & hits_;
    first = first_of(open ? open : kind);
  }
  // The first in rank gets its command; others may only prepare banks that nobody above them needs.
  first_ = first;
  Entry* const top = &slots_[first];
  const Cmd cmd = needed(*top);
  choice_ = {top, earliest(*top, cmd, edge), cmd};
  if (choice_.at == edge) return;
  std::uint32_t best = 0;  // others of the same clock
  ready &= ~of_bank_[top->bank];
  while (ready) {
    const unsigned bank = slots_[static_cast<unsigned>(std::countr_zero(ready))].bank;
    const std::uint32_t kind = best_kind(ready & of_bank_[bank], room);
    ready &= ~of_bank_[bank];
    if (kind & hits_) continue;
    const Cmd prepare = device_.row(bank) == DdrDevice::kClosed ? Cmd::kAct : Cmd::kPre;
    const std::uint64_t at = std::max(edge, device_.earliest(prepare, bank));
    if (at > choice_.at || (at == choice_.at && best == 0)) continue;
    Entry* const e = &slots_[first_of(kind)];
    const std::uint32_t bit = 1u << (e - slots_.data());
    if (at < choice_.at) {
      best = 0;
    } else {
      const std::uint32_t both = best_kind(best | bit, room);
      if (first_of(both) != static_cast<unsigned>(e - slots_.data())) continue;
    }
    choice_ = {e, at, prepare};
    best = bit;
  }
}

/// Rule 4: a needed refresh goes before writes and before a read that has a more urgent write. Each
/// is the first of its kind among the slots `set`.
bool DdrController::refresh_goes_first(std::uint32_t set) const {
  const auto priority = [&](std::uint32_t kind) {
    const std::uint32_t open = kind & hits_;
    Rank first = ~Rank{0};
    for (kind = open ? open : kind; kind; kind &= kind - 1)
      first = std::min(first, ranks_[static_cast<unsigned>(std::countr_zero(kind))]);
    return first >> kPriorityBit;
  };
  const std::uint32_t reads = set & ~writes_, writes = set & writes_;
  return !reads || (writes && priority(writes) < priority(reads));
}

void DdrController::choose_refresh(std::uint64_t edge) {
  if (device_.all_closed())
    choice_ = {nullptr, std::max(edge, device_.earliest_refresh()), Cmd::kRef};
  else
    choice_ = {nullptr, std::max(edge, device_.earliest_pre_all()), Cmd::kPreAll};
}

/// At an edge after which an interval may have run out.
DdrController::Urgency DdrController::refresh_urgency_after(std::uint64_t edge) const {
  unsigned expired = 0;
  if (config_.refresh_interval && edge >= next_expiry_)
    expired = 1 + static_cast<unsigned>((edge - next_expiry_) / config_.refresh_interval);
  if (forced_ > 0 || closing_ || owed_ + expired > must_ || gap_ + expired > gap_limit_)
    return Urgency::kMust;
  return owed_ + expired > need_ ? Urgency::kNeed : Urgency::kMay;
}

}  // namespace fovea::mem
