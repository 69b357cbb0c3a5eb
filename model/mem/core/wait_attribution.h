// Who or what a read waited for in the controller, between the pipeline's end and its first column
// command.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "model/common/clock.h"
#include "model/common/slow_request.h"
#include "model/common/waits.h"
#include "model/mem/core/command_queue.h"
#include "model/mem/core/ddr_timing.h"

namespace fovea::mem {

/// Each clock is attributed to the last command before it: another master's, a refresh, or the read's own
/// ACT or PRE. From the end of a write burst on it is the turnaround. The column commands of one request
/// are one command here, since nothing comes between them.
///
/// Running totals by cause are kept as commands are issued. A read's waits are the difference of two
/// readings: its baseline, taken when it became ready, and the totals at its first column command.
class WaitAttribution {
 public:
  /// Cause recorded with each command: the master it served, or one of these.
  enum Cause : std::uint8_t { kTurned = kMasterCount, kRefreshed, kAsleep, kCauses };
  struct alignas(32) IssuedCommand {
    std::uint64_t clock = 0;
    Picoseconds at = 0;        // of that clock; before a clock's restart: the restart
    std::uint64_t before = 0;  // the ACT or PRE of the same request before it, as QueueEntry::prepared
    std::uint8_t burst = 0;    // clocks to the last column command of the same request
    Cmd cmd = Cmd::kRef;
    std::uint8_t cause = kRefreshed;
  };
  static constexpr std::size_t kHistory = 64;  // commands that are remembered
  /// A read at its first column command; tell() finds from this what the read waited for.
  struct Column {
    std::uint64_t ready = 0, clock = 0;  ///< edges: the scheduler saw it, the command
    std::uint64_t prepared = 0;          ///< as QueueEntry::prepared
    std::uint64_t commands = 0;          ///< before this one
  };

  /// Both refer to the controller's own.
  WaitAttribution(const Clock& ddr, const CommandQueue& queue) : ddr_(ddr), queue_(queue) {}

  /// From a WR to the end of its data, in clocks.
  void set_write_clocks(unsigned clocks) { write_clocks_ = clocks; }
  /// The clock has restarted: edges before this one have no times any more.
  void restart_clock(std::uint64_t first_edge);

  /// Adds a command; the caller fills in `cmd`, `cause`, `before` and `burst`. `served`: the request whose
  /// column command it is.
  IssuedCommand& add(std::uint64_t clock, Picoseconds at, const QueueEntry* served = nullptr);
  std::uint64_t count() const { return issued_; }
  IssuedCommand& newest() { return command(issued_ - 1); }
  const IssuedCommand& newest() const { return command(issued_ - 1); }

  /// The queue begins with the request in slot 0, ready at this edge.
  void begin_queue(std::uint64_t ready) {
    baselines_[0].newest = Baseline::kNot;  // commands since then were not looked at
    have_baseline_ = 0;
    next_without_baseline_ = ready;
  }
  /// A request has joined the queue at this position; or one has left it from there.
  void joined(unsigned position, std::uint64_t ready) {
    if (have_baseline_ == position) next_without_baseline_ = ready;
  }
  void left(unsigned position) {
    if (position < have_baseline_)
      --have_baseline_;
    else
      find_next_without_baseline();
  }

  /// The waits of a read whose first column command is issued now, at `clock`, since it became ready.
  /// `queued`: it is in the queue, and may have a baseline.
  void attribute(const QueueEntry& e, std::uint64_t clock, Picoseconds at, bool queued);
  void charge(const QueuedRequest& r, Culprit c, Picoseconds t) {
    waits[index(r.master)].read.add(c, t);
    if (r.parts) r.parts->add(c, t);
  }

  /// How the read found its row, and its steps up to `first`, when its data are on the crossbar, out of what is
  /// remembered now. `attributed`: its wait up to the column command, and behind older reads on the way back.
  void tell(const Column& c, Picoseconds attributed, Picoseconds first, SlowRequest& s) const;

  WaitTable waits;
  /// Sum of the waits of the read that was attributed last.
  Picoseconds waited = 0;

 private:
  static constexpr std::uint64_t kNoClock = ~std::uint64_t{0};
  using Totals = std::array<Picoseconds, (kCauses + 1) / 2 * 2>;  // two make a wide word of the host
  /// How the time behind a command divides: the command itself, and the turnaround behind a write.
  struct Division {
    Picoseconds itself = 0, turned = 0;
  };
  struct Baseline {
    static constexpr std::uint64_t kNot = ~std::uint64_t{0};
    Totals totals;
    std::uint64_t newest = kNot;  // command before; kNot: the totals are not known
  };

  IssuedCommand& command(std::uint64_t n) { return history_[n % kHistory]; }
  const IssuedCommand& command(std::uint64_t n) const { return history_[n % kHistory]; }
  void take_baselines(std::uint64_t clock, const QueueEntry* served);
  void find_next_without_baseline() {
    next_without_baseline_ =
        have_baseline_ < queue_.count() ? queue_.entry(have_baseline_).ready : kNoClock;
  }
  Division divide(const IssuedCommand& c, std::uint64_t clock, Picoseconds at) const;
  void attribute_each(const QueueEntry& e, std::uint64_t ready, Picoseconds from,
                      std::uint64_t clock, Picoseconds at);
  template <class Charge>
  void each_wait(const Column& c, Picoseconds from, Picoseconds at, Culprit forgotten, Charge charge) const;
  void attribute_by_totals(const QueueEntry& e, const Baseline& baseline, std::uint64_t ready,
                           const Division& newest, Picoseconds at);

  const Clock& ddr_;
  const CommandQueue& queue_;
  std::uint64_t first_edge_ = 0;  // of the DDR clock since its last restart
  unsigned write_clocks_ = 0;
  std::array<IssuedCommand, kHistory> history_;
  std::uint64_t issued_ = 0;
  // Totals over the commands before the newest but one, and what that one adds; commands that came while
  // no read had a baseline are left out. A total just changed and read with its neighbours would hold up
  // the host.
  Totals totals_{};
  Division late_;
  std::uint8_t late_cause_ = 0;
  std::array<Baseline, CommandQueue::kMost> baselines_;  // by slot
  unsigned have_baseline_ = 0;                      // positions that have theirs
  std::uint64_t next_without_baseline_ = kNoClock;  // edge at which the one after them is ready
};

/// How the time from a command up to `clock` divides.
[[gnu::always_inline]] inline WaitAttribution::Division WaitAttribution::divide(
    const IssuedCommand& c, std::uint64_t clock, Picoseconds at) const {
  if (c.cmd == Cmd::kWr) {
    const std::uint64_t over = c.clock + c.burst + write_clocks_;
    if (over < clock) {
      const Picoseconds end = ddr_.edge(std::max(over, first_edge_));
      return {end - c.at, at - end};
    }
  }
  return {at - c.at, 0};
}

[[gnu::always_inline]] inline WaitAttribution::IssuedCommand& WaitAttribution::add(
    std::uint64_t clock, Picoseconds at, const QueueEntry* served) {
  if (clock > next_without_baseline_) take_baselines(clock, served);
  const std::uint64_t n = issued_++;
  if (have_baseline_ != 0) {
    totals_[late_cause_] += late_.itself;
    totals_[kTurned] += late_.turned;
    const IssuedCommand& before = command(n - 1);
    late_ = n ? divide(before, clock, at) : Division{};
    late_cause_ = before.cause;
  }
  IssuedCommand& c = command(n);
  c.clock = clock;
  c.at = at;
  return c;
}

}  // namespace fovea::mem
