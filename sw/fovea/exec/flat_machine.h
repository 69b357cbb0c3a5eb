// `fovea exec --fast-memory`: the core with memory without wait states. No SystemC.
#pragma once
#include <span>

#include "model/cpu/core/debug.h"
#include "model/mem/core/backing_store.h"
#include "sw/fovea/machine/machine.h"

namespace fovea::app {

/// Completes every access at once. There are no other masters and no interrupts.
class FlatMemoryPort final : public cpu::BusPort, public cpu::DebugMemory {
 public:
  FlatMemoryPort(std::uint32_t base, std::uint64_t bytes) : base_(base), store_(bytes) {}
  std::span<std::uint8_t> ram() { return {store_.at(0), store_.size()}; }
  /// Called about once per simulated millisecond, at an instruction boundary.
  std::function<void()> on_slice;

  void submit(cpu::BusAccess& access, Picoseconds at) override;
  bool poll(cpu::BusAccess& access, Picoseconds until) override { return access.last <= until; }
  void finish(cpu::BusAccess&) override {}
  Picoseconds horizon() override { return slice_end_; }
  void sleep_until(Picoseconds until) override;
  Picoseconds wait_for_interrupt(Picoseconds) override;
  bool debug_read(std::uint32_t pa, std::span<std::uint8_t> to) override;
  bool debug_write(std::uint32_t pa, std::span<const std::uint8_t> from) override;

 private:
  bool holds(std::uint32_t pa, std::size_t bytes) const {
    return pa >= base_ && pa - base_ + std::uint64_t{bytes} <= store_.size();
  }
  static constexpr Picoseconds kSlice = kPsPerMs;
  std::uint32_t base_;
  mem::BackingStore store_;
  Picoseconds slice_end_ = kSlice;
};

/// Runs the request on such a machine.
Result run_flat(const Request& request, const cpu::CpuParams& cpu, const ExecMap& map,
                    Frequency core_clock);

}  // namespace fovea::app
