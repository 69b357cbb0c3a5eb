// What schedulers have in common that rank all competing requests.
#pragma once
#include "model/mem/core/scheduler/scheduler.h"

namespace fovea::mem {

/// The first in rank gets its command; until that is legal the others may open or close rows of banks
/// that it does not need. `Rank` has the order:
///   best_kind(queue, set, room)     those that go before the others by kind
///   first_open(in, set, edge)       of requests with open rows those that go first
///   first(queue, set)               the position that goes first of equals
///   preferred(queue, room)          those whose banks are prepared first
///   stays_below(in, position, ...)  true if the newest request cannot rank before plan.first
template <class Rank>
class RankedScheduler {
 public:
  static Positions considered(const CommandQueue& queue, Positions set) {
    return set & queue.competing();
  }

  [[gnu::always_inline]] static void choose(const SchedulerInput& in, std::uint64_t edge,
                                            Positions set, Plan& plan) {
    set &= in.queue.competing();
    const bool room = in.room <= edge;
    unsigned first = 0;
    if (!in.oldest_raised) [[likely]] {
      plan.by_rank = room;
      const Positions kind = Rank::best_kind(in.queue, set, room);
      const Positions open = Rank::first_open(in, kind & in.queue.hits(), edge);
      first = Rank::first(in.queue, open ? open : kind);
    }
    plan.first = first;
    QueueEntry& top = in.queue.entry(first);
    const Cmd cmd = in.needed(top);
    plan.choice = {&top, in.earliest(top, cmd, edge), cmd, static_cast<std::uint8_t>(first)};
    if (plan.choice.at == edge) return;
    set &= ~in.queue.order().of_bank(top.bank);
    if (set) prepare_others(in, edge, set, room, plan);
  }

  [[gnu::always_inline]] static bool stands(const SchedulerInput& in, unsigned position,
                                            std::uint64_t edge, Positions set, Plan& plan) {
    if (!(in.queue.competing() >> position & 1u)) return true;
    if (!Rank::stays_below(in, position, edge, plan)) return false;
    if (in.queue.entry(position).bank == in.queue.entry(plan.first).bank) return true;
    return prepare_bank(in, position, edge, set & in.queue.competing(), plan);
  }

 protected:
  /// Puts the ACT or PRE of another bank before the choice, if it is legal earlier; of several at the
  /// same clock the one that ranks first. A bank with a preferred request that hits is left alone.
  static void prepare_others(const SchedulerInput& in, std::uint64_t edge, Positions set, bool room,
                             Plan& plan) {
    QueuePositions::ByBank kinds;
    unsigned banks =
        in.queue.order().by_bank(set, Rank::preferred(in.queue, room), in.queue.hits(), kinds);
    std::uint64_t best = plan.choice.at - 1;
    Positions at_best = 0;
    for (; banks; banks &= banks - 1) {
      const unsigned bank = oldest(banks);
      const std::uint64_t at =
          std::max(edge, in.device.earliest(in.device.preparation(bank), bank));
      const Positions kind = kinds.places[bank];
      at_best = at < best ? kind : at == best ? at_best | kind : at_best;
      best = std::min(best, at);
    }
    if (at_best == 0) return;
    const unsigned position = Rank::first(in.queue, Rank::best_kind(in.queue, at_best, room));
    QueueEntry& e = in.queue.entry(position);
    plan.choice = {&e, best, in.device.preparation(e.bank), static_cast<std::uint8_t>(position)};
  }

  /// Of requests whose rows are open those whose column commands are legal first.
  [[gnu::noinline]] static Positions soonest(const SchedulerInput& in, Positions open,
                                             std::uint64_t edge) {
    Positions best = 0;
    std::uint64_t best_at = ~std::uint64_t{0};
    for (; open; open &= open - 1) {
      const Positions bit = open & -open;
      const QueueEntry& e = in.queue.entry(oldest(bit));
      const std::uint64_t at = in.earliest(e, in.needed(e), edge);
      best = at < best_at ? bit : at == best_at ? best | bit : best;
      best_at = std::min(best_at, at);
    }
    return best;
  }
  /// True if the column command of one request is legal before that of another.
  static bool sooner(const SchedulerInput& in, const QueueEntry& one, const QueueEntry& other,
                     std::uint64_t edge) {
    return in.earliest(one, in.needed(one), edge) < in.earliest(other, in.needed(other), edge);
  }
};

}  // namespace fovea::mem
