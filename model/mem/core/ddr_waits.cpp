// Who or what a read waited for in the controller.
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {

/// The waits of a read whose first column command, already noted, is given at `clock`. From the
/// newest command before it back to the time it became ready.
void DdrController::attribute(const Entry& e, std::uint64_t clock) {
  Waits& w = waits[index(e.request.master)].read;
  // Edges before a clock's restart have no times any more.
  const std::uint64_t ready = std::max(e.ready, first_edge_);
  const Picoseconds end = ddr_.edge(clock), start = ddr_.edge(ready);
  Picoseconds until = end;
  std::uint64_t at = clock;
  const auto take = [&](std::uint64_t from, Culprit c) {
    if (from >= at) return;
    const Picoseconds t = from <= ready ? start : ddr_.edge(from);
    w.add(c, until - t);
    if (e.request.parts) e.request.parts->add(c, until - t);
    until = t;
    at = std::max(from, ready);
  };
  bool closed_other = false;  // its ACT followed a PRE of its own
  for (std::uint32_t n = given_count_ - 1, left = kGiven - 1; left > 0 && n > 0; --left) {
    const Given& g = given_[--n % kGiven];
    if (g.clock < ready) break;
    closed_other |= g.cmd == Cmd::kPre && g.entry == &e;
  }
  for (std::uint32_t n = given_count_ - 1, left = kGiven - 1; left > 0 && n > 0 && at > ready;
       --left) {
    const Given& g = given_[--n % kGiven];
    const bool own = g.entry == &e && g.clock >= ready;
    switch (g.cmd) {
      case Cmd::kPreAll:
      case Cmd::kRef: take(g.clock, Culprit::kRefresh); break;
      case Cmd::kPde:
      case Cmd::kPdx:
      case Cmd::kSre:
      case Cmd::kSrx: take(g.clock, Culprit::kPowerDown); break;
      case Cmd::kAct:
        if (own) {
          take(g.clock, closed_other ? Culprit::kRowConflict : Culprit::kRowMiss);
          break;
        }
        [[fallthrough]];
      case Cmd::kPre:
        if (own)
          take(g.clock, Culprit::kRowConflict);
        else
          take(g.clock, static_cast<Culprit>(g.master));
        break;
      case Cmd::kWr:
        take(g.clock + config_.timing.WL() + DdrTiming::kBurstClocks, Culprit::kTurnaround);
        [[fallthrough]];
      default: take(g.clock, static_cast<Culprit>(g.master)); break;
    }
  }
  take(ready, culprit(e.request.master));
  read_waited_ = end - start;
}

}  // namespace fovea::mem
