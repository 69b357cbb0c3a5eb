// The memory path as a master sees it that runs ahead of the kernel.
#pragma once
#include <array>
#include <cstdint>
#include <systemc>

#include "model/common/mem_request.h"
#include "model/common/timer.h"
#include "model/common/units.h"

namespace fovea {

/// A passive state machine: it decides at times of its own but acts only when told to.
class PassiveIf : public virtual sc_core::sc_interface {
 public:
  /// Time of its next decision; kNever if it waits for a request.
  virtual Picoseconds next_decision() const = 0;
  /// Takes that decision. The caller knows all arrivals strictly before it.
  virtual void step() = 0;
  /// Where the block keeps the value of next_decision(), for whoever asks often.
  virtual const Picoseconds* next_decision_place() const = 0;
  /// A request arrives at `at`, its address an offset in the block: what the socket's forward call
  /// does, for a path
  /// that plays ahead of the kernel and needs no delay relative to it. If it waits the socket says
  /// when it is taken.
  virtual Taken arrive(MemRequest& request, Picoseconds at) = 0;
  /// Notified when clocks or registers have moved the next decision, unasked by any request.
  virtual const sc_core::sc_event& replanned() const = 0;
};

/// The head of the memory path. While a running agent holds it, the agent plays its decisions;
/// otherwise the path keeps a kernel event pending at its next decision.
class MemoryPathIf : public virtual sc_core::sc_interface {
 public:
  /// As in PassiveIf; the next decision is the earlier of these two.
  virtual std::array<const Picoseconds*, 2> decision_places() const = 0;
  virtual void hold() = 0;
  virtual void release() = 0;
  /// Takes the next decision, which is before `limit`, and goes on with those before `limit` until
  /// one lets a master act or notifies the kernel: the caller's limit may be another one then.
  virtual void step_before(Picoseconds limit) = 0;
  /// A request that its master holds back until it waits for it, or others may act. If nobody else's
  /// is in the crossbar and its grant comes before `limit`, it is put on the port, granted and
  /// played on, all decisions in order and before `limit`.
  enum class Alone {
    kNo,     ///< not put on the port
    kUnder,  ///< under way, or answered, as if its port had been called
    kDone,   ///< the outcome is in the request; its port is not called
  };
  virtual Alone play_alone(MemRequest& request, Picoseconds limit) = 0;
  /// What may be held back: requests to addresses from here on; kNever: none.
  virtual std::uint64_t memory_base() const = 0;
  /// At least this long from the issue of such a request to its outcome's last beat.
  virtual Picoseconds least_latency(Master master) const = 0;
  /// Requests whose outcome is not decided yet, of all masters, without the passive ones. Deciding
  /// one may let its master act.
  virtual unsigned undecided() const = 0;
  /// --sync=strict: every bus access waits for the kernel; nobody steps ahead of it.
  virtual bool strict() const = 0;
};

}  // namespace fovea
