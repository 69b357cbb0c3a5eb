// The memory side of an AXI4 port with 64 bits: requests on wires become requests to a memory port, whose answers
// come back on wires. Knows neither SystemC nor Verilator.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "model/common/mem_request.h"
#include "model/engine/rtl/axi_wires.h"

namespace fovea::rtl {

/// Times: what comes from memory at t is on the wires at the first clock edge strictly after t, and a
/// slot of the memory port that is free from t on is used at edges strictly after t (decision 0001). So
/// it does not matter whether an answer is reported ahead of its time or at it.
///
/// - A burst on AR is one request. Its beats come as they reach the memory port, one a clock at most;
///   beats of one identifier in the order of its requests, the oldest request first.
/// - A burst on AW is handed over when all its data are there: one request for each run of bytes that
///   its strobes leave, in the order of addresses. It is answered when all of them are.
/// - Back-pressure: ARREADY and AWREADY are low while requests wait for a slot of the memory port, and
///   AWREADY while kWrites bursts are unanswered.
/// - An access to an address that no slave answers gets DECERR.
class AxiMemory {
 public:
  struct Burst {
    std::uint64_t tag = 0;
    bool write = false;
    unsigned id = 0;
    std::uint32_t address = 0;
    unsigned bytes = 0;           ///< 1 to kMaxBurstBytes, none across a multiple of that
    std::span<const std::uint8_t> data{};  ///< of a write; valid during the call
  };
  /// Puts a request on the memory port at the time of a clock edge.
  using Issue = std::function<void(const Burst&, Picoseconds at)>;

  static constexpr unsigned kWrites = 4;
  /// @param slots requests that the memory port has under way at most, at least 1
  AxiMemory(unsigned slots, Issue issue);

  /// What the memory side drives before the edge.
  void drive(Picoseconds edge, AxiWires& wires);
  /// What has happened at the edge. @pre drive() for the same edge
  void sample(Picoseconds edge, const AxiWires& wires);
  /// The outcome of a request, at any time up to its first beat.
  /// @param data of a read; first, last: of its beats at the memory port. Of a write `last` counts
  void answered(std::uint64_t tag, bool error, std::span<const std::uint8_t> data, Picoseconds first,
                Picoseconds last);
  /// Nothing is under way or on its way.
  bool idle() const { return waiting_.empty() && reads_.empty() && writes_.empty() && beats_.empty(); }
  /// Forgets everything; answers to requests from before are ignored.
  void reset();

 private:
  struct Part {  // of a write, or a whole read
    std::uint64_t tag;
    bool write;
    unsigned id;
    std::uint32_t address;
    std::vector<std::uint8_t> data;
    unsigned bytes;
  };
  struct Read {
    std::uint64_t tag;
    unsigned id, beats, next = 0;
    bool known = false, error = false;
    std::vector<std::uint8_t> data;
    Picoseconds first = 0, last = 0;
  };
  struct Write {
    Request address;
    bool complete = false;  // all data are there
    std::vector<std::uint64_t> open;
    bool error = false;
    Picoseconds last = 0;
  };
  struct Slot {
    std::uint64_t tag;
    Picoseconds free;  // kNever: not known
  };

  Picoseconds beat_time(const Read& r) const;
  void offer_read(Picoseconds edge);
  void offer_answer(Picoseconds edge);
  void collect_write(Picoseconds edge);
  void issue_waiting(Picoseconds edge);

  const unsigned slots_;
  const Issue issue_;
  std::uint64_t tags_ = 0;
  std::deque<Part> waiting_;   // for a free slot
  std::vector<Slot> taken_;
  std::deque<Read> reads_;     // unanswered, in the order of the requests
  std::deque<Write> writes_;   // the same
  std::deque<WriteData> beats_;
  ReadData r_;                 // what stands on the wires
  WriteAnswer b_;
  std::uint64_t reading_ = 0;  // tag of the read whose beat r_ is
};

}  // namespace fovea::rtl
