// One program on one core: loading, semihosting, and what is left to say at the end.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "model/cpu/core/debug.h"
#include "sw/fovea/executor.h"
#include "sw/fovea/gdb_session.h"

namespace fovea::app {

class ExecSession : private SemihostingTarget {
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
  /// Result and core figures; `failure` is empty if the guest did not fail.
  ExecResult result(const std::string& failure);

 private:
  std::uint32_t r(unsigned number) const override { return core_.reg(number); }
  void set_r0(std::uint32_t value) override { core_.set_reg(0, value); }
  bool read(std::uint32_t address, std::span<std::uint8_t> to) override {
    return debug_.read(address, to);
  }
  bool write(std::uint32_t address, std::span<const std::uint8_t> from) override {
    return debug_.write(address, from);
  }
  Picoseconds now() const override { return debug_.now(); }
  bool swi(std::uint32_t number);
  std::string failure_text(const std::string& what) const;
  std::vector<StatRow> core_stats() const;

  cpu::Core& core_;
  cpu::CoreDebug debug_;
  const ExecRequest& request_;
  const ExecProgram& program_;
  ExecMap map_;
  Semihosting semihosting_;
  std::unique_ptr<GdbSession> gdb_;
};

/// The core's clock, and with it those of crossbar and SDRAM, by `clocks.preset`.
struct ExecClocks {
  Frequency core, ddr, scr;
  static ExecClocks preset(std::string_view name);
};

}  // namespace fovea::app
