// The board as a debugger sees it.
#pragma once
#include "model/board/board.h"
#include "sw/fovea/debug/gdb_session.h"

namespace fovea::app {

/// SDRAM with what waits in the controller's FIFO; registers for reading, whole words or parts,
/// without their side effects. Writing registers is refused: it would be an act at no simulated
/// time.
class BoardDebugMemory : public cpu::DebugMemory {
 public:
  explicit BoardDebugMemory(soc::Dm365& soc) : soc_(soc) {}
  bool debug_read(std::uint32_t pa, std::span<std::uint8_t> to) override;
  bool debug_write(std::uint32_t pa, std::span<const std::uint8_t> from) override;

 private:
  bool in_sdram(std::uint32_t pa, std::size_t bytes) const;
  soc::Dm365& soc_;
};

RegisterBlock register_block(const std::string& name, BusTarget& block);
/// Of all blocks that have registers.
std::vector<RegisterBlock> register_blocks(const Platform& platform);
/// Not yet started.
std::unique_ptr<RegisterLog> register_log(std::vector<RegisterBlock> blocks, bus::ConfigBus& bus,
                                          cpu::Core& core,
                                          std::function<std::string(std::uint32_t)> describe);

/// The other masters, and what changing registers from a debugger needs; before the simulation
/// starts.
void join_bus(GdbViews& views, bus::Scr& scr, mem::DdrModule& ddr, cpu::Arm926& arm,
              EndOfInstant& end_of_instant, std::uint32_t ddr_base);

/// Blocks, memory, statistics and parameters for `monitor`. All three outlive it.
GdbViews board_views(board::Board& board, const ParamSet& params, RegisterLog* log);

}  // namespace fovea::app
