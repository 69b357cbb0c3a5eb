#include "sw/fovea/board/board_debug.h"

#include <algorithm>
#include <cstring>

namespace fovea::app {
namespace {

constexpr std::uint64_t kInternal = INTERNAL_RAM_BYTES, kDataWindow = INTERNAL_RAM_DATA_BASE;

/// Gives the simulation back to its caller at a time. Made before the simulation starts.
/// Masters and memory may act in the same instant, and would then go on up to the next event of another process; an
/// event right behind the pause keeps them at its time.
class Pause : public sc_core::sc_module {
 public:
  explicit Pause(sc_core::sc_module_name name) : sc_module(name) {
    SC_HAS_PROCESS(Pause);
    SC_METHOD(pause);
    sensitive << due_.event();
    dont_initialize();
  }
  void at(Picoseconds t) {
    due_.move_to(t);  // the core may have met the cause of an earlier one already
    fence_.move_to(t == kNever ? kNever : std::max(t, kernel_time()) + 1);
  }

 private:
  void pause() { sc_core::sc_pause(); }
  Timer due_, fence_;
};

}  // namespace

bool BoardDebugMemory::in_sdram(std::uint32_t pa, std::size_t bytes) const {
  return pa >= DDR_BASE && pa - DDR_BASE + std::uint64_t{bytes} <= soc_.ddr.store().size();
}

bool BoardDebugMemory::debug_read(std::uint32_t pa, std::span<std::uint8_t> to) {
  if (in_sdram(pa, to.size())) {
    soc_.ddr.controller().debug_read(pa - DDR_BASE, to.data(), static_cast<unsigned>(to.size()));
    return true;
  }
  for (std::size_t k = 0; k < to.size(); ++k) {
    const std::uint32_t at = pa + static_cast<std::uint32_t>(k);
    if (at >= DDR_BASE) return false;
    std::array<std::uint8_t, 4> word{};
    MemRequest r;
    r.address = at & ~3u;
    r.bytes = 4;
    r.data = word.data();
    if (soc_.config.transport_dbg(r) != 4) return false;
    to[k] = word[at & 3u];
  }
  return true;
}

bool BoardDebugMemory::debug_write(std::uint32_t pa, std::span<const std::uint8_t> from) {
  if (!in_sdram(pa, from.size())) return false;
  soc_.ddr.controller().debug_write(pa - DDR_BASE, from.data(), static_cast<unsigned>(from.size()));
  return true;
}

RegisterBlock register_block(const std::string& name, BusTarget& block) {
  return {name, &block.bank(), [&block] { return block.gated(); },
          [&block](RegisterObserver& o) { return block.observe(o); }};
}

std::vector<RegisterBlock> register_blocks(const Platform& platform) {
  std::vector<RegisterBlock> out;
  platform.each_registers([&](const std::string& name, BusTarget& target) {
    out.push_back(register_block(name, target));
  });
  return out;
}

std::unique_ptr<RegisterLog> register_log(std::vector<RegisterBlock> blocks, bus::ConfigBus& bus,
                                          cpu::Core& core,
                                          std::function<std::string(std::uint32_t)> describe) {
  return std::make_unique<RegisterLog>(
      std::move(blocks),
      RegisterLog::Sources{[] { return kernel_time(); }, [&bus] { return bus.accessing(); },
                           [&core] { return core.current_pc(); }, std::move(describe)});
}

void join_bus(GdbViews& v, bus::Scr& scr, mem::DdrModule& ddr, cpu::Arm926& arm, EndOfInstant& end_of_instant,
              std::uint32_t ddr_base) {
  v.masters = std::make_unique<GdbMasters>(scr.crossbar(), ddr.controller(), ddr_base);
  v.now = [] { return kernel_time(); };
  v.settle = [&scr] { scr.settle(); };
  v.at_next_event = [&end_of_instant](std::function<void()> act) {
    const Picoseconds now = kernel_time(), next = kernel_horizon();
    const Picoseconds at = next == kNever ? now : next;
    end_of_instant.at(at, InstantRank::kObservers, std::move(act));
    return at;
  };
  v.catch_up = [&arm] { arm.catch_up(); };
  v.pause_at = [pause = std::make_shared<Pause>("debugger_pause")](Picoseconds at) {
    pause->at(at);
  };
}

GdbViews board_views(board::Board& board, const ParamSet& params, RegisterLog* log) {
  auto& soc = board.dm365;
  GdbViews v;
  v.params = &params;
  v.memory = {{0, kInternal},
              {kDataWindow, kDataWindow + kInternal},
              {DDR_BASE, DDR_BASE + soc.ddr.store().size()}};
  v.blocks = register_blocks(board.platform);
  v.log = log;
  join_bus(v, soc.scr, soc.ddr, soc.arm, soc.end_of_instant, DDR_BASE);
  v.stats = [&board] {
    auto& chip = board.dm365;
    std::vector<StatRow> rows;
    cpu::CoreStats core;
    core.to = chip.arm.core().counts();
    core.to.cycles = chip.arm.core().clock_count();
    collect(core, rows);
    board.platform.each_statistics([&](const StatGroup& group) { collect(group, rows); });
    return rows;
  };
  return v;
}

}  // namespace fovea::app
