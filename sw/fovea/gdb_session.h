// One core under a debugger.
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
#include "sw/fovea/gdb_masters.h"
#include "sw/fovea/gdb_server.h"
#include "sw/fovea/outputs.h"
#include "sw/fovea/register_log.h"

namespace fovea::app {

/// What `monitor` shows beside the core.
struct GdbViews {
  const ParamSet* params = nullptr;
  std::function<std::vector<StatRow>()> stats;  ///< present values, core included
  std::vector<RegisterBlock> blocks;
  RegisterLog* log = nullptr;  ///< null: there is nothing to log
  struct Memory {
    std::uint64_t base = 0, end = 0;
  };
  std::vector<Memory> memory;  ///< physical RAM, ascending

  // What a machine has only if there is more than the core; null otherwise.
  std::unique_ptr<GdbMasters> masters;
  std::function<Picoseconds()> now;  ///< of everybody but the core, which may be ahead
  std::function<void()> settle;      ///< takes the bus's decisions up to now; while the core sleeps
  /// The simulation returns to its caller at this time, or now if that is past.
  std::function<void(Picoseconds)> pause_at;
  /// While the core sleeps: done with the next event, before which the bus may be decided already.
  std::function<Picoseconds(std::function<void()>)> at_next_event;
  /// On the core's stack: the others come to the core's time, so that registers may change there.
  std::function<void()> catch_up;
};

/// Stands between the core's control and the server. Simulated time stands still while it serves.
class GdbSession : private GdbTarget {
 public:
  /// Listens, says where on `notes`, and lets the core stop before its first instruction.
  GdbSession(std::uint16_t port, cpu::Core& core, cpu::DebugMemory& memory, GdbViews views,
             const std::atomic<bool>& stop, std::ostream& notes);
  /// To be called now and then, not from inside the core. `asleep`: the core waits for an
  /// interrupt; then it is stopped where it is, if it is to stop.
  void look(bool asleep = false);
  /// The same from inside a semihosting call that waits for console input.
  void look_at_input();
  /// A watched access has happened or will, and the core has not stopped for it yet: a good time to
  /// look more often.
  bool hit_pending() const { return !hits_.empty(); }
  bool killed() const { return killed_; }
  /// The program has failed, for this reason, and the core will not go on: a debugger that is there
  /// sees it at the instruction that failed, until it wants to go on. Not from inside the core.
  void failed(const std::string& why);
  void exited(int status, bool by_signal = false) { server_.exited(status, by_signal); }

 private:
  void stopped(const cpu::CoreControl::Stop& stop);
  void go_on(const GdbResume& resume, bool over_watched = false);
  GdbResume serve(const GdbStop& stop);
  void serve_asleep(const GdbStop& stop);
  void noticed(const GdbMasters::Hit& hit);
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
  std::vector<Range> watched_;  // by Z packets, for the other masters
  std::vector<Range> watched_at_stop_;
  bool watch_masters_ = true;
  std::vector<GdbMasters::Hit> hits_;  // not told yet; some may lie ahead
  bool asleep_ = false;                // served while the core waits
  const char* waits_for_ = "an interrupt";
  bool failed_ = false;
  bool halt_seen_ = false, serving_ = false;
  GdbServer server_;
  bool killed_ = false;
};

}  // namespace fovea::app
