// The example of model/howto/add-a-scheduler.md.
#pragma once
#include "model/mem/core/scheduler/ranked.h"

namespace fovea::mem {

/// `ddr.scheduler = shortest_first`: of the requests whose row is open the shortest goes first, then the
/// oldest. Each master offers its oldest request.
class ShortestFirstScheduler : public RankedScheduler<ShortestFirstScheduler> {
 public:
  static constexpr const char* kName = "shortest_first";
  static constexpr bool kReordersReads = false, kClosesRows = false;

  static bool competes(const CommandQueue&, const QueueEntry&, Positions older) {
    return older == 0;
  }
  static Positions competing(const CommandQueue&, Positions of_one_master) {
    return of_one_master & -of_one_master;
  }

  static Positions best_kind(const CommandQueue& queue, Positions set, bool room) {
    const Positions kind = set & preferred(queue, room);
    return kind ? kind : set;
  }
  static Positions preferred(const CommandQueue& queue, bool room) {
    return room ? ~Positions{0} : queue.order().writes();
  }
  static Positions first_open(const SchedulerInput& in, Positions open, std::uint64_t) {
    unsigned least = ~0u;
    for (Positions set = open; set; set &= set - 1)
      least = std::min<unsigned>(least, in.queue.entry(oldest(set)).chunks);
    Positions shortest = 0;
    for (Positions set = open; set; set &= set - 1)
      if (in.queue.entry(oldest(set)).chunks == least) shortest |= set & -set;
    return shortest;
  }
  static unsigned first(const CommandQueue&, Positions set) { return oldest(set); }
  /// No newcomer leaves the choice as it is: it is made again each time.
  static bool stays_below(const SchedulerInput&, unsigned, std::uint64_t, const Plan&) {
    return false;
  }
};

static_assert(Scheduler<ShortestFirstScheduler>);

}  // namespace fovea::mem
