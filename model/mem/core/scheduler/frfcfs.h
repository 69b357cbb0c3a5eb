// `ddr.scheduler = frfcfs`: first ready, first come, first served, the textbook's policy.
#pragma once
#include "model/mem/core/scheduler/ranked.h"

namespace fovea::mem {

/// Of the requests whose row is open the one whose data command is legal first goes first, then the
/// oldest. Kinds and priorities do not count. Requests of one master pass each other, unless one of two
/// to the same 64 bytes writes.
class FrfcfsScheduler : public RankedScheduler<FrfcfsScheduler> {
 public:
  static constexpr const char* kName = "frfcfs";
  static constexpr bool kReordersReads = true, kClosesRows = false;

  static bool competes(const CommandQueue& queue, const QueueEntry& e, Positions older) {
    return older == 0 || !bound(queue, e, older);
  }
  static Positions competing(const CommandQueue& queue, Positions of_one_master) {
    Positions found = 0;
    for (Positions rest = of_one_master & ~queue.competing(); rest; rest &= rest - 1) {
      const Positions bit = rest & -rest;
      if (!bound(queue, queue.entry(oldest(rest)), of_one_master & (bit - 1))) found |= bit;
    }
    return found;
  }

  /// With the read FIFO full writes go before reads.
  static Positions best_kind(const CommandQueue& queue, Positions set, bool room) {
    const Positions kind = set & preferred(queue, room);
    return kind ? kind : set;
  }
  static Positions preferred(const CommandQueue& queue, bool room) {
    return room ? ~Positions{0} : queue.order().writes();
  }
  static Positions first_open(const SchedulerInput& in, Positions open, std::uint64_t edge) {
    return soonest(in, open, edge);
  }
  static unsigned first(const CommandQueue&, Positions set) { return oldest(set); }
  static bool stays_below(const SchedulerInput& in, unsigned position, std::uint64_t edge,
                          const Plan& plan) {
    const CommandQueue& queue = in.queue;
    if (in.refresh_waits) return false;
    if (!(queue.hits() >> position & 1u)) return true;
    if (!(queue.hits() >> plan.first & 1u)) return false;
    return !sooner(in, queue.entry(position), queue.entry(plan.first), edge);
  }

 private:
  /// True if the request must stay behind one of these older ones of its master: one of the two writes to
  /// the 64-byte block of the other.
  static bool bound(const CommandQueue& queue, const QueueEntry& younger, Positions older) {
    const QueuedRequest& r = younger.request;
    for (; older; older &= older - 1) {
      const QueuedRequest& o = queue.entry(oldest(older)).request;
      if ((r.write || o.write) && o.address >> 6 == r.address >> 6) return true;
    }
    return false;
  }
};

}  // namespace fovea::mem
