// `ddr.scheduler = fcfs`: first come, first served.
#pragma once
#include "model/mem/core/scheduler/ranked.h"

namespace fovea::mem {

/// Data commands come in the order of age, whatever their kind or priority. Meanwhile the oldest request
/// to each other bank may close and open rows ahead of its turn.
class FcfsScheduler : private RankedScheduler<FcfsScheduler> {
 public:
  static constexpr const char* kName = "fcfs";
  static constexpr bool kReordersReads = false, kClosesRows = false;

  static bool competes(const CommandQueue&, const QueueEntry&, Positions) { return true; }
  static Positions competing(const CommandQueue&, Positions of_one_master) { return of_one_master; }
  static Positions considered(const CommandQueue&, Positions set) { return set & 1u; }

  static void choose(const SchedulerInput& in, std::uint64_t edge, Positions set, Plan& plan) {
    QueueEntry& top = in.queue.entry(0);
    const Cmd cmd = in.needed(top);
    plan.first = 0;
    plan.by_rank = in.room <= edge;
    plan.choice = {&top, in.earliest(top, cmd, edge), cmd, 0};
    if (plan.choice.at <= edge) return;
    Positions others = 0;  // the oldest of each other bank
    for (unsigned bank = 0; bank < DdrDevice::kMaxBanks; ++bank) {
      const Positions of_bank = set & in.queue.order().of_bank(bank);
      if (bank != top.bank) others |= of_bank & -of_bank;
    }
    if (others) prepare_others(in, edge, others, true, plan);
  }
  static bool stands(const SchedulerInput& in, unsigned position, std::uint64_t edge, Positions set,
                     Plan& plan) {
    // The oldest request to a bank decides about it.
    if (set & in.queue.order().of_bank(in.queue.entry(position).bank)) return true;
    return prepare_bank(in, position, edge, 0, plan);
  }

 private:
  friend class RankedScheduler<FcfsScheduler>;
  static Positions preferred(const CommandQueue&, bool) { return ~Positions{0}; }
  static Positions best_kind(const CommandQueue&, Positions set, bool) { return set; }
  static unsigned first(const CommandQueue&, Positions set) { return oldest(set); }
};

}  // namespace fovea::mem
