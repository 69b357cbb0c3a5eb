#include "model/mem/core/wait_attribution.h"

#include <optional>

namespace fovea::mem {
namespace {

constexpr std::array<Culprit, WaitAttribution::kCauses> kCulpritOf = [] {
  std::array<Culprit, WaitAttribution::kCauses> of{};
  for (const MasterInfo& r : kMasters.rows) of[index(r.id)] = culprit(r.id);
  of[WaitAttribution::kTurned] = Culprit::kTurnaround;
  of[WaitAttribution::kRefreshed] = Culprit::kRefresh;
  of[WaitAttribution::kAsleep] = Culprit::kPowerDown;
  return of;
}();
constexpr Culprit culprit_of(std::size_t cause) { return kCulpritOf[cause]; }

}  // namespace

void WaitAttribution::restart_clock(std::uint64_t first_edge) {
  first_edge_ = first_edge;
  for (IssuedCommand& c : history_) c.at = ddr_.edge(std::max(c.clock, first_edge_));
  for (Baseline& b : baselines_) b.newest = Baseline::kNot;
}

/// Of the requests that became ready before `clock`, with no command since the newest.
[[gnu::noinline]] void WaitAttribution::take_baselines(std::uint64_t clock,
                                                       const QueueEntry* served) {
  const std::uint64_t newest = issued_ - 1;
  const IssuedCommand& c = command(newest);
  for (; have_baseline_ < queue_.count(); ++have_baseline_) {
    const QueueEntry& e = queue_.entry(have_baseline_);
    if (e.ready >= clock) break;
    if (e.request.write || &e == served) continue;
    Baseline& b = baselines_[queue_.slot_of(e)];
    const std::uint64_t ready = std::max(e.ready, first_edge_);
    if (issued_ == 0 || c.clock > ready) {
      b.newest = Baseline::kNot;
      continue;
    }
    for (std::size_t i = 0; i < totals_.size(); i += 2)
      store_pair(&b.totals[i], load_pair(&totals_[i]));
    b.newest = newest;
    b.totals[late_cause_] += late_.itself;
    const Division part = divide(c, ready, ddr_.edge(ready));
    b.totals[c.cause] += part.itself;
    b.totals[kTurned] += late_.turned + part.turned;
  }
  find_next_without_baseline();
}

/// Calls charge(culprit, time, end of it) for the waits since `c.ready`, which is at `from`, up to the column
/// command at `at`, by the commands one by one. The read's own ACT and PRE are no wait behind an earlier request.
/// What is remembered no more is `forgotten`.
template <class Charge>
[[gnu::always_inline]] inline void WaitAttribution::each_wait(const Column& c, Picoseconds from, Picoseconds at,
                                                              Culprit forgotten, Charge charge) const {
  const std::uint64_t end = c.commands;
  const std::uint64_t oldest = issued_ - std::min<std::uint64_t>(issued_, kHistory - 1);
  if (end <= oldest) return charge(forgotten, at - from, at);
  std::uint64_t n = end - 1;  // the last command at or before `ready`, or the oldest that is known
  while (n > oldest && command(n).clock > c.ready) --n;
  std::uint64_t prepared = 0;  // bit i: the command i before `end`
  Culprit row = Culprit::kRowMiss;
  for (std::uint64_t p = c.prepared; p > n; p = command(p - 1).before) {
    const IssuedCommand& own = command(p - 1);
    if (own.clock < c.ready) break;
    prepared |= std::uint64_t{1} << (end - p);
    if (own.cmd == Cmd::kPre) row = Culprit::kRowConflict;
  }
  std::uint64_t reached = c.ready;
  const auto until = [&](std::uint64_t next, Picoseconds to, Culprit culprit) {
    if (next <= reached) return;
    charge(culprit, to - from, to);
    reached = next;
    from = to;
  };
  until(command(n).clock, command(n).at, forgotten);
  for (; n < end; ++n) {
    const IssuedCommand& before = command(n);
    const bool newest = n + 1 == end;
    const std::uint64_t next = newest ? c.clock : command(n + 1).clock;
    const Picoseconds next_at = newest ? at : command(n + 1).at;
    if (before.cmd == Cmd::kWr) {
      const std::uint64_t over = std::min(next, before.clock + before.burst + write_clocks_);
      if (over > reached) until(over, ddr_.edge(over), culprit_of(before.cause));
      until(next, next_at, Culprit::kTurnaround);
    } else {
      until(next, next_at, prepared >> (end - n - 1) & 1u ? row : culprit_of(before.cause));
    }
  }
}

/// For a few commands, or where there is no baseline. What is not known is its own.
[[gnu::noinline]] void WaitAttribution::attribute_each(const QueueEntry& e, std::uint64_t ready, Picoseconds from,
                                                       std::uint64_t clock, Picoseconds at) {
  each_wait({ready, clock, e.prepared, issued_}, from, at, culprit(e.request.master),
            [&](Culprit c, Picoseconds t, Picoseconds) { charge(e.request, c, t); });
}

void WaitAttribution::tell(const Column& c, Picoseconds attributed, Picoseconds first, SlowRequest& s) const {
  // The clock has restarted since, while its data waited for older ones: edges have no times any more.
  if (c.clock < first_edge_) return s.until(first, RequestPlace::kController, Culprit::kCount);
  Column seen = c;
  seen.ready = std::max(c.ready, first_edge_);
  const std::uint64_t oldest = issued_ - std::min<std::uint64_t>(issued_, kHistory - 1);
  s.found = c.prepared == 0 ? FoundRow::kOpen : c.prepared > oldest ? FoundRow::kClosed : FoundRow::kNotKnown;
  for (std::uint64_t p = c.prepared; p > oldest; p = command(p - 1).before)
    if (command(p - 1).cmd == Cmd::kPre) s.found = FoundRow::kOther;
  const Picoseconds from = ddr_.edge(seen.ready);
  s.until(from, RequestPlace::kController, Culprit::kService);
  const Picoseconds time = seen.clock > seen.ready ? ddr_.edge(seen.clock) - from : 0;
  if (time)
    each_wait(seen, from, from + time, Culprit::kCount,
              [&](Culprit culprit, Picoseconds, Picoseconds to) { s.until(to, RequestPlace::kController, culprit); });
  s.until(first - (attributed - time), RequestPlace::kReturn, Culprit::kService);
  s.until(first, RequestPlace::kReturn, culprit(s.master));
}

/// The same by totals, however many commands there were. `newest`: what the newest one adds.
[[gnu::always_inline]] inline void WaitAttribution::attribute_by_totals(
    const QueueEntry& e, const Baseline& baseline, std::uint64_t ready, const Division& newest,
    Picoseconds at) {
  const std::uint64_t end = issued_;
  const std::uint64_t oldest = end - std::min<std::uint64_t>(end, kHistory - 1);
  Picoseconds row = 0;
  bool closed_other = false;
  for (std::uint64_t p = e.prepared; p > oldest; p = command(p - 1).before) {
    const IssuedCommand& c = command(p - 1);
    if (c.clock < ready) break;
    row += (p == end ? at : command(p).at) - c.at;
    closed_other |= c.cmd == Cmd::kPre;
  }
  Waits& w = waits[index(e.request.master)].read;
  std::optional<Waits> before;
  if (e.request.parts) before = w;
  w.add_masters(totals_.data(), baseline.totals.data());
  const auto since = [&](Cause c) { return totals_[c] - baseline.totals[c]; };
  const Picoseconds turned = since(kTurned), refreshed = since(kRefreshed), asleep = since(kAsleep);
  w.add(Culprit::kRefresh, refreshed);
  w.add(Culprit::kPowerDown, asleep);
  w.add(culprit_of(late_cause_), late_.itself);
  w.add(culprit_of(command(end - 1).cause), newest.itself);
  w.add(Culprit::kTurnaround, turned + late_.turned + newest.turned);
  w.take_back(culprit(e.request.master), row);
  w.add(closed_other ? Culprit::kRowConflict : Culprit::kRowMiss, row);
  if (!before) return;
  for (std::size_t c = 0; c < kCulprits; ++c)
    if (const Picoseconds t = w.ps[c] - before->ps[c])
      e.request.parts->add(static_cast<Culprit>(c), t);
}

[[gnu::noinline]] void WaitAttribution::attribute(const QueueEntry& e, std::uint64_t clock,
                                                  Picoseconds at, bool queued) {
  const std::uint64_t ready = std::max(e.ready, first_edge_);
  const Picoseconds from = ddr_.edge(ready);
  waited = at - from;
  if (issued_ == 0) return charge(e.request, culprit(e.request.master), waited);
  const IssuedCommand& last = newest();
  if (last.clock <= ready) {
    const bool own_act = last.clock == ready && e.prepared == issued_;
    const Division before = divide(last, ready, from), all = divide(last, clock, at);
    charge(e.request, own_act ? Culprit::kRowMiss : culprit_of(last.cause),
           all.itself - before.itself);
    if (all.turned) charge(e.request, Culprit::kTurnaround, all.turned - before.turned);
    return;
  }
  const std::uint64_t oldest = issued_ - std::min<std::uint64_t>(issued_, kHistory - 1);
  if (queued) {
    const Baseline& baseline = baselines_[queue_.slot_of(e)];
    if (baseline.newest != Baseline::kNot && baseline.newest >= oldest)
      return attribute_by_totals(e, baseline, ready, divide(last, clock, at), at);
  }
  attribute_each(e, ready, from, clock, at);
}

}  // namespace fovea::mem
