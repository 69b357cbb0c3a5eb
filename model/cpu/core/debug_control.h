// Stops the core at instruction boundaries: breakpoints, watchpoints, steps, requests.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "model/cpu/core/debug.h"

namespace fovea::cpu {

/// While nothing is set the core does not know of it; with anything set it looks at every boundary
/// and runs slower on the host, with the same simulated time.
class CoreControl {
 public:
  enum class Watch : std::uint8_t { kWrite, kRead, kAccess };
  struct Stop {
    enum class Reason : std::uint8_t { kRequest, kStep, kBreakpoint, kWatch, kTime } reason;
    Watch watch = Watch::kAccess;   ///< kWatch: which kind of watchpoint
    std::uint32_t address = 0;      ///< kWatch: first watched address that will be touched
    bool past = false;              ///< kWatch: the instruction before this boundary has touched it
  };

  CoreControl(Core& core, CoreDebug& debug) : core_(core), debug_(debug) {}
  ~CoreControl() { clear(); core_.debugger_ = nullptr; }
  CoreControl(const CoreControl&) = delete;
  CoreControl& operator=(const CoreControl&) = delete;

  /// Called at a boundary, on the core's own stack, before the instruction at the pc; the core goes
  /// on with that instruction when it returns, unless that touches what is watched by then and
  /// nobody was told yet. Of the watched ranges that one instruction touches the first is told
  /// before it, the others when the core is to go on behind it and they are still watched. A step
  /// from there ends where it began: there is no instruction left to step over.
  std::function<void(const Stop&)> on_stop;

  void set_breakpoint(std::uint32_t va) { breakpoints_.insert(va), update(); }
  void clear_breakpoint(std::uint32_t va) { breakpoints_.erase(va), update(); }
  void set_watch(std::uint32_t va, std::uint32_t bytes, Watch kind);
  void clear_watch(std::uint32_t va, std::uint32_t bytes, Watch kind);
  /// Stops at the next boundary. Not from another thread.
  void request_halt() { halt_ = true, update(); }
  bool halt_pending() const { return halt_; }
  void cancel_halt() { halt_ = false, update(); }
  /// Stops at the next boundary whose pc lies outside [from, to).
  void step(std::uint32_t from = 0, std::uint32_t to = 0);
  /// Stops at the first boundary later than t; kNever takes that back.
  void stop_after(Picoseconds t) { stop_after_ = t, update(); }
  /// At each boundary the bus has decided all that it decides before: what other masters do there
  /// is known before the core goes on.
  void follow_bus(bool on) { follow_ = on, update(); }
  /// The same once, for whoever looks at the bus at a stop.
  void settle_bus();
  /// Something outside the core has changed at this boundary: it looks for the next event anew.
  void disturb();
  /// Forgets all of it.
  void clear();

 private:
  friend class Core;
  struct Range {
    std::uint32_t va, bytes;
    Watch kind;
    friend bool operator==(const Range&, const Range&) = default;
  };
  struct Touched {
    Range range;
    std::uint32_t address;
  };
  void boundary();
  void update();
  std::optional<Stop> look(std::uint32_t pc);
  std::optional<Stop> look_again(const Stop& last, std::uint32_t pc);
  std::vector<Touched> watched(std::uint32_t pc) const;
  std::optional<Stop> tell(std::uint32_t pc);
  void note_touched();
  static void drop_ranges_with(std::uint32_t address, std::vector<Touched>& list);

  Core& core_;
  CoreDebug& debug_;
  std::set<std::uint32_t> breakpoints_;
  std::vector<Range> watches_;
  std::vector<Touched> touching_;  // by the instruction at which the core stands, beside the told
  std::uint64_t touching_count_ = 0;  // instructions that were executed before it
  std::vector<Touched> touched_;      // by the instruction before, not yet told
  bool halt_ = false, step_ = false, follow_ = false;
  Picoseconds stop_after_ = kNever;
  std::uint32_t step_from_ = 0, step_to_ = 0;
};

}  // namespace fovea::cpu
