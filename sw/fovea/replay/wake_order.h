// The core's records of a trace in the order in which interrupts wake it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>

#include "model/trace/core/trace.h"

namespace fovea::app {

/// A trace holds what the core did after each sleep in the order of the recorded run. With other settings the end of
/// a transfer may wake the core before a frame's interrupt that came first when the trace was recorded, or after one
/// that came later. So the records from one sleep to the next are a block, and of the first block that an interrupt at
/// a recorded time begins and the first one that a transfer's begins that one goes on which is woken first.
class WakeOrder {
 public:
  struct Numbered {
    trace::Record record;
    std::uint64_t number = 0;  // in the trace
  };
  struct Choice {
    Numbered first;        ///< of the block
    bool settled = true;   ///< false: only if the other's interrupt has not come before
    std::uint8_t awaited = trace::kInterrupt;  ///< not settled: the stream that the other waits for
  };
  /// When what a record waits for comes; kNever while that is not known.
  using Time = std::function<Picoseconds(const trace::Record&)>;

  WakeOrder(trace::RecordSource& source, unsigned stream, const trace::TraceInfo& info)
      : source_(source), info_(info), stream_(stream) {}

  /// False: the core sleeps, or the trace is at its end.
  bool next(Numbered& out);
  bool asleep() const { return !ahead_.empty(); }
  /// While asleep: which block goes on.
  Choice choose(const Time& time);
  /// While asleep: no transfer in the trace will wake the core any more.
  bool transfers_done() const { return at_end_ && first(true) == ahead_.size(); }
  /// When the latest transfer of those that woke it did so in the recorded run.
  Picoseconds latest_transfer() const { return latest_transfer_; }
  /// The first record of the chosen block has been played.
  void take();

 private:
  using Block = std::deque<Numbered>;
  /// So many records are looked through for a block that another kind of interrupt begins.
  static constexpr std::size_t kMostAhead = 4096;

  bool read(Numbered& out);
  static bool wakes(const trace::Record& r) {
    return r.release == trace::Release::kWhen && r.source == trace::kInterrupt;
  }
  bool by_transfer(const trace::Record& r) const { return info_.interrupts[r.event].source != trace::kInterrupt; }
  /// @return index in ahead_; its size: there is none
  std::size_t first(bool transfer) const;
  void read_ahead();

  trace::RecordSource& source_;
  const trace::TraceInfo& info_;
  unsigned stream_;
  std::uint64_t numbers_ = 0;
  Block running_;            // what has been read of the block that is played
  bool more_ = true;         // the rest of it is still in the source
  std::deque<Block> ahead_;  // that follow, in the order of the trace
  std::size_t records_ahead_ = 0, chosen_ = 0;
  bool at_end_ = false;
  Picoseconds latest_transfer_ = 0;
};

}  // namespace fovea::app
