// The time service of SystemC blocks: the kernel's time in picoseconds, timers, and the horizon up to
// which a memory master may run ahead of the kernel.
#pragma once
#include <cstdint>
#include <cstring>
#include <systemc>

#include "model/common/check.h"
#include "model/common/units.h"

namespace fovea {

inline Picoseconds kernel_time() { return sc_core::sc_time_stamp().value(); }
/// Exact, because the kernel's resolution is 1 ps. sc_time holds one 64-bit number; its from_value()
/// is a call into the library, which costs too much on the memory path.
inline sc_core::sc_time ps_time(Picoseconds ps) {
  static_assert(sizeof(sc_core::sc_time) == sizeof ps);
  sc_core::sc_time t;
  std::memcpy(static_cast<void*>(&t), &ps, sizeof ps);
  return t;
}

/// kernel_time() without a call: sc_time_stamp() refers to the kernel's own present time. Only for
/// objects of the simulation, which are made after its kernel.
class KernelNow {
 public:
  Picoseconds operator()() const { return now_.value(); }

 private:
  const sc_core::sc_time& now_ = sc_core::sc_time_stamp();
};

/// Time of the earliest event pending in the kernel: now if anything can run at the present instant,
/// kNever if nothing is pending. No other process acts before it. Asks the kernel; see Horizon for
/// frequent use.
Picoseconds kernel_horizon();

/// kernel_horizon(), kept until a Timer is set or cancelled. Valid within one activation of a process;
/// an activation begins with forget().
class Horizon {
 public:
  Picoseconds operator()() {
    if (seen_ != changes_) [[unlikely]]
      ask();
#ifdef FOVEA_PARANOID
    FOVEA_CHECK(holds(), "an event was notified without a Timer: the horizon is out of date");
#endif
    return at_;
  }
  /// The next call asks the kernel: its time may have advanced since the last one.
  void forget() { seen_ = changes_ - 1; }
  /// False if the kept value differs from the kernel's although no Timer was used since: an event was
  /// notified directly. A build with FOVEA_PARANOID checks this at every use.
  bool holds() const { return seen_ != changes_ || at_ == kernel_horizon(); }

  /// Remembers a moment; moved() tells whether any Timer was set or cancelled after it.
  class Mark {
   public:
    bool moved() const { return seen_ != changes_; }

   private:
    std::uint64_t seen_ = changes_;
  };

 private:
  friend class Timer;
  [[gnu::noinline]] void ask() {
    seen_ = changes_;
    at_ = kernel_horizon();
  }

  static inline std::uint64_t changes_ = 0;  // of all timers of the simulation
  std::uint64_t seen_ = changes_ - 1;
  Picoseconds at_ = 0;
};

/// An event at a time, for a process that is sensitive to event(). Blocks use it instead of a bare
/// sc_event: a process that runs ahead of the kernel may be the one who calls the block, and has to
/// learn that its horizon has moved.
class Timer {
 public:
  /// Fires at the absolute time `t`, in the next delta cycle if `t` is not later than now. If it is
  /// set to an earlier time already, that time stays. kNever changes nothing.
  void at(Picoseconds t) {
    if (t == kNever) return;
    const Picoseconds now = now_();
    event_.notify(ps_time(t > now ? t - now : 0));
    ++Horizon::changes_;
  }
  /// Fires at `t`, whatever it was set to before; kNever: not at all.
  void move_to(Picoseconds t) {
    cancel();
    at(t);
  }
  /// Fires in the next delta cycle of the present instant.
  void soon() { at(0); }
  void cancel() {
    event_.cancel();
    ++Horizon::changes_;
  }
  /// For sensitivity lists, wait() and triggered().
  const sc_core::sc_event& event() const { return event_; }

 private:
  sc_core::sc_event event_;
  KernelNow now_;
};

}  // namespace fovea
