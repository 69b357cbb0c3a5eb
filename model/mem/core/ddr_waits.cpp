// Who or what a read waited for in the controller.
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {

/// Brings blames_ up to the newest command.
void DdrController::sum_given() {
  if (given_count_ - summed_ > kGiven) summed_ = given_count_ - kGiven;
  // Edges before a clock's restart have no times any more.
  const auto time = [this](std::uint64_t clock) { return ddr_.edge(std::max(clock, first_edge_)); };
  if (summed_ + 1 >= given_count_) return;
  const std::uint64_t write = config_.timing.WL() + DdrTiming::kBurstClocks;
  for (Picoseconds from = time(given(summed_).clock); summed_ + 1 < given_count_; ++summed_) {
    const Given& g = given(summed_);
    const std::uint64_t until = given(summed_ + 1).clock;
    const Picoseconds to = time(until);
    blames_before_[summed_ % kGiven] = blames_;
    blames_[kAll] += to - from;
    if (g.cmd == Cmd::kWr && g.clock + write < until) {
      const Picoseconds over = time(g.clock + write);
      blames_[kTurned] += to - over;
      blames_[index(g.culprit)] += over - from;
    } else {
      const std::size_t of = g.culprit == Culprit::kRefresh     ? std::size_t{kRefreshed}
                             : g.culprit == Culprit::kPowerDown ? std::size_t{kAsleep}
                                                                : index(g.culprit);
      blames_[of] += to - from;
    }
    from = to;
  }
}

inline void DdrController::charge_read(const Entry& e, const Waits& w) {
  Waits& all = waits[index(e.request.master)].read;
  for (std::size_t c = 0; c < kCulprits; ++c) all.ps[c] += w.ps[c];
  if (!e.request.parts) return;
  for (std::size_t c = 0; c < kCulprits; ++c)
    if (w.ps[c]) e.request.parts->add(static_cast<Culprit>(c), w.ps[c]);
}

/// The waits of a read whose first column command, already noted, is given at `clock`, since it
/// became ready.
[[gnu::noinline]] void DdrController::attribute(const Entry& e, std::uint64_t clock) {
  const Culprit own = culprit(e.request.master);
  const std::uint64_t ready = std::max(e.ready, first_edge_);
  const Picoseconds start = ddr_.edge(ready);
  read_waited_ = ddr_.edge(clock) - start;
  // The last command at or before `ready`, or the oldest one that is known.
  const std::uint64_t last = given_count_ - 1;
  const std::uint64_t oldest = last - std::min<std::uint64_t>(last, kGiven - 1);
  std::uint64_t n = std::max(e.given - (e.given != 0), oldest);
  while (n > oldest && given(n).clock > ready) --n;
  while (n + 1 < last && given(n + 1).clock <= ready) ++n;
  Waits w;
  if (n == last) {  // nothing was given before it
    w.add(own, read_waited_);
    return charge_read(e, w);
  }

  if (alone_) summed_ = std::max(summed_, n);  // later requests ask for later commands
  sum_given();
  const Blames& before = blames_before_[n % kGiven];
  for (std::size_t m = 0; m < kMasterCount; ++m) w.ps[m] = blames_[m] - before[m];
  w.add(Culprit::kTurnaround, blames_[kTurned] - before[kTurned]);
  w.add(Culprit::kRefresh, blames_[kRefreshed] - before[kRefreshed]);
  w.add(Culprit::kPowerDown, blames_[kAsleep] - before[kAsleep]);
  Picoseconds all = blames_[kAll] - before[kAll];
  const Given& first = given(n);
  if (first.clock < ready) {  // the part before `ready`
    const Picoseconds from = ddr_.edge(std::max(first.clock, first_edge_));
    Picoseconds until = start;
    if (first.cmd == Cmd::kWr) {
      const std::uint64_t over = first.clock + config_.timing.WL() + DdrTiming::kBurstClocks;
      if (over < ready) {
        until = ddr_.edge(std::max(over, first_edge_));
        w.ps[index(Culprit::kTurnaround)] -= start - until;
      }
    }
    w.ps[index(first.culprit)] -= until - from;
    all -= start - from;
  }
  w.add(own, read_waited_ - all);  // what is not known is its own
  // Its own ACT and PRE are no wait behind an earlier request.
  Picoseconds row = 0;
  bool closed_other = false;
  for (std::uint64_t p = e.prepared; p > oldest; p = given(p - 1).before) {
    const Given& g = given(p - 1);
    if (g.clock < ready) break;
    row += ddr_.edge(given(p).clock) - ddr_.edge(g.clock);
    closed_other |= g.cmd == Cmd::kPre;
  }
  w.ps[index(own)] -= row;
  w.add(closed_other ? Culprit::kRowConflict : Culprit::kRowMiss, row);
  charge_read(e, w);
}

}  // namespace fovea::mem
