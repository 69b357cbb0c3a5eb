#include "sw/fovea/exec/exec_board.h"

#include <algorithm>

namespace fovea::app {
namespace {

/// How far the core may run without the host looking in.
constexpr Picoseconds kBeat = kPsPerMs;

/// The blocks that this machine has of the chip's.
const soc::Placements& rows() {
  static const soc::Placements all = soc::blocks_named({"ddr"});
  return all;
}

}  // namespace

ExecBoard::ExecBoard(sc_core::sc_module_name name, const ExecBoardParams& params,
                     const ExecMap& map, const ExecClocks& clocks, std::uint32_t entry)
    : sc_module(name),
      tcm_(std::span(internal_ram_).first(map.tcm ? internal_ram_.size() : 0)),
      ram_base_(map.ram_base),
      arm("arm", params.cpu, tcm_, entry),
      scr("scr", params.crossbar, params.ddr, {.ddr_base = map.ram_base}, false),
      config("config", params.config_bus, end_of_instant,
             soc::bus_blocks(rows())),
      ddr("ddr", params.ddr, scr.memory()),
      ddr_size_(map.ram_size),
      arm_clk_("arm_clk", clocks.core),
      ddr_clk_("ddr_clk", clocks.ddr),
      scr_clk_("scr_clk", clocks.scr) {
  SC_HAS_PROCESS(ExecBoard);
  arm.clk(arm_clk_);
  arm.irq(irq_);
  arm.fiq(fiq_);
  scr.clk(scr_clk_);
  ddr.ddr_clk(ddr_clk_);
  ddr.scr_clk(scr_clk_);
  ddr.enabled(on_);
  arm.path(scr.path);
  for (const MasterPort& p : arm.masters()) {
    p.socket->bind(*scr.target[index(p.id)]);
    add_statistics(*waits_.emplace_back(std::make_unique<bus::WaitStats>(
        p.id, std::vector<WaitTable*>{&scr.crossbar().waits, &ddr.controller().waits()})));
  }
  scr.config_socket.bind(config.socket);
  config.to("ddr").bind(ddr.reg_socket);
  for (std::size_t i = 0; i < kMasterCount; ++i) scr.priority[i](priority_[i]);
  platform.add("arm", arm);
  platform.add("scr", scr);
  platform.add("waits", *this);
  platform.add("config", config);
  platform.add("ddr", ddr);
  program_controller(clocks.ddr);
  SC_METHOD(beat);
}

std::vector<MemoryRegion> ExecBoard::register_regions() {
  std::vector<MemoryRegion> out;
  for (const soc::Placement& row : rows()) out.push_back({"registers", row.base, row.size});
  return out;
}

/// CL, latency and priority raise are those of the boot loader. The write to SDBCR ends the initialisation.
void ExecBoard::program_controller(Frequency ddr_clock) {
  const DdrRegisters words = ddr_registers(ddr_clock);
  auto& r = ddr.regs;
  const auto write = [&r](const Reg& reg, std::uint32_t value) { r.write(reg.offset(), 4, value); };
  write(r.sdbcr, 0x00D3'CA32);  // BOOTUNLOCK, for the type
  write(r.sdbcr, 0x0053'CA32);  // TIMUNLOCK
  write(r.sdtimr, words.sdtimr);
  write(r.sdtimr2, words.sdtimr2);
  write(r.sdrcr, words.sdrcr);
  write(r.ddrphycr, 0xC5);
  write(r.pbbpr, 0xFE);
  write(r.sdbcr, 0x0053'4A32);
}

/// A pending event bounds how far the core runs ahead; a program in a loop would never come back.
void ExecBoard::beat() { next_trigger(ps_time(kBeat)); }

bool ExecBoard::debug_read(std::uint32_t pa, std::span<std::uint8_t> to) {
  if (!holds(pa, to.size())) return false;
  ddr.controller().debug_read(pa - ram_base_, to.data(), static_cast<unsigned>(to.size()));
  return true;
}

bool ExecBoard::debug_write(std::uint32_t pa, std::span<const std::uint8_t> from) {
  if (!holds(pa, from.size())) return false;
  ddr.controller().debug_write(pa - ram_base_, from.data(), static_cast<unsigned>(from.size()));
  return true;
}

}  // namespace fovea::app
