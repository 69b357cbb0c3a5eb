// Who or what a read waited for in the controller.
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {
namespace {

/// Of a DdrController::Blame: masters, then these.
constexpr Culprit culprit_of(std::size_t blame) {
  constexpr std::array kRest = {Culprit::kTurnaround, Culprit::kRefresh, Culprit::kPowerDown};
  return blame < kMasterCount ? static_cast<Culprit>(blame) : kRest[blame - kMasterCount];
}

}  // namespace

/// After another clock: edges before its restart have no times any more.
void DdrController::time_given() {
  for (Given& g : given_) g.at = ddr_.edge(std::max(g.clock, first_edge_));
  for (Seen& s : seen_) s.newest = Seen::kNot;
}

/// Of those that became ready before `clock`, with no command since the newest.
[[gnu::noinline]] void DdrController::see(std::uint64_t clock, const Entry* served) {
  const std::uint64_t newest = given_count_ - 1;
  const Given& g = given(newest);
  for (; seen_count_ < count_; ++seen_count_) {
    const Entry& e = entry(seen_count_);
    if (e.ready >= clock) break;
    if (e.request.write || &e == served) continue;
    Seen& s = seen_[places_.slot(seen_count_)];
    const std::uint64_t ready = std::max(e.ready, first_edge_);
    if (given_count_ == 0 || g.clock > ready) {
      s.newest = Seen::kNot;
      continue;
    }
    for (std::size_t i = 0; i < blames_.size(); i += 2)
      store_pair(&s.blames[i], load_pair(&blames_[i]));
    s.newest = newest;
    s.blames[late_blame_] += late_.itself;
    const Blamed part = blamed(g, ready, ddr_.edge(ready));
    s.blames[g.blame] += part.itself;
    s.blames[kTurned] += late_.turned + part.turned;
  }
  look_for_unseen();
}

/// The waits since `ready`, by the commands one by one: for a few, or where the sums at `ready` are
/// not known. Its own ACT and PRE are no wait behind an earlier request.
[[gnu::noinline]] void DdrController::blame_each(const Entry& e, std::uint64_t ready,
                                                 Picoseconds from, std::uint64_t clock) {
  const Culprit own = culprit(e.request.master);
  const std::uint64_t end = given_count_;
  const std::uint64_t oldest = end - std::min<std::uint64_t>(end, kGiven - 1);
  std::uint64_t n = end - 1;  // the last command at or before `ready`, or the oldest that is known
  while (n > oldest && given(n).clock > ready) --n;
  std::uint64_t prepared = 0;  // bit i: the command i before `end`
  Culprit row = Culprit::kRowMiss;
  for (std::uint64_t p = e.prepared; p > n; p = given(p - 1).before) {
    const Given& g = given(p - 1);
    if (g.clock < ready) break;
    prepared |= std::uint64_t{1} << (end - p);
    if (g.cmd == Cmd::kPre) row = Culprit::kRowConflict;
  }
  std::uint64_t at = ready;
  const auto until = [&](std::uint64_t next, Picoseconds to, Culprit c) {
    if (next <= at) return;
    charge(e, c, to - from);
    at = next;
    from = to;
  };
  until(given(n).clock, given(n).at, own);  // what is not known is its own
  for (; n < end; ++n) {
    const Given& g = given(n);
    const bool newest = n + 1 == end;
    const std::uint64_t next = newest ? clock : given(n + 1).clock;
    const Picoseconds next_at = newest ? next_ : given(n + 1).at;
    if (g.cmd == Cmd::kWr) {
      const std::uint64_t over =
          std::min(next, g.clock + config_.timing.WL() + DdrTiming::kBurstClocks);
      if (over > at) until(over, ddr_.edge(over), culprit_of(g.blame));
      until(next, next_at, Culprit::kTurnaround);
    } else {
      until(next, next_at, prepared >> (end - n - 1) & 1u ? row : culprit_of(g.blame));
    }
  }
}

/// The same by sums, however many commands there were. `newest`: what the newest one adds.
[[gnu::always_inline]] inline void DdrController::blame_sums(const Entry& e, const Seen& seen,
                                                             std::uint64_t ready,
                                                             const Blamed& newest) {
  static_assert(index(culprit_of(kTurned)) + 1 == index(culprit_of(kRefreshed)) &&
                index(culprit_of(kTurned)) + 2 == index(culprit_of(kAsleep)));
  const std::uint64_t end = given_count_;
  const std::uint64_t oldest = end - std::min<std::uint64_t>(end, kGiven - 1);
  Picoseconds row = 0;
  bool closed_other = false;
  for (std::uint64_t p = e.prepared; p > oldest; p = given(p - 1).before) {
    const Given& g = given(p - 1);
    if (g.clock < ready) break;
    row += (p == end ? next_ : given(p).at) - g.at;
    closed_other |= g.cmd == Cmd::kPre;
  }
  Waits& w = waits[index(e.request.master)].read;
  std::optional<Waits> before;
  if (e.request.parts) before = w;
  w.add_masters(blames_.data(), seen.blames.data());
  constexpr std::size_t kRest = index(culprit_of(kTurned));
  store_pair(&w.ps[kRest], load_pair(&w.ps[kRest]) + (load_pair(&blames_[kTurned]) -
                                                      load_pair(&seen.blames[kTurned])));
  w.ps[kRest + 2] += blames_[kAsleep] - seen.blames[kAsleep];
  w.add(culprit_of(late_blame_), late_.itself);
  w.add(culprit_of(given(end - 1).blame), newest.itself);
  w.add(Culprit::kTurnaround, late_.turned + newest.turned);
  w.take_back(culprit(e.request.master), row);
  w.add(closed_other ? Culprit::kRowConflict : Culprit::kRowMiss, row);
  if (!before) return;
  for (std::size_t c = 0; c < kCulprits; ++c)
    if (const Picoseconds t = w.ps[c] - before->ps[c])
      e.request.parts->add(static_cast<Culprit>(c), t);
}

/// The waits of a read whose first column command is given now, at `clock`, since it became ready.
[[gnu::noinline]] void DdrController::attribute(const Entry& e, std::uint64_t clock) {
  const std::uint64_t ready = std::max(e.ready, first_edge_);
  const Picoseconds from = ddr_.edge(ready);
  read_waited_ = next_ - from;
  if (given_count_ == 0) return charge(e, culprit(e.request.master), read_waited_);
  const Given& newest = given(given_count_ - 1);
  if (newest.clock <= ready) {
    const bool own_act = newest.clock == ready && e.prepared == given_count_;
    const Blamed before = blamed(newest, ready, from), all = blamed(newest, clock, next_);
    charge(e, own_act ? Culprit::kRowMiss : culprit_of(newest.blame), all.itself - before.itself);
    if (all.turned) charge(e, Culprit::kTurnaround, all.turned - before.turned);
    return;
  }
  const std::uint64_t oldest = given_count_ - std::min<std::uint64_t>(given_count_, kGiven - 1);
  if (!alone_) {
    const Seen& seen = seen_[places_.slot(choice_.place)];
    if (seen.newest != Seen::kNot && seen.newest >= oldest)
      return blame_sums(e, seen, ready, blamed(newest, clock, next_));
  }
  blame_each(e, ready, from, clock);
}

}  // namespace fovea::mem
