// Who or what a read waited for in the controller.
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {
namespace {

/// Of a DdrController::Blame: masters, then these.
constexpr Culprit culprit_of(std::size_t cause) {
  constexpr std::array kRest = {Culprit::kTurnaround, Culprit::kRefresh, Culprit::kPowerDown};
  return cause < kMasterCount ? static_cast<Culprit>(cause) : kRest[cause - kMasterCount];
}

}  // namespace

/// After another clock: edges before its restart have no times any more.
void DdrController::retime_history() {
  for (IssuedCommand& g : history_) g.at = ddr_.edge(std::max(g.clock, first_edge_));
  for (Baseline& s : baselines_) s.newest = Baseline::kNot;
}

/// Of those that became ready before `clock`, with no command since the newest.
[[gnu::noinline]] void DdrController::take_baselines(std::uint64_t clock, const Entry* served) {
  const std::uint64_t newest = issued_count_ - 1;
  const IssuedCommand& g = issued(newest);
  for (; baseline_count_ < count_; ++baseline_count_) {
    const Entry& e = entry(baseline_count_);
    if (e.ready >= clock) break;
    if (e.request.write || &e == served) continue;
    Baseline& s = baselines_[queue_.slot(baseline_count_)];
    const std::uint64_t ready = std::max(e.ready, first_edge_);
    if (issued_count_ == 0 || g.clock > ready) {
      s.newest = Baseline::kNot;
      continue;
    }
    for (std::size_t i = 0; i < totals_.size(); i += 2)
      store_pair(&s.totals[i], load_pair(&totals_[i]));
    s.newest = newest;
    s.totals[late_cause_] += late_.itself;
    const Attributed part = attributed(g, ready, ddr_.edge(ready));
    s.totals[g.cause] += part.itself;
    s.totals[kTurned] += late_.turned + part.turned;
  }
  find_next_without_baseline();
}

/// The waits since `ready`, by the commands one by one: for a few, or where the sums at `ready` are
/// not known. Its own ACT and PRE are no wait behind an earlier request.
[[gnu::noinline]] void DdrController::attribute_each(const Entry& e, std::uint64_t ready,
                                                 Picoseconds from, std::uint64_t clock) {
  const Culprit own = culprit(e.request.master);
  const std::uint64_t end = issued_count_;
  const std::uint64_t oldest = end - std::min<std::uint64_t>(end, kHistory - 1);
  std::uint64_t n = end - 1;  // the last command at or before `ready`, or the oldest that is known
  while (n > oldest && issued(n).clock > ready) --n;
  std::uint64_t prepared = 0;  // bit i: the command i before `end`
  Culprit row = Culprit::kRowMiss;
  for (std::uint64_t p = e.prepared; p > n; p = issued(p - 1).before) {
    const IssuedCommand& g = issued(p - 1);
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
  until(issued(n).clock, issued(n).at, own);  // what is not known is its own
  for (; n < end; ++n) {
    const IssuedCommand& g = issued(n);
    const bool newest = n + 1 == end;
    const std::uint64_t next = newest ? clock : issued(n + 1).clock;
    const Picoseconds next_at = newest ? next_ : issued(n + 1).at;
    if (g.cmd == Cmd::kWr) {
      const std::uint64_t over =
          std::min(next, g.clock + config_.timing.WL() + DdrTiming::kBurstClocks);
      if (over > at) until(over, ddr_.edge(over), culprit_of(g.cause));
      until(next, next_at, Culprit::kTurnaround);
    } else {
      until(next, next_at, prepared >> (end - n - 1) & 1u ? row : culprit_of(g.cause));
    }
  }
}

/// The same by sums, however many commands there were. `newest`: what the newest one adds.
[[gnu::always_inline]] inline void DdrController::attribute_by_totals(const Entry& e, const Baseline& seen,
                                                             std::uint64_t ready,
                                                             const Attributed& newest) {
  static_assert(index(culprit_of(kTurned)) + 1 == index(culprit_of(kRefreshed)) &&
                index(culprit_of(kTurned)) + 2 == index(culprit_of(kAsleep)));
  const std::uint64_t end = issued_count_;
  const std::uint64_t oldest = end - std::min<std::uint64_t>(end, kHistory - 1);
  Picoseconds row = 0;
  bool closed_other = false;
  for (std::uint64_t p = e.prepared; p > oldest; p = issued(p - 1).before) {
    const IssuedCommand& g = issued(p - 1);
    if (g.clock < ready) break;
    row += (p == end ? next_ : issued(p).at) - g.at;
    closed_other |= g.cmd == Cmd::kPre;
  }
  Waits& w = waits[index(e.request.master)].read;
  std::optional<Waits> before;
  if (e.request.parts) before = w;
  w.add_masters(totals_.data(), seen.totals.data());
  constexpr std::size_t kRest = index(culprit_of(kTurned));
  store_pair(&w.ps[kRest], load_pair(&w.ps[kRest]) + (load_pair(&totals_[kTurned]) -
                                                      load_pair(&seen.totals[kTurned])));
  w.ps[kRest + 2] += totals_[kAsleep] - seen.totals[kAsleep];
  w.add(culprit_of(late_cause_), late_.itself);
  w.add(culprit_of(issued(end - 1).cause), newest.itself);
  w.add(Culprit::kTurnaround, late_.turned + newest.turned);
  w.take_back(culprit(e.request.master), row);
  w.add(closed_other ? Culprit::kRowConflict : Culprit::kRowMiss, row);
  if (!before) return;
  for (std::size_t c = 0; c < kCulprits; ++c)
    if (const Picoseconds t = w.ps[c] - before->ps[c])
      e.request.parts->add(static_cast<Culprit>(c), t);
}

/// The waits of a read whose first column command is issued now, at `clock`, since it became ready.
[[gnu::noinline]] void DdrController::attribute(const Entry& e, std::uint64_t clock) {
  const std::uint64_t ready = std::max(e.ready, first_edge_);
  const Picoseconds from = ddr_.edge(ready);
  read_waited_ = next_ - from;
  if (issued_count_ == 0) return charge(e, culprit(e.request.master), read_waited_);
  const IssuedCommand& newest = issued(issued_count_ - 1);
  if (newest.clock <= ready) {
    const bool own_act = newest.clock == ready && e.prepared == issued_count_;
    const Attributed before = attributed(newest, ready, from), all = attributed(newest, clock, next_);
    charge(e, own_act ? Culprit::kRowMiss : culprit_of(newest.cause), all.itself - before.itself);
    if (all.turned) charge(e, Culprit::kTurnaround, all.turned - before.turned);
    return;
  }
  const std::uint64_t oldest = issued_count_ - std::min<std::uint64_t>(issued_count_, kHistory - 1);
  if (!single_) {
    const Baseline& seen = baselines_[queue_.slot(choice_.position)];
    if (seen.newest != Baseline::kNot && seen.newest >= oldest)
      return attribute_by_totals(e, seen, ready, attributed(newest, clock, next_));
  }
  attribute_each(e, ready, from, clock);
}

}  // namespace fovea::mem
