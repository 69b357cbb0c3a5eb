// Semihosting calls of a program on one core.
#pragma once
#include <functional>
#include <optional>

#include "model/cpu/core/debug.h"
#include "sw/fovea/console/semihosting.h"

namespace fovea::app {

/// Handles SWIs of the core during its lifetime.
class CoreSemihosting : private SemihostingTarget {
 public:
  /// @param over called after each call: returns true if no further instruction may be executed
  CoreSemihosting(cpu::Core& core, cpu::DebugMemory& memory, const SemihostingSettings& settings,
                  SemihostingConsole& console, std::function<bool()> over)
      : core_(core), debug_(core, memory), calls_(settings, console), over_(std::move(over)) {
    handling_ = core_.handle_swi([this](cpu::Core&, std::uint32_t n) { return swi(n); });
  }
  CoreSemihosting(const CoreSemihosting&) = delete;
  CoreSemihosting& operator=(const CoreSemihosting&) = delete;

  /// Set once the program has ended.
  std::optional<int> exit_code() const { return calls_.exit_code(); }
  Picoseconds now() const override { return debug_.now(); }

 private:
  std::uint32_t r(unsigned number) const override { return core_.reg(number); }
  void set_r0(std::uint32_t value) override { core_.set_reg(0, value); }
  bool read(std::uint32_t address, std::span<std::uint8_t> to) override {
    return debug_.read(address, to);
  }
  bool write(std::uint32_t address, std::span<const std::uint8_t> from) override {
    return debug_.write(address, from);
  }
  bool swi(std::uint32_t number) {
    if (!Semihosting::is_call(number, core_.cpsr() & 0x20u)) return false;
    calls_.call(*this);
    if (over_()) core_.request_stop();
    return true;
  }

  cpu::Core& core_;
  cpu::CoreDebug debug_;
  Semihosting calls_;
  std::function<bool()> over_;
  Subscription handling_;
};

}  // namespace fovea::app
