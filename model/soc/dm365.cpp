#include "model/soc/dm365.h"

#include <algorithm>

namespace fovea::soc {
namespace {

using bus::ConfigBus;
constexpr auto kFast = ConfigBus::Speed::kFast;
constexpr auto kSlow = ConfigBus::Speed::kSlow;

/// Register blocks (dm365.md 2.1). Slow: blocks on the 24 MHz AUXCLK.
const std::vector<ConfigBus::BlockSpec> kRegisterMap = {
    {"ddr", 0x2000'0000, 0x8000, kFast},
    {"edma", 0x01C0'0000, 0x1'0000, kFast},
    {"uart0", 0x01C2'0000, 0x400, kSlow},
    {"uart1", 0x01D0'6000, 0x400, kFast},
    {"timer0", 0x01C2'1400, 0x400, kSlow},
    {"timer1", 0x01C2'1800, 0x400, kSlow},
    {"timer2", 0x01C2'0800, 0x400, kSlow},
    {"timer3", 0x01C2'3800, 0x400, kSlow},
    {"i2c", 0x01C2'1000, 0x400, kSlow},
    {"system", 0x01C4'0000, 0x800, kFast},
    {"pll1", 0x01C4'0800, 0x400, kFast},
    {"pll2", 0x01C4'0C00, 0x400, kFast},
    {"psc", 0x01C4'1000, 0x1000, kFast},
    {"aintc", 0x01C4'8000, 0x400, kFast},
    {"gpio", 0x01C6'7000, 0x800, kFast},
    {"vpss", 0x01C7'0000, 0x400, kFast},
    {"isif", 0x01C7'1000, 0x200, kFast},
    {"osd", 0x01C7'1C00, 0x100, kFast},
    {"venc", 0x01C7'1E00, 0x200, kFast},
};

bus::AddressMap address_map(const mem::DdrParams& ddr, std::size_t internal_bytes) {
  bus::AddressMap map;
  map.ddr_size = ddr.size_bytes();
  map.ram_size = static_cast<std::uint32_t>(internal_bytes);
  return map;
}

/// Names for the core's stalls. All register blocks are one.
cpu::RegionMap regions(const bus::AddressMap& map, std::size_t internal_bytes) {
  cpu::RegionMap out;
  out.add("itcm", 0, internal_bytes);
  out.add("dtcm", 0x1'0000, internal_bytes);
  out.add("sdram", map.ddr_base, map.ddr_size);
  for (const auto& block : kRegisterMap) out.add("registers", block.base, block.size);
  return out;
}

}  // namespace

void Dm365Params::declare(ParamSet& set) {
  cpu.declare(set);
  set.add(crossbar);
  for (auto& port : crossbar.ports) set.add(*port);
  set.add(config_bus);
  for (auto& load : loads) set.add(load);
  set.add(ddr);
  set.add(edma);
  set.add(pll);
  set.add(psc);
  set.add(system);
  set.add(aintc);
  set.add(vpss);
}

Dm365::Dm365(sc_core::sc_module_name name, const Dm365Params& params, std::uint32_t entry,
             bool strict)
    : sc_module(name),
      arm("arm", params.cpu, internal_ram, entry),
      tcm_dma("tcm_dma", arm.core(), quiet),
      scr("scr", params.crossbar, address_map(params.ddr, internal_ram.size()), strict),
      config("config", params.config_bus, quiet, kRegisterMap),
      ddr("ddr", params.ddr),
      edma("edma", params.edma),
      pll1("pll1", "PLLC1", 9, params.pll),
      pll2("pll2", "PLLC2", 5, params.pll),
      psc("psc", params.psc),
      system("system", params.system),
      aintc("aintc", params.aintc),
      isif("isif", params.vpss),
      osd("osd", params.vpss),
      venc("venc", params.vpss),
      params_(params) {
  SC_HAS_PROCESS(Dm365);
  for (unsigned i = 0; i < timers.size(); ++i)
    timers[i] = std::make_unique<periph::Timer64>(("timer" + std::to_string(i)).c_str());
  for (std::size_t i = 0; i < params.loads.size(); ++i)
    if (params.loads[i].active())
      loads.push_back(std::make_unique<bus::LoadGenerator>(
          i == 0 ? "load" : ("load" + std::to_string(i)).c_str(), params.loads[i]));
  arm.core().set_regions(
      regions(address_map(params.ddr, internal_ram.size()), internal_ram.size()));
  wire_clocks();
  wire_memory();
  wire_registers();
  wire_interrupts();
  wire_video();
  SC_METHOD(route_priorities);
  sensitive << mstpri0_;
  for (auto& level : tc_priority_) sensitive << level;
}

void Dm365::wire_clocks() {
  pll1.osc(osc);
  pll2.osc(osc);
  clocks.osc(osc);
  for (unsigned i = 0; i < 9; ++i) pll1.sysclk[i](pll1_clk_[i]);
  for (unsigned i = 0; i < 5; ++i) pll2.sysclk[i](pll2_clk_[i]);
  clocks.pll1_sysclk2(pll1_clk_[1]);
  clocks.pll1_sysclk4(pll1_clk_[3]);
  clocks.pll1_sysclk5(pll1_clk_[4]);
  clocks.pll1_sysclk6(pll1_clk_[5]);
  clocks.pll1_sysclk7(pll1_clk_[6]);
  clocks.pll2_sysclk2(pll2_clk_[1]);
  clocks.pll2_sysclk3(pll2_clk_[2]);
  clocks.pll2_sysclk5(pll2_clk_[4]);
  clocks.peri_clk_ctrl(peri_clk_ctrl_);
  clocks.vpss_clk_ctrl(vpss_clk_ctrl_);
  system.peri_clk_ctrl(peri_clk_ctrl_);
  system.vpss_clk_ctrl(vpss_clk_ctrl_);
  system.mstpri0(mstpri0_);
  pll1.locked(pll1_locked_);
  pll2.locked(pll2_locked_);
  system.pll1_locked(pll1_locked_);
  system.pll2_locked(pll2_locked_);

  clocks.arm_clk(arm_clk_);
  clocks.ddr_clk(ddr_clk_);
  clocks.edma_clk(edma_clk_);
  clocks.vpss_clk(vpss_clk_);
  clocks.venc_clk(venc_clk_);
  clocks.aux_clk(aux_clk_);
  clocks.uart1_clk(uart1_clk_);
  arm.clk(arm_clk_);
  tcm_dma.clk(arm_clk_);
  tap.core_clk(arm_clk_);
  tap.scr_clk(edma_clk_);
  tap.ddr_clk(ddr_clk_);
  scr.clk(edma_clk_);
  ddr.ddr_clk(ddr_clk_);
  ddr.scr_clk(edma_clk_);
  venc.clock(venc_clk_);
  for (auto& t : timers) t->clk(aux_clk_);
  uart0.clk(aux_clk_);
  uart1.clk(uart1_clk_);
  i2c.clk(aux_clk_);
  gpio.clk(edma_clk_);

  for (unsigned i = 0; i < periph::kLpscCount; ++i) psc.enabled[i](lpsc_[i]);
  ddr.enabled(lpsc_[periph::kLpscDdr]);
  edma.lpsc(lpsc_[periph::kLpscTpcc]);
  uart0.lpsc(lpsc_[periph::kLpscUart0]);
  uart1.lpsc(lpsc_[periph::kLpscUart1]);
  i2c.lpsc(lpsc_[periph::kLpscI2c]);
  gpio.lpsc(lpsc_[periph::kLpscGpio]);
  timers[0]->lpsc(lpsc_[periph::kLpscTimer0]);
  timers[1]->lpsc(lpsc_[periph::kLpscTimer1]);
  timers[2]->lpsc(lpsc_[periph::kLpscTimer2]);
  timers[3]->lpsc(lpsc_[periph::kLpscTimer3]);
  for (auto* p : {&vpss.psc_enabled, &isif.psc_enabled, &osd.psc_enabled, &venc.psc_enabled})
    (*p)(lpsc_[periph::kLpscVpss]);
}

void Dm365::wire_memory() {
  arm.path(scr.path);
  arm.sockets[cpu::Arm926::kInstructionPort]->bind(*scr.target[index(Master::kArmI)]);
  arm.sockets[cpu::Arm926::kDataPort]->bind(*scr.target[index(Master::kArmD)]);
  isif.memory.socket.bind(*scr.target[index(Master::kVpfe)]);
  osd.memory.socket.bind(*scr.target[index(Master::kVpbe)]);
  for (auto& load : loads) {
    load->bind_ports([this](auto& socket, Master m) { socket.bind(*scr.target[index(m)]); });
    load->sdram_initialised(ddr.initialised);
  }
  std::vector<Master> masters{Master::kArmI, Master::kArmD, Master::kVpfe, Master::kVpbe};
  for (const auto& load : params_.loads)
    if (load.active()) masters.push_back(load.reader());
  for (const Master m : masters)
    waits.push_back(std::make_unique<bus::WaitStats>(
        m, std::vector<WaitTable*>{&scr.crossbar().waits, &ddr.controller().waits}));
  scr.ddr_socket.bind(ddr.socket);
  scr.ram_socket.bind(tcm_dma.socket);
  scr.ddr_lookahead.bind(ddr.lookahead);
  for (std::size_t i = 0; i < kMasterCount; ++i) scr.priority[i](priority_[i]);
  vpss.write_priority(priority_[index(Master::kVpfe)]);
  vpss.read_priority(priority_[index(Master::kVpbe)]);
  for (unsigned tc = 0; tc < kTransferControllers; ++tc) edma.priority[tc](tc_priority_[tc]);
}

void Dm365::wire_registers() {
  scr.config_socket.bind(config.socket);
  config.to("ddr").bind(ddr.reg_socket);
  config.to("edma").bind(edma.reg_socket);
  config.to("uart0").bind(uart0.reg_socket);
  config.to("uart1").bind(uart1.reg_socket);
  for (unsigned i = 0; i < timers.size(); ++i)
    config.to("timer" + std::to_string(i)).bind(timers[i]->reg_socket);
  config.to("i2c").bind(i2c.reg_socket);
  config.to("system").bind(system.reg_socket);
  config.to("pll1").bind(pll1.reg_socket);
  config.to("pll2").bind(pll2.reg_socket);
  config.to("psc").bind(psc.reg_socket);
  config.to("aintc").bind(aintc.reg_socket);
  config.to("gpio").bind(gpio.reg_socket);
  config.to("vpss").bind(vpss.reg_socket);
  config.to("isif").bind(isif.reg_socket);
  config.to("osd").bind(osd.reg_socket);
  config.to("venc").bind(venc.reg_socket);
}

void Dm365::wire_interrupts() {
  for (unsigned i = 0; i < 64; ++i) aintc.source[i](irq_[i]);
  aintc.irq(arm_irq_);
  aintc.fiq(arm_fiq_);
  arm.irq(arm_irq_);
  arm.fiq(arm_fiq_);
  tap.irq(arm_irq_);
  tap.fiq(arm_fiq_);
  for (unsigned i = 0; i < video::VpssTop::kOutputs; ++i) vpss.vpssint[i](irq_[i]);
  timers[0]->tint12(irq_[32]);
  timers[0]->tint34(irq_[33]);
  timers[1]->tint12(irq_[34]);
  timers[1]->tint34(irq_[35]);
  i2c.irq(irq_[39]);
  uart0.irq(irq_[40]);
  uart1.irq(irq_[41]);
  for (unsigned i = 0; i < 8; ++i) gpio.irq[i](irq_[44 + i]);
}

void Dm365::wire_video() {
  for (unsigned i = 0; i < 3; ++i) {
    isif.vdint[i].out(vdint_[i]);
    vpss.isif_int[i](vdint_[i]);
  }
  venc.interrupt.out(venc_int_);
  vpss.venc_int(venc_int_);
  vpss.isif_gate(isif_gate_);
  vpss.vpbe_gate(vpbe_gate_);
  vpss.venc_gate(venc_gate_);
  isif.gate(isif_gate_);
  osd.gate(vpbe_gate_);
  venc.vpbe_gate(vpbe_gate_);
  venc.venc_gate(venc_gate_);
  venc.osd.bind(osd.lines);
  venc.display(display);
}

std::unique_ptr<trace::BusRecorder> Dm365::make_recorder() {
  using trace::Pace;
  const auto places = [](const IntParam& p) { return static_cast<unsigned>(p()); };
  const unsigned captured = places(params_.vpss.write_buffer_bursts);
  const unsigned shown = places(params_.vpss.read_outstanding);
  std::vector<trace::BusRecorder::MasterSetup> masters = {
      {Master::kArmI, Pace::kCore, 1, 1, true},
      {Master::kArmD, Pace::kCore, 1, 1, true},
      {Master::kVpfe, Pace::kSampled, captured, captured, true},
      {Master::kVpbe, Pace::kLines, shown, shown, true}};
  for (const auto& load : params_.loads) {
    if (!load.active()) continue;
    const unsigned n = places(load.outstanding);
    if (load.reader() == load.writer()) {
      masters.push_back({load.reader(), Pace::kRepeating, n, n, true});
    } else {
      // Both sides: a copy's wait for each other, a mixture's take each other's places.
      if (load.reads())
        masters.push_back({load.reader(), Pace::kRepeating, n, n, true, {}});
      if (load.writes())
        masters.push_back({load.writer(), load.copies() ? Pace::kData : Pace::kRepeating, n, n,
                           true, {}});
      if (load.reads() && load.writes()) {
        masters[masters.size() - 2].partner = load.writer();
        masters.back().partner = load.reader();
      }
    }
  }
  auto recorder = std::make_unique<trace::BusRecorder>(
      masters, places(params_.cpu.ahb_ratio), [this] {
        const cpu::Counts& c = arm.core().counts();
        const auto writes = static_cast<std::size_t>(cpu::Cause::kWriteBuffer);
        return trace::CoreState{c.idle, c.stall[writes]};
      });
  scr.crossbar().observe(recorder.get());
  tap.attach(recorder.get());
  return recorder;
}

/// MSTPRI0.2:0 is the ARM's memory priority. The remap engine is no part of the chip: it takes
/// MJCP's place, the imaging coprocessor's (assumed). A transfer controller has one priority for both
/// sides.
void Dm365::route_priorities() {
  const std::uint32_t mstpri0 = mstpri0_.read();
  priority_[index(Master::kArmI)].write(mstpri0 & 7u);
  priority_[index(Master::kArmD)].write(mstpri0 & 7u);
  priority_[index(Master::kRemapEngine)].write(mstpri0 >> 16 & 7u);
  for (unsigned tc = 0; tc < kTransferControllers; ++tc) {
    priority_[index(edma_read(tc))].write(tc_priority_[tc].read());
    priority_[index(edma_write(tc))].write(tc_priority_[tc].read());
  }
  std::uint32_t load = 7;
  for (const auto& l : params_.loads)
    if (l.active() && l.reader() == Master::kLoad)
      load = static_cast<std::uint32_t>(l.priority());
  priority_[index(Master::kLoad)].write(load);
}

}  // namespace fovea::soc
