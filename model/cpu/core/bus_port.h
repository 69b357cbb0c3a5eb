// What the ARM926 core needs from the outside: two AHB masters, time and interrupts.
#pragma once
#include <cstdint>

#include "model/common/units.h"
#include "model/common/waits.h"

namespace fovea::cpu {

/// One AHB transaction. Owned by the core; must stay where it is from submit() until done.
struct BusAccess {
  enum class Port : std::uint8_t { kInstruction, kData };
  enum class Kind : std::uint8_t { kSingle, kWrap8, kIncr4, kIncr8 };

  std::uint32_t address = 0;  ///< physical; kWrap8: address of the critical word
  std::uint8_t bytes = 4;     ///< 1, 2, 4 (single), 16 (INCR4), 32 (WRAP8, INCR8)
  /// The port's own, from the first submission on: the core keeps its accesses as long as the port.
  void* record = nullptr;
  bool write = false;
  bool buffered = false;      ///< write from the write or victim buffer: the core does not wait
  bool locked = false;        ///< SWP
  bool victim = false;        ///< a write from the victim buffer
  Port port = Port::kData;    ///< does not change after the first submission
  Kind kind = Kind::kSingle;
  /// In address order from the aligned start of the burst (for kWrap8: the start of the line, not
  /// the critical word). Valid for a read once done.
  alignas(8) std::uint8_t data[32] = {};

  /// Set by the port at submission: its outcome's last beat comes no earlier than this after it.
  Picoseconds least = 0;
  /// Set by the port at submission: it goes to a block that may act upon it, not to memory.
  bool outside = false;
  bool done = false;   ///< set by the port as soon as the outcome is decided; times may lie ahead
  bool error = false;  ///< the bus answered with an error
  Picoseconds first = 0;  ///< read: first (critical) word is at the core's AHB port
  Picoseconds last = 0;   ///< read: last word; write: the write is acknowledged
  Picoseconds issued = 0;  ///< when it was submitted
  /// When the program came to it, for a recorder of bus traffic: clock at which a store entered its
  /// buffer, or at which a read was asked for, less the clocks that the core had waited for room in
  /// the buffers so far. 0: not known.
  std::uint64_t asked = 0;
  /// Who was waited for from `issued` to a read's `first` or a write's `last`, as far as the port
  /// knows. Empty at the submission.
  RequestWaits parts;
};

/// Words on the bus, or one transfer of less.
constexpr std::uint64_t beats(unsigned bytes) { return bytes < 4 ? 1 : bytes / 4; }

/// The outside of the core. Times are absolute. One rule orders everything that happens between
/// agents: what happens at time t is seen strictly after t.
///
/// The core calls in non-decreasing time order across both AHB ports. Between calls it may run
/// instructions ahead of everyone else up to horizon().
class BusPort {
 public:
  virtual ~BusPort() = default;

  /// Puts one transaction on its AHB port at time `at`. At most one is under way per port. Does
  /// not wait for its outcome. May let other agents act before `at`.
  virtual void submit(BusAccess& access, Picoseconds at) = 0;

  /// True if `access` is done with last <= until. Lets the bus act only before `until`, and not
  /// beyond the point at which `access` is decided, so that the core may still submit at its
  /// `last` or later.
  virtual bool poll(BusAccess& access, Picoseconds until) = 0;

  /// Returns when access.done. While it waits it plays the core's background work (write buffer)
  /// in time order through Background.
  virtual void finish(BusAccess& access) = 0;

  /// Instructions that begin at or before the returned time may run without asking again, up to an
  /// access of the core's own that is `outside`: the block may bring the horizon nearer.
  virtual Picoseconds horizon() = 0;

  /// Lets all others act up to `until` (playing the core's background work), or up to a change of
  /// the core's clock, which moves what the core was waiting for. horizon() is new.
  virtual void sleep_until(Picoseconds until) = 0;

  /// Wait-for-interrupt: returns the time at which IRQ or FIQ was asserted (maybe before `from`).
  virtual Picoseconds wait_for_interrupt(Picoseconds from) = 0;
};

/// What the core has to do on its own while it is blocked: the next write of the write buffer.
class Background {
 public:
  virtual ~Background() = default;
  /// Time of the next submission of buffered writes, kNever if there is none or if it hangs on a
  /// transaction whose outcome is not decided yet.
  virtual Picoseconds next_act() const = 0;
  /// Does it (calls BusPort::submit with that time). Never blocks.
  virtual void act() = 0;
};

}  // namespace fovea::cpu
