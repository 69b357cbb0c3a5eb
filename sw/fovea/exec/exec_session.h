// A session of `fovea exec`: one program on one core, with loading, semihosting and results.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>

#include "model/cpu/core/debug.h"
#include "sw/fovea/config/clock_setting.h"
#include "sw/fovea/console/core_semihosting.h"
#include "sw/fovea/debug/gdb_session.h"
#include "sw/fovea/machine/machine.h"
#include "sw/fovea/program/symbols.h"

namespace fovea::app {

class ExecSession {
 public:
  /// Uses the core's SWI hook.
  /// @param registers where the machine has registers, for the stall statistics
  ExecSession(cpu::Core& core, cpu::DebugMemory& memory, const Request& request,
              const ExecMap& map, std::span<const MemoryRegion> registers = {});
  ~ExecSession();
  ExecSession(const ExecSession&) = delete;
  ExecSession& operator=(const ExecSession&) = delete;

  /// Fills memory, the exception vectors that the program does not contain, and the stack pointer.
  /// `ram` begins at the map's ram_base.
  void load(std::span<std::uint8_t> ram, std::span<std::uint8_t> tcm);
  /// Waits for a debugger if the request asks for one; `add` adds views of more than the core.
  void attach(cpu::DebugMemory& memory, const std::function<void(GdbViews&)>& add = nullptr);
  GdbSession* gdb() { return gdb_.get(); }
  bool ended() const { return semihosting_.exit_code().has_value(); }
  /// True if the program has ended or the run is to end: no further instruction may be executed.
  bool over() const { return ended() || request_.stop.load() || request_.semihosting->lost(); }
  /// The symbol of an address in the request's symbol tables, as "name+0x12".
  std::string describe(std::uint32_t address) const { return symbols_.describe(address); }
  /// To be called now and then: reports progress. @return the option whose limit is reached, or ""
  std::string look(Picoseconds now);
  /// Makes the tools, whose window is the whole run. `parts` lacks what the core has.
  void attach_tools(ToolParts parts);
  /// The result with the core's figures; `failure` is empty if the guest did not fail.
  Result result(const std::string& failure);

 private:
  std::string failure_text(const std::string& what) const;
  std::vector<StatRow> core_stats() const;

  cpu::Core& core_;
  const Request& request_;
  const ExecProgram& program_;
  Symbols symbols_;
  ExecMap map_;
  CoreSemihosting semihosting_;
  std::unique_ptr<GdbSession> gdb_;
  Tools tools_;
};

/// The clocks of core, crossbar and SDRAM.
struct ExecClocks {
  Frequency core, ddr, scr;
  /// @throws UserError for clocks that the PLLs cannot give
  static ExecClocks of(const WantedClocks& wanted);
};

}  // namespace fovea::app
