// What stands behind the registers and the memory port of the remap engine: a transaction-level model or the
// verilated RTL. Knows no SystemC.
#pragma once
#include <cstdint>
#include <span>

#include "model/common/clock.h"
#include "model/common/units.h"

namespace fovea::engine {

/// Requests that are under way at once at most: 4 bursts of the map, 8 lines of the source, 4 writes.
inline constexpr unsigned kSlots = 16;
enum ReadId : unsigned { kMapReads = 0, kSourceReads = 1 };

/// A request on the memory port: a read, or the consecutive bytes of a write.
struct Burst {
  std::uint64_t tag = 0;  ///< comes back with the answer; chosen by the backend
  bool write = false;
  unsigned id = 0;        ///< of a read: ReadId
  std::uint32_t address = 0;
  unsigned bytes = 0;     ///< 4 to 64, none across a multiple of 64
  std::span<const std::uint8_t> data{};  ///< of a write; valid during the call
};

/// Of the job that a request belongs to what a message about the request needs. Bases and pitches in words, but
/// `map_base` in bytes.
struct JobPlace {
  std::uint32_t number = 0;  ///< ENDED.COUNT at its end; 0: not known
  std::uint8_t tag = 0;
  std::uint32_t src_base = 0, src_pitch = 0, dst_base = 0, dst_pitch = 0, map_base = 0;
};

/// The outcome of a Burst.
struct Answer {
  std::uint64_t tag = 0;
  bool write = false;
  bool error = false;  ///< no slave has answered; `data` are zeros
  std::span<const std::uint8_t> data{};  ///< of a read; valid during the call
  Picoseconds first = 0, last = 0;       ///< beats at the port; of a write `last` is the acknowledgement
};

/// Times. A backend has a clock, whose edges are numbered. What comes from outside at a time t (answers, their
/// beats, accesses to registers) is seen at the first edge strictly after t. So within an instant the order of
/// calls does not matter, except that of accesses to registers among themselves, which come last.
///
/// The owner calls run() when an answer has come, at the time that run() returned before, and before each access
/// to a register.
///
/// The memory port. A burst on AR is one Burst of up to 64 bytes, put on the port at the edge that takes it. The
/// 64-bit beats of an answer reach the engine spread evenly over `first` to `last`, one of all reads an edge at
/// most; of one identifier in the order of the requests. A burst on AW is handed over at the edge at which all of
/// it is there: a Burst for each run of bytes that the strobes leave; it is answered when all of them are. The
/// owner takes at least kSlots requests at once without holding any back; others wait there, in order.
class EngineBackend {
 public:
  class Host {
   public:
    virtual ~Host() = default;
    /// @param at an edge of the clock, now or later; not before that of an earlier call
    virtual void issue(const Burst& burst, Picoseconds at) = 0;
    /// The interrupt line has another level from the present call of run(), read() or write() on. A backend whose
    /// accesses need edges may be up to two clocks ahead of its line.
    virtual void interrupt(bool level) = 0;
  };

  virtual ~EngineBackend() = default;

  /// Lets the edges up to `now` happen. A backend may work ahead of `now` as long as nothing from outside could
  /// still change what it does.
  /// @return when to call again at the latest if nothing happens outside; kNever: not at all
  virtual Picoseconds run(Picoseconds now) = 0;
  /// Accesses to the registers of EngineRegs, after run(now). A read is of a word; a write changes the bytes of which
  /// the bit in `strobes` is set, the lowest byte's first, and a command acts if its lowest byte is written. A write
  /// to bits that are read-only or not implemented has no effect. What a write changes is visible to a read at a later
  /// edge. A backend whose own bus needs edges for an access may have them at once, ahead of the clock. Afterwards the
  /// owner calls run(now) again.
  virtual std::uint32_t read(std::uint32_t offset, Picoseconds now) = 0;
  virtual void write(std::uint32_t offset, std::uint32_t word, unsigned strobes, Picoseconds now) = 0;
  /// An outcome, in the order of the requests of one identifier, and of the writes. A read's may be reported from its
  /// decision up to its first beat.
  virtual void answer(const Answer& answer) = 0;
  /// A write's may be reported from its decision on too. Otherwise it is reported at the acknowledgement, and a
  /// read's at its first beat at the earliest.
  virtual bool takes_answers_ahead() const { return false; }
  /// During a call of Host::issue(): the job of the request, if the backend can tell.
  virtual JobPlace job() const { return {}; }
  /// Needs edges: a job waits that may start, or one is under way.
  virtual bool busy() const = 0;
  /// As after power-up. The owner hands over no answers to requests from before.
  virtual void reset() = 0;
};

}  // namespace fovea::engine
