// Debugging one core with GDB.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "model/common/param.h"
#include "model/common/regbank.h"
#include "model/cpu/core/debug_control.h"
#include "sw/fovea/debug/gdb_masters.h"
#include "sw/fovea/debug/gdb_server.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/tools/register_log.h"

namespace fovea::app {

/// What the `monitor` commands show besides the core.
struct GdbViews {
  const ParamSet* params = nullptr;
  std::function<std::vector<StatRow>()> stats;  ///< current values, including those of the core
  std::vector<RegisterBlock> blocks;
  RegisterLog* log = nullptr;  ///< null: there is nothing to log
  struct Memory {
    std::uint64_t base = 0, end = 0;
  };
  std::vector<Memory> memory;  ///< physical RAM, in ascending order

  // For machines that have more than the core; null otherwise.
  std::unique_ptr<GdbMasters> masters;
  std::function<Picoseconds()> now;  ///< time of the kernel; the core may be ahead
  std::function<void()> settle;      ///< advances the bus to the current time, while the core
                                     ///< sleeps
  /// Makes the simulation return to its caller at this time, or now if the time is past.
  std::function<void(Picoseconds)> pause_at;
  /// While the core sleeps: calls the function at the next event (before which the bus may already
  /// be decided). Returns its time.
  std::function<Picoseconds(std::function<void()>)> at_next_event;
  /// On the core's thread: advances all others to the core's time, so that registers may be changed
  /// there.
  std::function<void()> catch_up;
};

/// Connects the core's debug control to the server. Simulated time does not advance while it
/// serves.
class GdbSession : private GdbTarget {
 public:
  /// Starts to listen, reports the port on `notes`, and lets the core stop before its first
  /// instruction.
  GdbSession(std::uint16_t port, cpu::Core& core, cpu::DebugMemory& memory, GdbViews views,
             const std::atomic<bool>& stop, std::ostream& notes);
  /// To be called now and then, but not from inside the core. If `asleep`, the core waits for an
  /// interrupt, and a requested stop takes place there.
  void look(bool asleep = false);
  /// The same, called by a semihosting call that waits for console input.
  void poll_during_input();
  /// A watchpoint was hit, or is certain to be, and the core has not stopped yet: call look() at
  /// shorter intervals.
  bool hit_pending() const { return !hits_.empty(); }
  bool killed() const { return killed_; }
  /// The program has failed, for this reason, and the core will not continue. A connected debugger
  /// can inspect it at the instruction that failed, until it continues. Must not be called from
  /// inside the core.
  void failed(const std::string& why);
  void exited(int status, bool by_signal = false) { server_.exited(status, by_signal); }

 private:
  void stopped(const cpu::CoreControl::Stop& stop);
  void go_on(const GdbResume& resume, bool over_watched = false);
  GdbResume serve(const GdbStop& stop);
  void serve_asleep(const GdbStop& stop);
  void add_hit(const GdbMasters::Hit& hit);
  Picoseconds next_hit() const;
  GdbStop take_hit();
  void wait_for_hit();
  bool hidden_from_core(const GdbMasters::Hit& hit);
  void arm_watches(bool over_watched);

  std::span<const unsigned> registers() const override { return numbers_; }
  std::optional<std::uint32_t> read_register(unsigned number) const override;
  bool write_register(unsigned number, std::uint32_t value) override;
  bool read_memory(std::uint32_t address, std::span<std::uint8_t> to) override {
    return debug_.read(address, to);
  }
  bool write_memory(std::uint32_t address, std::span<const std::uint8_t> from) override {
    return debug_.write(address, from);
  }
  bool set_point(Point kind, std::uint32_t address, std::uint32_t bytes) override;
  bool clear_point(Point kind, std::uint32_t address, std::uint32_t bytes) override;
  void clear_all_points() override;
  std::string target_xml() const override;
  std::string memory_map_xml() const override;
  std::string monitor(const std::string& command) override;
  std::string show_stats(const std::string& part) const;
  std::string show_registers(const std::string& what) const;
  std::string set_register(const std::string& what);
  std::string show_log(const std::string& what);
  std::string where();
  Picoseconds time_now() const;
  std::string core_line() const;
  std::string watch(const std::string& what);
  std::string watch_masters(const std::string& what);

  cpu::Core& core_;
  cpu::CoreDebug debug_;
  cpu::CoreControl control_;
  GdbViews views_;
  std::vector<unsigned> numbers_;
  struct Kinds {
    unsigned software = 0, hardware = 0;
  };
  std::map<std::uint32_t, Kinds> breakpoints_;
  struct Range {
    std::uint32_t va, bytes;
    Point kind;
    friend bool operator==(const Range&, const Range&) = default;
  };
  std::vector<Range> watched_;  // set by Z packets, for masters other than the core
  std::vector<Range> watched_at_stop_;
  bool watch_masters_ = true;
  std::vector<GdbMasters::Hit> hits_;  // not reported yet; some may lie in the future
  bool asleep_ = false;                // serving while the core waits for an interrupt
  const char* waits_for_ = "an interrupt";
  bool failed_ = false;
  bool halt_seen_ = false, serving_ = false;
  GdbServer server_;
  bool killed_ = false;
};

}  // namespace fovea::app
