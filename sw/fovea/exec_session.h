// One program on one core: loading, semihosting, and what is left to say at the end.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "model/cpu/core/debug.h"
#include "sw/fovea/core_semihosting.h"
#include "sw/fovea/executor.h"
#include "sw/fovea/gdb_session.h"
#include "sw/fovea/symbols.h"

namespace fovea::app {

class ExecSession {
 public:
  /// Takes the core's SWI hook.
  ExecSession(cpu::Core& core, cpu::DebugMemory& memory, const ExecRequest& request,
              const ExecMap& map);
  ~ExecSession();
  ExecSession(const ExecSession&) = delete;
  ExecSession& operator=(const ExecSession&) = delete;

  /// Fills memory, the vectors that the program leaves out, and the stack pointer. `ram` begins at
  /// the map's ram_base.
  void load(std::span<std::uint8_t> ram, std::span<std::uint8_t> tcm);
  /// Waits for a debugger if the request asks for one; `add` says what it sees beside the core.
  void attach(cpu::DebugMemory& memory, const std::function<void(GdbViews&)>& add = nullptr);
  GdbSession* gdb() { return gdb_.get(); }
  bool ended() const { return semihosting_.exit_code().has_value(); }
  /// Ended, or to be ended: no instruction follows.
  bool over() const { return ended() || request_.stop.load() || request_.console.lost(); }
  /// What the request's symbols say about an address.
  std::string describe(std::uint32_t address) const { return symbols_.describe(address); }
  /// For the host's looks: tells the progress. @return the option whose limit is reached, or ""
  std::string look(Picoseconds now);
  /// Result and core figures; `failure` is empty if the guest did not fail.
  ExecResult result(const std::string& failure);

 private:
  std::string failure_text(const std::string& what) const;
  std::vector<StatRow> core_stats() const;

  cpu::Core& core_;
  const ExecRequest& request_;
  const ExecProgram& program_;
  Symbols symbols_;
  ExecMap map_;
  CoreSemihosting semihosting_;
  std::unique_ptr<GdbSession> gdb_;
};

/// The core's clock, and with it those of crossbar and SDRAM, by `clocks.preset`.
struct ExecClocks {
  Frequency core, ddr, scr;
  static ExecClocks preset(std::string_view name);
};

}  // namespace fovea::app
