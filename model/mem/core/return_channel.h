// The return channel: how a read's data come back through PHY and read FIFO to the crossbar, 64 bits a
// clock, in the order in which the SDRAM sends them. Without it data are there when the SDRAM has sent
// them.
#pragma once
#include <algorithm>
#include <cstdint>

#include "model/common/clock.h"
#include "model/mem/core/ddr_timing.h"

namespace fovea::mem {

class ReturnChannel {
 public:
  /// `latency`: DDR clocks from a RD to its first beat at the crossbar's side.
  void set_latency(unsigned latency) { latency_ = latency; }
  void set_fifo(unsigned bytes) { spare_words_ = bytes / 8u - 8u; }
  void leave_out() { left_out_ = true; }
  bool left_out() const { return left_out_; }
  /// The crossbar's clock starts at this edge: nothing waits for the channel.
  void start(std::uint64_t edge) { start_ = edge; }
  /// First DDR clock at which a RD finds room for its data in the FIFO.
  std::uint64_t room() const { return room_; }

  struct Span {
    Picoseconds first, last;
  };
  /// A read whose first column command is issued at `clock`; the others follow without a gap.
  [[gnu::always_inline]] Span take(unsigned bytes, unsigned chunks, std::uint64_t clock,
                                   const Clock& ddr, const Clock& crossbar) {
    constexpr std::uint64_t kHead = DdrTiming::kBurstClocks / 2;  // 8 bytes: 4 beats
    if (left_out_) [[unlikely]] {
      const std::uint64_t tail = bytes > 8 || chunks > 1 ? chunks * DdrTiming::kBurstClocks : kHead;
      return {ddr.edge(clock + latency_ + kHead), ddr.edge(clock + latency_ + tail)};
    }
    const std::uint64_t arrival = crossbar.edge_after(ddr.edge(clock + latency_ + kHead));
    const std::uint64_t words = (bytes + 7u) / 8u;
    const std::uint64_t first = std::max(arrival, free_);
    std::uint64_t last = first;
    if (words > 1 || chunks > 1) {
      const std::uint64_t tail = clock + latency_ + chunks * DdrTiming::kBurstClocks;
      last = std::max(first + words - 1, crossbar.edge_after(ddr.edge(tail)));
    }
    free_ = last + 1;
    // Scheduling rule 3: the FIFO is full while another 64 bytes would not fit beside the words
    // that wait for the channel when their data comes. It can only fill if the channel is slower than the
    // DDR bus. Words that the channel has taken by the next read's data, at or after `arrival`, do not
    // count.
    if (free_ > start_ + spare_words_ && free_ - spare_words_ >= arrival) {
      const std::uint64_t room = ddr.edge_at_or_after(crossbar.edge(free_ - spare_words_));
      const std::uint64_t lead = latency_ + kHead;  // from a RD to its data
      room_ = room > lead ? room - lead : 0;
    }
    return {crossbar.edge(first), crossbar.edge(last)};
  }

 private:
  unsigned latency_ = 0;
  std::uint64_t spare_words_ = 0;
  std::uint64_t start_ = 0, free_ = 0;  // crossbar edges
  std::uint64_t room_ = 0;
  bool left_out_ = false;
};

}  // namespace fovea::mem
