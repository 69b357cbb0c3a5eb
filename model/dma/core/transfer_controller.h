// An EDMA3 transfer controller: reads and writes of one request after the other, with a data FIFO
// between them. Knows no SystemC. Structure: SPRUH82C, sections "EDMA3 Transfer Controller"; sizes and
// clocks are parameters of the owner.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "model/common/masters.h"
#include "model/common/units.h"
#include "model/dma/core/commands.h"
#include "model/dma/core/register_set.h"
#include "model/common/transfer_request.h"

namespace fovea::dma {

/// A request passes the program register, the source active register (while its reads are issued) and
/// a destination register (until its last write is acknowledged). Reads of the next request may thus
/// begin while the writes of this one are under way. A read is issued when the data FIFO has room for
/// all of its bytes; a write when all of its bytes have arrived. The bytes of a write leave the FIFO
/// with its acknowledgement.
///
/// All times are given by the caller or computed from them: the controller never asks for the present
/// time, so outcomes may be reported to it as soon as they are decided, ahead of their times. Its state
/// may thus lie ahead of the present. What software sees is asked for at a time: kNever stands for the
/// end of all that is decided, any other time must be the present.
class TransferController {
 public:
  enum class Failure : std::uint8_t {
    kNone,
    kRead,     ///< no slave answered a read
    kWrite,    ///< no slave answered a write
    kRequest,  ///< constant addressing with an address or an index that is no multiple of 32
  };

  class Host {
   public:
    virtual ~Host() = default;
    /// The edge of the controller's clock that is `clocks` after the first one at or after `t`.
    virtual Picoseconds edge(Picoseconds t, unsigned clocks) const = 0;
    /// From when on the port takes another read or write; kNever if that is not known yet.
    virtual Picoseconds read_free() const = 0;
    virtual Picoseconds write_free() const = 0;
    virtual void read(Command burst, Picoseconds at) = 0;
    virtual void write(Command burst, std::span<const std::uint8_t> data, Picoseconds at) = 0;
    /// The program register is free from `at` on.
    virtual void program_free(Picoseconds at) = 0;
    /// The last write of a request is acknowledged at `at`.
    virtual void completed(const TransferRequest& request, Picoseconds at) = 0;
    virtual void failed(const TransferRequest& request, Failure failure, Picoseconds at) = 0;
  };

  struct Sizes {
    unsigned burst = 32;       ///< default burst size: 16, 32 or 64 bytes
    unsigned fifo = 128;       ///< data FIFO, bytes; at least two bursts (see set_burst())
    unsigned depth = 4;        ///< destination registers
  };

  TransferController(Host& host, Sizes sizes);
  TransferController(const TransferController&) = delete;
  TransferController& operator=(const TransferController&) = delete;

  /// The default burst size of requests that are loaded from now on. The FIFO must hold two bursts: with
  /// less, it could contain a part of the next write and lack the room for the next read, if source and
  /// destination are aligned differently.
  void set_burst(unsigned bytes);
  /// Clocks between two reads (RDRATE); 1: as fast as possible.
  void set_read_interval(unsigned clocks) { read_interval_ = clocks; }
  bool program_busy() const { return program_.has_value(); }
  /// Puts a request into the program register, which must be free.
  void submit(const TransferRequest& request, Picoseconds at);
  /// Outcomes, in the order in which the bursts were issued.
  void read_done(std::span<const std::uint8_t> data, bool error, Picoseconds at);
  void write_done(bool error, Picoseconds at);
  /// Goes on at `now`, after a time in which the port took nothing.
  void resume(Picoseconds now) {
    next_read_ = std::max(next_read_, now);
    next_write_ = std::max(next_write_, now);
    advance();
  }
  /// Forgets everything; bursts under way must have ended.
  void reset();

  /// The state at `now`. A request is in the program register until it is loaded; the source active
  /// reads until its last read is on its port.
  bool program_taken(Picoseconds now) const { return program_ || loaded_at_ > now; }
  bool source_active(Picoseconds now = kNever) const { return source_set(now).left > 0; }
  /// Requests since the reset that have left the program register, and those that have ended.
  std::uint64_t loaded(Picoseconds now) const { return loaded_ - (loaded_at_ > now); }
  std::uint64_t ended(Picoseconds now) const { return ends_.count(now); }
  /// A write is on its port whose acknowledgement has not arrived.
  bool writing(Picoseconds now) const;
  std::size_t destinations(Picoseconds now = kNever) const {
    return static_cast<std::size_t>(loaded(now) - ended(now));
  }
  /// The register sets: a read or a write counts from when it is put on its port. A set keeps its
  /// request when that has left.
  RegisterSet program_set() const { return {programmed_, programmed_.bytes()}; }
  RegisterSet source_set(Picoseconds now = kNever) const;
  /// @param n number of the destination register, below Sizes::depth
  RegisterSet destination_set(unsigned n, Picoseconds now = kNever) const;
  /// The destination register of the oldest request, or of the next one if there is none.
  unsigned destination_head(Picoseconds now = kNever) const {
    return static_cast<unsigned>(ended(now) % sizes_.depth);
  }
  /// The destination register whose writes are being issued, or else the one whose were issued last.
  unsigned destination_writing(Picoseconds now = kNever) const;

  bool idle() const { return !program_ && !source_ && destinations_.empty(); }
  /// Time up to `now`, since start_count(), in which there was a request: from its entry into the program
  /// register to the acknowledgement of the last write. What a reset cuts off does not count. `now` may lie
  /// before the end of the latest request, but not before a call to submit().
  Picoseconds busy(Picoseconds now) const;
  void start_count(Picoseconds now);

 private:
  struct Source {
    TransferRequest request;
    Commands reads;
  };
  struct Destination {
    TransferRequest request;
    Commands writes;
    std::uint32_t to_arrive;  // bytes
  };
  struct Write {
    unsigned bytes;
    bool last;  // of its request
  };
  /// The latest of a kind of happenings, as their times may lie ahead of the present. Of bursts under way
  /// there are no more than a port has places, of ends no more than there are destination registers.
  class Recent {
   public:
    struct Entry {
      Picoseconds at = 0;
      std::uint64_t request = 0;  ///< number of the request, from 0
      unsigned bytes = 0;
    };
    void add(Entry e) { entries_[count_++ % entries_.size()] = e; }
    std::uint64_t count() const { return count_; }
    /// How many came up to `now`.
    std::uint64_t count(Picoseconds now) const {
      std::uint64_t n = count_;
      for (const Entry& e : entries_) n -= e.at > now;
      return n;
    }
    /// Bytes of a request that are still to come after `now`.
    std::uint32_t bytes_after(Picoseconds now, std::uint64_t request) const {
      std::uint32_t sum = 0;
      for (const Entry& e : entries_)
        if (e.at > now && e.request == request) sum += e.bytes;
      return sum;
    }

   private:
    std::array<Entry, kMostOutstanding> entries_{};
    std::uint64_t count_ = 0;
  };
  /// Something that becomes available in pieces, each at its time, and is used in that order.
  class Supply {
   public:
    void add(unsigned amount, Picoseconds at);
    unsigned amount() const { return amount_; }
    /// Takes `amount`, which must be there; returns when the last of it is available.
    Picoseconds take(unsigned amount);

   private:
    struct Piece {
      unsigned amount;
      Picoseconds at;
    };
    std::deque<Piece> pieces_;
    unsigned amount_ = 0;
  };

  void advance();
  bool load();
  bool issue_read();
  bool issue_write();
  std::size_t oldest_to_write() const;
  std::uint32_t left_to_write(std::uint64_t request, Picoseconds now) const;

  Host& host_;
  Sizes sizes_;
  std::optional<TransferRequest> program_;
  Picoseconds program_at_ = 0;
  std::optional<Source> source_;
  Picoseconds source_free_ = 0;
  std::deque<Destination> destinations_;
  /// Requests are numbered as they are loaded; number n has the destination register n % depth. At most one
  /// was loaded ahead of the present, as the next one enters the program register in the present.
  std::uint64_t loaded_ = 0;
  Picoseconds loaded_at_ = 0;                   // the latest
  TransferRequest programmed_, read_;           // the latest of the program register and the source active
  TransferRequest read_before_, written_before_;  // what the latest one that was loaded has replaced
  std::vector<TransferRequest> written_;        // by destination register
  Recent reads_, written_bursts_, acknowledged_, ends_;
  std::deque<Write> writes_;            // under way
  std::deque<std::uint8_t> data_;       // arrived, not yet written
  Supply registers_, room_, arrived_;   // destination registers, bytes of the FIFO, bytes in it
  Picoseconds next_read_ = 0, next_write_ = 0;
  unsigned read_interval_ = 1;
  Picoseconds busy_ = 0;                   // up to busy_since_ or, when idle, busy_until_
  Picoseconds busy_since_ = 0, busy_until_ = 0;
};

}  // namespace fovea::dma
