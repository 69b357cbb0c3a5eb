// Stops the core at instruction boundaries: breakpoints, watchpoints, single steps, requests.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "model/cpu/core/debug.h"

namespace fovea::cpu {

/// While nothing is set, the core runs without any check for it. Otherwise it calls at_boundary()
/// at every instruction boundary, which costs host time but no simulated time. There may be several
/// objects for one core.
class CoreControl : private BoundaryObserver {
 public:
  enum class Watch : std::uint8_t { kWrite, kRead, kAccess };
  struct Stop {
    enum class Reason : std::uint8_t { kRequest, kStep, kBreakpoint, kWatch, kTime } reason;
    Watch watch = Watch::kAccess;   ///< kWatch: the kind of watchpoint
    std::uint32_t address = 0;      ///< kWatch: first watched address that the instruction touches
    bool past = false;              ///< kWatch: touched by the instruction before this boundary,
                                    ///< not by the next one
  };

  CoreControl(Core& core, CoreDebug& debug) : core_(core), debug_(debug) {}
  CoreControl(const CoreControl&) = delete;
  CoreControl& operator=(const CoreControl&) = delete;

  /// Called at a boundary on the core's own thread, before the instruction at the pc. When it
  /// returns, the core executes that instruction, unless the instruction touches a watched range
  /// that has not been reported yet. If one instruction touches several watched ranges, the first
  /// is reported before it is executed and each of the others after it, if that range is still
  /// watched. A single step that is requested at such a second report ends at once: there is no
  /// instruction left to execute.
  std::function<void(const Stop&)> on_stop;

  void set_breakpoint(std::uint32_t va) { breakpoints_.insert(va), update(); }
  void clear_breakpoint(std::uint32_t va) { breakpoints_.erase(va), update(); }
  void set_watch(std::uint32_t va, std::uint32_t bytes, Watch kind);
  void clear_watch(std::uint32_t va, std::uint32_t bytes, Watch kind);
  /// Stops at the next boundary. Not to be called from another thread.
  void request_halt() { halt_ = true, update(); }
  bool halt_pending() const { return halt_; }
  void cancel_halt() { halt_ = false, update(); }
  /// Stops at the next boundary where the pc is outside [from, to).
  void step(std::uint32_t from = 0, std::uint32_t to = 0);
  /// Stops at the first boundary after t; kNever cancels this.
  void stop_after(Picoseconds t) { stop_after_ = t, update(); }
  /// While on, the bus decides everything that it decides before each boundary, so that the actions
  /// of other masters are known before the core continues.
  void follow_bus(bool on) { follow_ = on, update(); }
  /// Does that once, for a caller that inspects the bus while the core is stopped.
  void settle_bus() { core_.settle_bus(); }
  /// To be called when something outside the core was changed at this boundary: the core asks for
  /// the next event again.
  void disturb() { core_.disturb(); }
  /// Removes everything that was set.
  void clear();

 private:
  struct Range {
    std::uint32_t va, bytes;
    Watch kind;
    friend bool operator==(const Range&, const Range&) = default;
  };
  struct Touched {
    Range range;
    std::uint32_t address;
  };
  void at_boundary() override;
  void update();
  std::optional<Stop> find_stop(std::uint32_t pc);
  std::optional<Stop> find_next_stop(const Stop& last, std::uint32_t pc);
  std::vector<Touched> watched(std::uint32_t pc) const;
  std::optional<Stop> report_touched(std::uint32_t pc);
  void note_touched();
  static void drop_ranges_with(std::uint32_t address, std::vector<Touched>& list);

  Core& core_;
  CoreDebug& debug_;
  std::set<std::uint32_t> breakpoints_;
  std::vector<Range> watches_;
  std::vector<Touched> touching_;  // touched by the next instruction, apart from the reported range
  std::uint64_t touching_count_ = 0;  // number of instructions executed before it
  std::vector<Touched> touched_;      // touched by the previous instruction and not reported yet
  bool halt_ = false, step_ = false, follow_ = false;
  Picoseconds stop_after_ = kNever;
  std::uint32_t step_from_ = 0, step_to_ = 0;
  Subscription observing_;  // while something is set
};

}  // namespace fovea::cpu
