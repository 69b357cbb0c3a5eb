// What the ARM926 core needs from its surroundings: two AHB ports, time and interrupts.
#pragma once
#include <cstdint>

#include "model/common/units.h"
#include "model/common/waits.h"

namespace fovea::cpu {

/// One AHB transaction. The core owns it and must not move it from submit() until `done`.
struct BusAccess {
  enum class Port : std::uint8_t { kInstruction, kData };
  enum class Kind : std::uint8_t { kSingle, kWrap8, kIncr4, kIncr8 };

  std::uint32_t address = 0;  ///< physical; kWrap8: address of the critical word
  std::uint8_t bytes = 4;     ///< 1, 2, 4 (single), 16 (INCR4), 32 (WRAP8, INCR8)
  /// For the port's own use, from the first submission on. The core's accesses live as long as the
  /// port.
  void* record = nullptr;
  bool write = false;
  bool buffered = false;      ///< write from a buffer, for which the core does not wait
  bool locked = false;        ///< access of a SWP, between whose accesses the bus stays locked
  bool victim = false;        ///< write from the victim buffer
  Port port = Port::kData;    ///< never changes after the first submission
  Kind kind = Kind::kSingle;
  /// The bytes in address order, from the aligned start of the burst (for kWrap8 the start of the
  /// line, not the critical word). For a read, valid once `done` is set.
  alignas(8) std::uint8_t data[32] = {};

  /// Set at submission: the shortest possible time from then to `last`, in ps.
  Picoseconds least = 0;
  /// Set at submission: the address belongs to a block that may react to the access, not to memory.
  bool outside = false;
  bool done = false;   ///< set by the port when the outcome is decided; `first` and `last` may lie
                       ///< in the future
  bool error = false;  ///< the access ended in a bus error
  Picoseconds first = 0;  ///< read: arrival of the first (critical) word at the core's AHB port
  Picoseconds last = 0;   ///< read: arrival of the last word; write: arrival of the acknowledgement
  Picoseconds issued = 0;  ///< time of submission
  /// Core clock at which the program reached this access, for a recorder of bus traffic: when a
  /// store entered its buffer or a read was requested, minus all clocks that the core has waited
  /// for room in the buffers so far. 0: unknown.
  std::uint64_t asked = 0;
  /// What the access waited for from `issued` to `first` (read) or `last` (write), as far as the
  /// port knows. Empty at submission.
  RequestWaits parts;
};

/// Beats of a transfer: its words, or 1 for less than a word.
constexpr std::uint64_t beats(unsigned bytes) { return bytes < 4 ? 1 : bytes / 4; }

/// What the core calls to reach the rest of the system. Times are absolute. One rule orders all
/// activity between agents: what happens at time t is visible strictly after t.
///
/// The core calls in non-decreasing order of time across both AHB ports. Between two calls it may
/// execute instructions ahead of all others, up to horizon().
class BusPort {
 public:
  virtual ~BusPort() = default;

  /// Issues a transaction on its AHB port at time `at`, without waiting for its outcome. At most
  /// one is outstanding per port. Others may act before `at`.
  virtual void submit(BusAccess& access, Picoseconds at) = 0;

  /// Returns true if `access` is done and its `last` is not after `until`. Lets the bus act only
  /// before `until`, and only as far as needed to decide `access`, so that the core may still submit
  /// a transaction at its `last` or later.
  virtual bool poll(BusAccess& access, Picoseconds until) = 0;

  /// Waits until access.done. Meanwhile, the background work of the core (its write buffer) is
  /// executed in order of time through Background.
  virtual void finish(BusAccess& access) = 0;

  /// The core may execute instructions that begin at or before the returned time without asking
  /// again, until one of its own accesses is `outside`: the accessed block may bring the horizon
  /// nearer.
  virtual Picoseconds horizon() = 0;

  /// Lets all others act up to `until`, or up to a change of the core's clock (which moves the time
  /// that the core was waiting for), and executes the core's background work. horizon() has to be
  /// asked again.
  virtual void sleep_until(Picoseconds until) = 0;

  /// Waits for an interrupt. Returns the time at which IRQ or FIQ was asserted, which may be before
  /// `from`.
  virtual Picoseconds wait_for_interrupt(Picoseconds from) = 0;
};

/// Work that the core does even while it is blocked: sending the next entry of the write buffers.
class Background {
 public:
  virtual ~Background() = default;
  /// Time of the next submission of a buffered write; kNever if there is none, or while it depends
  /// on a transaction whose outcome is not decided.
  virtual Picoseconds next_act() const = 0;
  /// Does that work (calls BusPort::submit with that time). Never blocks.
  virtual void act() = 0;
};

}  // namespace fovea::cpu
