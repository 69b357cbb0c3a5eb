// `ddr.scheduler = ti`: the chip's own scheduler (SPRU986B, SPRUEM4A and sisters).
#pragma once
#include "model/mem/core/scheduler/ranked.h"

namespace fovea::mem {

/// `ddr.ti_open_row` (decision 0010): the rows that count as open when open rows go first.
enum class OpenRow {
  kActivated,  ///< all from their ACT on
  kReady,      ///< those whose column command is legal first
};

/// Each master offers its oldest request, and a read that may pass its writes (rule 1). Reads go before
/// writes; in each kind open rows go first, then priority, then age (rules 2 and 3).
template <OpenRow kOpenRow>
class TiScheduler : public RankedScheduler<TiScheduler<kOpenRow>> {
  using Ranked = RankedScheduler<TiScheduler<kOpenRow>>;

 public:
  static constexpr const char* kName = "ti";
  static constexpr bool kReordersReads = false, kClosesRows = false;

  static bool competes(const CommandQueue& queue, const QueueEntry& e, Positions older) {
    return older == 0 || (!e.request.write && passes(queue, e, older));
  }
  /// No more than the oldest one and the first read.
  static Positions competing(const CommandQueue& queue, Positions of_one_master) {
    const Positions oldest_one = of_one_master & -of_one_master;
    const Positions reads = of_one_master & ~queue.order().writes(), first = reads & -reads;
    if (first & ~(queue.competing() | oldest_one) &&
        passes(queue, queue.entry(oldest(first)), of_one_master & (first - 1)))
      return oldest_one | first;
    return oldest_one;
  }

  /// Reads, then writes; with the read FIFO full writes before reads.
  static Positions best_kind(const CommandQueue& queue, Positions set, bool room) {
    const Positions kind = set & preferred(queue, room);
    return kind ? kind : set;
  }
  static Positions preferred(const CommandQueue& queue, bool room) {
    const Positions writes = queue.order().writes();
    return room ? ~writes : writes;
  }
  static Positions first_open(const SchedulerInput& in, Positions open, std::uint64_t edge) {
    return kOpenRow == OpenRow::kReady ? Ranked::soonest(in, open, edge) : open;
  }
  static unsigned first(const CommandQueue& queue, Positions set) {
    return oldest(queue.order().most_urgent(set));
  }
  static bool stays_below(const SchedulerInput& in, unsigned position, std::uint64_t edge,
                          const Plan& plan) {
    const CommandQueue& queue = in.queue;
    const bool write = queue.order().writes() >> position & 1u;
    const bool first_writes = queue.order().writes() >> plan.first & 1u;
    if (write && in.refresh_waits) return false;
    if (first_writes != write) return write;
    const QueueEntry &e = queue.entry(position), &top = queue.entry(plan.first);
    if (e.request.priority < top.request.priority) return false;
    if (!(queue.hits() >> position & 1u)) return true;
    if (!(queue.hits() >> plan.first & 1u)) return false;
    return kOpenRow == OpenRow::kActivated || !Ranked::sooner(in, e, top, edge);
  }

 private:
  /// A read may pass older writes of its master that are in other 2048-byte blocks and not more urgent.
  static bool passes(const CommandQueue& queue, const QueueEntry& read, Positions older) {
    if (older & ~queue.order().writes()) return false;
    const QueuedRequest& r = read.request;
    for (; older; older &= older - 1) {
      const QueuedRequest& o = queue.entry(oldest(older)).request;
      if ((o.address >> 11) == (r.address >> 11) || o.priority < r.priority) return false;
    }
    return true;
  }
};

}  // namespace fovea::mem
