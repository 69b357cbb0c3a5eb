// An EDMA3 transfer controller: reads and writes of one request after the other, with a data FIFO
// between them. Knows no SystemC. Structure: SPRUH82C, sections "EDMA3 Transfer Controller"; sizes and
// clocks are parameters of the owner.
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "model/common/units.h"
#include "model/dma/core/commands.h"
#include "model/dma/core/register_set.h"
#include "model/dma/core/transfer_request.h"

namespace fovea::dma {

/// A request passes the program register, the source active register (while its reads are issued) and
/// a destination register (until its last write is acknowledged). Reads of the next request may thus
/// begin while the writes of this one are under way. A read is issued when the data FIFO has room for
/// all of its bytes; a write when all of its bytes have arrived. The bytes of a write leave the FIFO
/// with its acknowledgement.
///
/// All times are given by the caller or computed from them: the controller never asks for the present
/// time, so outcomes may be reported to it as soon as they are decided.
class TransferController {
 public:
  enum class Failure : std::uint8_t {
    kNone,
    kRead,     ///< nobody answered a read
    kWrite,    ///< nobody answered a write
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

  bool source_active() const { return source_.has_value(); }
  std::size_t destinations() const { return destinations_.size(); }
  /// The register sets, as far as is decided: a read or a write counts from when its time is known,
  /// which may be a few clocks ahead. A set keeps its request when that has left.
  RegisterSet program_set() const { return {programmed_, programmed_.bytes()}; }
  RegisterSet source_set() const { return {read_, source_ ? source_->reads.bytes() : 0}; }
  /// @param n number of the destination register, below Sizes::depth
  RegisterSet destination_set(unsigned n) const;
  /// The destination register of the oldest request, or of the next one if there is none.
  unsigned destination_head() const { return head_; }
  /// The destination register whose writes are being issued, or else the one whose were issued last.
  unsigned destination_writing() const;

  bool idle() const { return !program_ && !source_ && destinations_.empty(); }
  /// Time up to `now`, since start_count(), in which there was a request: from its entry into the program register to
  /// the acknowledgement of the last write. What a reset cuts off does not count.
  Picoseconds busy(Picoseconds now) const { return busy_ + (idle() ? 0 : now - busy_since_); }
  void start_count(Picoseconds now) {
    busy_ = 0;
    busy_since_ = now;
  }

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
  Destination* writing();

  Host& host_;
  Sizes sizes_;
  std::optional<TransferRequest> program_;
  Picoseconds program_at_ = 0;
  std::optional<Source> source_;
  Picoseconds source_free_ = 0;
  std::deque<Destination> destinations_;
  TransferRequest programmed_, read_;       // the latest of the program register and the source active
  std::vector<TransferRequest> written_;    // by destination register
  unsigned head_ = 0;                       // destination register of destinations_.front()
  std::deque<Write> writes_;            // under way
  std::deque<std::uint8_t> data_;       // arrived, not yet written
  Supply registers_, room_, arrived_;   // destination registers, bytes of the FIFO, bytes in it
  Picoseconds next_read_ = 0, next_write_ = 0;
  unsigned read_interval_ = 1;
  Picoseconds busy_ = 0, busy_since_ = 0;  // of the time that is over; of the present
};

}  // namespace fovea::dma
