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
#include "sw/fovea/gdb_server.h"
#include "sw/fovea/outputs.h"

namespace fovea::app {

/// What `monitor` shows beside the core.
struct GdbViews {
  const ParamSet* params = nullptr;
  std::function<std::vector<StatRow>()> stats;  ///< present values, core included
  std::vector<std::pair<std::string, const RegBank*>> blocks;
  struct Memory {
    std::uint64_t base = 0, end = 0;
  };
  std::vector<Memory> memory;  ///< physical RAM, ascending
};

/// Stands between the core's control and the server. Simulated time stands still while it serves.
class GdbSession : private GdbTarget {
 public:
  /// Listens, says where on `notes`, and lets the core stop before its first instruction.
  GdbSession(std::uint16_t port, cpu::Core& core, cpu::DebugMemory& memory, GdbViews views,
             const std::atomic<bool>& stop, std::ostream& notes);
  /// To be called now and then while the core runs, not from inside it.
  void look();
  /// A halt was asked for and the core does not come to a boundary: it waits for an interrupt.
  /// Serves the debugger from outside the core.
  void serve_asleep();
  bool halt_pending() const { return control_.halt_pending(); }
  bool killed() const { return killed_; }
  void exited(int status) { server_.exited(status); }

 private:
  void stopped(const cpu::CoreControl::Stop& stop);
  void go_on(const GdbResume& resume);

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

  cpu::Core& core_;
  cpu::CoreDebug debug_;
  cpu::CoreControl control_;
  GdbViews views_;
  std::vector<unsigned> numbers_;
  struct Kinds {
    unsigned software = 0, hardware = 0;
  };
  std::map<std::uint32_t, Kinds> breakpoints_;
  GdbServer server_;
  bool killed_ = false;
};

}  // namespace fovea::app
