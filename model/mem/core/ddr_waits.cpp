// Who or what a read waited for in the controller.
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {

/// After another clock: edges before its restart have no times any more.
void DdrController::time_given() {
  for (Given& g : given_) g.at = ddr_.edge(std::max(g.clock, first_edge_));
}

/// Brings blames_ up to the newest command.
void DdrController::sum_given() {
  // A whole row is written from the one before, as masked words: one word changed and then read back
  // with its neighbours would hold up the host.
  static constexpr auto kOnly = [] {
    std::array<Blames, kBlames> only{};
    for (std::size_t i = 0; i < kBlames; ++i) only[i][i] = ~Picoseconds{0};
    return only;
  }();
  if (given_count_ - summed_ > kGiven) summed_ = given_count_ - kGiven;
  if (summed_ + 1 >= given_count_) return;
  const std::uint64_t write = config_.timing.WL() + DdrTiming::kBurstClocks;
  for (Picoseconds from = given(summed_).at; summed_ + 1 < given_count_; ++summed_) {
    const Given& g = given(summed_);
    const std::uint64_t next = given(summed_ + 1).clock;
    const Picoseconds to = given(summed_ + 1).at;
    const Blames& before = blames_[summed_ % kGiven];
    Blames& after = blames_[(summed_ + 1) % kGiven];
    const Blames& only = kOnly[g.blame];
    if (g.cmd == Cmd::kWr && g.clock + write < next) [[unlikely]] {
      const Picoseconds over = ddr_.edge(std::max(g.clock + write, first_edge_));
      for (std::size_t i = 0; i < before.size(); ++i)
        after[i] = before[i] + (only[i] & (over - from)) + (kOnly[kTurned][i] & (to - over));
    } else {
      const PairOfSums passed = {to - from, to - from};
      for (std::size_t i = 0; i < before.size(); i += 2)
        pair(&after[i]) = pair(&before[i]) + (pair(&only[i]) & passed);
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

/// Of a DdrController::Blame.
constexpr Culprit culprit_of(std::size_t blame) {
  constexpr std::array kRest = {Culprit::kTurnaround, Culprit::kRefresh, Culprit::kPowerDown};
  return blame < kMasterCount ? static_cast<Culprit>(blame) : kRest[blame - kMasterCount];
}

/// The waits since `ready`, by the commands from the n-th on, one by one. Its own ACT and PRE are no
/// wait behind an earlier request.
inline void DdrController::blame_each(const Entry& e, std::uint64_t n, std::uint64_t ready) {
  const Culprit own = culprit(e.request.master);
  const std::uint64_t last = given_count_ - 1;
  std::uint32_t prepared = 0;  // bit i: the command i before the newest
  Culprit row = Culprit::kRowMiss;
  for (std::uint64_t p = e.prepared; p > n; p = given(p - 1).before) {
    const Given& g = given(p - 1);
    if (g.clock < ready) break;
    prepared |= 1u << (last - (p - 1));
    if (g.cmd == Cmd::kPre) row = Culprit::kRowConflict;
  }
  std::uint64_t at = ready;
  Picoseconds from = ddr_.edge(at);
  const auto until = [&](std::uint64_t clock, Picoseconds to, Culprit c) {
    if (clock <= at) return;
    charge(e, c, to - from);
    at = clock;
    from = to;
  };
  until(given(n).clock, given(n).at, own);  // what is not known is its own
  for (; n < last; ++n) {
    const Given& g = given(n);
    const Given& next = given(n + 1);
    if (g.cmd == Cmd::kWr) {
      const std::uint64_t over =
          std::min(next.clock, g.clock + config_.timing.WL() + DdrTiming::kBurstClocks);
      if (over > at) until(over, ddr_.edge(over), culprit_of(g.blame));
      until(next.clock, next.at, Culprit::kTurnaround);
    } else {
      until(next.clock, next.at, prepared >> (last - n) & 1u ? row : culprit_of(g.blame));
    }
  }
}

/// The same by sums, for long waits among many commands.
inline void DdrController::blame_sums(Waits& w, std::uint64_t n, std::uint64_t ready, Culprit own) {
  const std::uint64_t last = given_count_ - 1;
  const Picoseconds start = ddr_.edge(ready);
  sum_given();
  const Blames &before = blames_[n % kGiven], &now = blames_[last % kGiven];
  w.add_masters(now.data(), before.data());
  for (std::size_t i = kMasterCount; i < kBlames; ++i) w.add(culprit_of(i), now[i] - before[i]);
  const Given& first = given(n);
  if (first.clock > ready) {  // what is not known is its own
    w.add(own, first.at - start);
  } else if (first.clock < ready) {  // without the part before `ready`
    Picoseconds until = start;
    if (first.cmd == Cmd::kWr) {
      const std::uint64_t over = first.clock + config_.timing.WL() + DdrTiming::kBurstClocks;
      if (over < ready) until = ddr_.edge(std::max(over, first_edge_));
      w.take_back(Culprit::kTurnaround, start - until);
    }
    w.take_back(culprit_of(first.blame), until - first.at);
  }
}

[[gnu::noinline]] void DdrController::blame_many(const Entry& e, std::uint64_t n,
                                                 std::uint64_t ready) {
  const Culprit own = culprit(e.request.master);
  Waits w;
  blame_sums(w, n, ready, own);
  // Its own ACT and PRE are no wait behind an earlier request.
  const std::uint64_t last = given_count_ - 1;
  const std::uint64_t oldest = last - std::min<std::uint64_t>(last, kGiven - 1);
  Picoseconds row = 0;
  bool closed_other = false;
  for (std::uint64_t p = e.prepared; p > oldest; p = given(p - 1).before) {
    const Given& g = given(p - 1);
    if (g.clock < ready) break;
    row += given(p).at - g.at;
    closed_other |= g.cmd == Cmd::kPre;
  }
  w.take_back(own, row);
  w.add(closed_other ? Culprit::kRowConflict : Culprit::kRowMiss, row);
  charge_read(e, w);
}

/// The waits of a read whose first column command, already noted, is given at `clock`, since it
/// became ready.
[[gnu::noinline]] void DdrController::attribute(const Entry& e, std::uint64_t clock) {
  const std::uint64_t ready = std::max(e.ready, first_edge_);
  read_waited_ = next_ - ddr_.edge(ready);
  // The last command at or before `ready`, or the oldest one that is known.
  const std::uint64_t last = given_count_ - 1;
  const std::uint64_t oldest = last - std::min<std::uint64_t>(last, kGiven - 1);
  std::uint64_t n = std::max(e.given - (e.given != 0), oldest);
  while (n > oldest && given(n).clock > ready) --n;
  while (n + 1 < last && given(n + 1).clock <= ready) ++n;
  if (n == last) return charge(e, culprit(e.request.master), read_waited_);  // nothing before it
  if (alone_) summed_ = std::max(summed_, n);  // later requests ask for later commands
  constexpr std::uint64_t kFewCommands = 8;
  if (last - n <= kFewCommands)
    blame_each(e, n, ready);
  else
    blame_many(e, n, ready);
}

}  // namespace fovea::mem
