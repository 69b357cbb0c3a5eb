// When the data of reads return to the crossbar, and in which order these outcomes are reported.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/common/clock.h"
#include "model/common/masters.h"
#include "model/mem/core/queue_entry.h"
#include "model/mem/core/return_channel.h"
#include "model/mem/core/wait_attribution.h"

namespace fovea::mem {

/// A read whose data is on the crossbar from `first` (its first 8 bytes) to `last`; both lie ahead.
struct ReadOutcome {
  MemRequest* request;
  Picoseconds first, last;
  Picoseconds attributed;  ///< the part of its time that the attribution of waits explains
  WaitAttribution::Column column;
};

/// The outcomes of one step of the controller, in their order: mostly one.
class ReadOutcomes {
 public:
  void add(const ReadOutcome& r) {
    if (count_ == list_.size()) [[unlikely]]
      list_.resize(2 * count_);
    list_[count_++] = r;
  }
  void clear() { count_ = 0; }
  std::size_t size() const { return count_; }
  const ReadOutcome* begin() const { return list_.data(); }
  const ReadOutcome* end() const { return list_.data() + count_; }

 private:
  std::vector<ReadOutcome> list_ = std::vector<ReadOutcome>(8);
  std::size_t count_ = 0;
};

/// The return channel and, behind it, the order of reporting: a master sees its reads end in the order of
/// their issue. A scheduler that lets them pass each other needs a buffer here for data that came before
/// those of older reads; it is as large as what the masters have under way.
class ReadReturn {
 public:
  ReadReturn(const Clock& ddr, const Clock& crossbar, WaitAttribution& attribution)
      : ddr_(ddr), crossbar_(crossbar), attribution_(attribution) {}

  /// Reads of one master may get their data in another order than that of their issue.
  void set_reorders(bool reorders) { reorders_ = reorders; }
  bool reorders() const { return reorders_; }
  ReturnChannel& channel() { return channel_; }
  /// First DDR clock at which a RD finds room for its data.
  std::uint64_t room() const { return channel_.room(); }

  /// When the data of a read come whose first column command is issued at `clock`; the others follow
  /// without a gap.
  [[gnu::always_inline]] ReturnChannel::Span send(const QueueEntry& e, std::uint64_t clock) {
    return channel_.take(e.request.bytes, e.chunks, clock, ddr_, crossbar_);
  }
  /// The same for a scheduler that reorders reads. The outcome is reported when those of the master's
  /// older reads are, which are in `older_slots` of the queue; then follow the younger ones that waited
  /// only for this one.
  void send_in_order(const QueueEntry& e, std::uint32_t slot, std::uint32_t older_slots,
                     const WaitAttribution::Column& column, ReadOutcomes& outcomes);
  /// The newest read that waits for the queue's read in this slot; null: none does.
  const MemRequest* newest_behind(unsigned slot) const;

  /// A read whose data came before those of older reads of its master.
  struct OutOfOrderRead {
    QueuedRequest request;
    std::uint32_t behind = 0;  ///< slots of the older reads
    Picoseconds first = 0;     ///< its own data on the return channel
    std::uint64_t edges = 0;   ///< of the crossbar, from there to the last
    Picoseconds waited = 0;
    WaitAttribution::Column column;
  };
  /// Each master's oldest first.
  const std::vector<OutOfOrderRead>& waiting() const { return waiting_; }

 private:
  void report(const OutOfOrderRead& h, ReadOutcomes& outcomes);
  /// The clock whose edges bring the data.
  const Clock& clock() const { return channel_.left_out() ? ddr_ : crossbar_; }

  const Clock& ddr_;
  const Clock& crossbar_;
  WaitAttribution& attribution_;
  ReturnChannel channel_;
  bool reorders_ = false;
  std::vector<OutOfOrderRead> waiting_;
  std::array<Picoseconds, kMasterCount> reported_until_{};  // ends of the masters' newest reads
};

}  // namespace fovea::mem
