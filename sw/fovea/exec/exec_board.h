// `fovea exec`: core, crossbar and SDRAM of the chip, without its peripherals.
#pragma once
#include <array>
#include <memory>
#include <span>
#include <systemc>
#include <vector>

#include "model/bus/config_bus.h"
#include "model/bus/scr.h"
#include "model/bus/wait_stats.h"
#include "model/common/block.h"
#include "model/common/end_of_instant.h"
#include "model/contract/memory_map.h"
#include "model/cpu/arm926.h"
#include "model/cpu/core/debug.h"
#include "model/mem/ddr_module.h"
#include "model/soc/placement.h"
#include "sw/fovea/exec/exec_session.h"

namespace fovea::app {

struct ExecBoardParams {
  const cpu::CpuParams& cpu;
  const bus::CrossbarParams& crossbar;
  const bus::ConfigBusParams& config_bus;
  const mem::DdrParams& ddr;
};

/// Clocks run and the SDRAM controller is programmed from the start, as the boot loader leaves
/// them. Only the controller's registers answer on the configuration bus.
class ExecBoard : public sc_core::sc_module, public Block, public cpu::DebugMemory {
 public:
  ExecBoard(sc_core::sc_module_name name, const ExecBoardParams& params, const ExecMap& map,
            const ExecClocks& clocks, std::uint32_t entry);

  std::span<std::uint8_t> ram() { return {ddr.store().at(0), ddr.store().size()}; }
  std::span<std::uint8_t> tcm() { return tcm_; }
  bool debug_read(std::uint32_t pa, std::span<std::uint8_t> to) override;
  bool debug_write(std::uint32_t pa, std::span<const std::uint8_t> from) override;
  /// Where its registers lie, for the stall statistics.
  static std::vector<MemoryRegion> register_regions();

 private:
  std::array<std::uint8_t, INTERNAL_RAM_BYTES> internal_ram_{};
  std::span<std::uint8_t> tcm_;
  std::uint32_t ram_base_;

 public:
  EndOfInstant end_of_instant{"end_of_instant"};
  cpu::Arm926 arm;
  bus::Scr scr;
  bus::ConfigBus config;
  mem::DdrModule ddr;
  /// All of them; the waits of the masters are this block's own statistics.
  Platform platform;

 private:
  void program_controller(Frequency ddr_clock);
  void beat();
  bool holds(std::uint32_t pa, std::size_t bytes) const {
    return pa >= ram_base_ && pa - ram_base_ + std::uint64_t{bytes} <= ddr_size_;
  }

  std::vector<std::unique_ptr<bus::WaitStats>> waits_;
  std::uint64_t ddr_size_;
  ClockSignal arm_clk_, ddr_clk_, scr_clk_;
  sc_core::sc_signal<bool> on_{"on", true}, irq_{"irq"}, fiq_{"fiq"};
  sc_core::sc_vector<sc_core::sc_signal<std::uint32_t>> priority_{"priority", kMasterCount};
};

}  // namespace fovea::app
