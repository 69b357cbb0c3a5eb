#include "model/soc/dm365.h"

#include <algorithm>

#include "model/soc/memory_map.h"

namespace fovea::soc {
namespace {

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
  for (const auto& block : register_blocks()) out.add("registers", block.base, block.size);
  return out;
}

}  // namespace

namespace {

std::vector<bus::ConfigBus::BlockSpec> with(std::vector<bus::ConfigBus::BlockSpec> blocks,
                                            const std::vector<bus::ConfigBus::BlockSpec>& more) {
  blocks.insert(blocks.end(), more.begin(), more.end());
  return blocks;
}

}  // namespace

Dm365::Dm365(sc_core::sc_module_name name, const Dm365Params& params, std::uint32_t entry,
             bool strict, const std::vector<bus::ConfigBus::BlockSpec>& external)
    : sc_module(name),
      arm("arm", params.cpu, internal_ram, entry),
      tcm_dma("tcm_dma", arm.core(), quiet),
      scr("scr", params.crossbar, address_map(params.ddr, internal_ram.size()), strict),
      config("config", params.config_bus, quiet, with(register_blocks(), external)),
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
  list_blocks();
  wire_clocks();
  wire_memory();
  wire_registers();
  wire_interrupts();
  wire_video();
  SC_METHOD(route_priorities);
  sensitive << mstpri0_;
  for (auto& level : tc_priority_) sensitive << level;
  SC_METHOD(set_wait_states);
  sensitive << misc_;
  dont_initialize();
  SC_METHOD(watch_reset);
  sensitive << reset_asked_ << misc_;
  dont_initialize();
}

void Dm365::list_blocks() {
  platform.add("arm", arm);
  platform.add("scr", scr);
  platform.add("waits", *this);
  platform.add("config", config);
  platform.add("ddr", ddr);
  platform.add("edma", edma);
  platform.add("tcm_dma", tcm_dma);
  platform.add("uart0", uart0);
  platform.add("uart1", uart1);
  platform.add("i2c", i2c);
  platform.add("system", system);
  platform.add("pll1", pll1);
  platform.add("pll2", pll2);
  platform.add("psc", psc);
  platform.add("aintc", aintc);
  platform.add("gpio", gpio);
  for (std::size_t i = 0; i < timers.size(); ++i)
    platform.add("timer" + std::to_string(i), *timers[i]);
  platform.add("vpss", vpss);
  platform.add("isif", isif);
  platform.add("osd", osd);
  platform.add("venc", venc);
  for (std::size_t i = 0; i < loads.size(); ++i)
    platform.add(loads[i]->basename(), *loads[i]);
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
  system.misc(misc_);
  system.arm_intmux(arm_intmux_);
  system.uart0_pins(uart0_pins_);
  system.uart1_pins(uart1_pins_);
  system.i2c_pins(i2c_pins_);
  uart0.pins(uart0_pins_);
  uart1.pins(uart1_pins_);
  i2c.pins(i2c_pins_);
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
  // timers[2], the watchdog, has no gate: public code never disables LPSC 29 (Linux psc-dm365.c).
  timers[3]->lpsc(lpsc_[periph::kLpscTimer3]);
  timers[4]->lpsc(lpsc_[periph::kLpscTimer4]);
  for (auto* p : {&vpss.psc_enabled, &isif.psc_enabled, &osd.psc_enabled, &venc.psc_enabled})
    (*p)(lpsc_[periph::kLpscVpss]);
}

void Dm365::wire_memory() {
  arm.path(scr.path);
  platform.each_master([this](const MasterPort& p) {
    p.socket->bind(*scr.target[index(p.id)]);
    for (const auto& w : waits)
      if (w->is_of(p.id)) return;
    waits.push_back(std::make_unique<bus::WaitStats>(
        p.id, std::vector<WaitTable*>{&scr.crossbar().waits, &ddr.controller().waits}));
    add_statistics(*waits.back());
  });
  for (auto& load : loads) load->sdram_initialised(ddr.initialised);
  scr.ddr_socket.bind(ddr.socket);
  scr.ram_socket.bind(tcm_dma.socket);
  scr.ddr_lookahead.bind(ddr.lookahead);
  for (std::size_t i = 0; i < kMasterCount; ++i) scr.priority[i](priority_[i]);
  vpss.write_priority(priority_[index(master_with(PrioritySource::kVideoWrite))]);
  vpss.read_priority(priority_[index(master_with(PrioritySource::kVideoRead))]);
  for (unsigned tc = 0; tc < kTransferControllers; ++tc) edma.priority[tc](tc_priority_[tc]);
}

void Dm365::wire_registers() {
  scr.config_socket.bind(config.socket);
  config.describe = not_modelled_at;
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
  interrupt_mux.arm_intmux(arm_intmux_);
  for (std::size_t i = 0; i < periph::kInterruptChoices.size(); ++i)
    interrupt_mux.out[i](irq_[periph::kInterruptChoices[i].interrupt]);
  // A block reaches its input directly, or as one of the two sources of a multiplexer.
  const auto first = [this](unsigned n) -> auto& {
    return interrupt_mux.first[periph::InterruptMux::choice_of(n)];
  };
  const auto second = [this](unsigned n) -> auto& {
    return interrupt_mux.second[periph::InterruptMux::choice_of(n)];
  };
  for (unsigned i = 0; i < video::VpssTop::kOutputs; ++i) {
    const bool shared = i == 0 || i == 7 || i == 8;
    vpss.vpssint[i](shared ? vpssint_[i] : irq_[i]);
    if (shared) first(i)(vpssint_[i]);
  }
  timers[0]->tint12(irq_[32]);  // TINT0
  timers[0]->tint34(irq_[33]);
  timers[1]->tint12(irq_[34]);
  timers[1]->tint34(irq_[35]);
  timers[2]->tint12(tint_[4]);
  second(13)(tint_[4]);
  timers[2]->tint34(irq_[14]);
  timers[3]->tint12(irq_[15]);
  timers[3]->tint34(irq_[22]);
  timers[4]->tint12(tint_[8]);
  second(38)(tint_[8]);
  timers[4]->tint34(tint_[9]);
  second(28)(tint_[9]);
  timers[2]->expired(reset_asked_);
  i2c.irq(irq_[39]);
  uart0.irq(irq_[40]);
  uart1.irq(irq_[41]);
  for (unsigned i = 0; i < 8; ++i) gpio.irq[i](irq_[44 + i]);
  for (unsigned i = 8; i < periph::kGpioDirectIrqs; ++i) {
    gpio.irq[i](gpio_irq_[i]);
    first(44 + i)(gpio_irq_[i]);
  }
}

/// MISC.ARM_WAITST: 1 no wait state, 0 one.
void Dm365::set_wait_states() {
  const bool one = (misc_.read() & 1u) == 0;
  arm.core().set_tcm_wait_states(static_cast<unsigned>(params_.cpu.tcm_wait_states()) + one);
}

/// TIMER2's reset request leaves the timer only while MISC.TIMER2_WDT says that it is the watchdog.
void Dm365::watch_reset() {
  constexpr std::uint32_t kTimer2Wdt = 1u << 4;
  if (reset_asked_.read() && (misc_.read() & kTimer2Wdt) && on_reset)
    on_reset(timers[2]->reset_cause());
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
  vpss.venc_clk_sel(venc_clk_sel_);
  vpss.isif_owns_write_buffer(isif_owns_write_buffer_);
  isif.gate(isif_gate_);
  isif.owns_write_buffer(isif_owns_write_buffer_);
  osd.gate(vpbe_gate_);
  venc.vpbe_gate(vpbe_gate_);
  venc.clk_sel(venc_clk_sel_);
  venc.osd.bind(osd.lines);
  venc.display(display);
}

std::unique_ptr<trace::BusRecorder> Dm365::make_recorder() {
  const auto ratio = static_cast<unsigned>(params_.cpu.ahb_ratio());
  std::vector<trace::BusRecorder::MasterSetup> masters;
  for (const Platform::Entry& e : platform.blocks())
    for (const MasterPort& p : e.block->masters()) {
      if (p.outstanding == 0) continue;
      auto& setup = masters.emplace_back(trace::BusRecorder::MasterSetup{
          p.id, p.pace, p.outstanding, p.outstanding, true, {}});
      // The sides of one block wait for each other's completions.
      for (const MasterPort& other : e.block->masters())
        if (other.outstanding > 0 && master_info(p.id).partner == other.id) setup.partner = other.id;
    }
  auto recorder = std::make_unique<trace::BusRecorder>(
      masters, ratio, [this](const MemRequest* r) {
        const cpu::Core& core = arm.core();
        trace::CoreState s{core.counts().idle, core.room_waits(), core.drains()};
        s.origin = core.clock().edge_at_or_after(0);
        if (r) {
          const cpu::BusAccess& a = cpu::Arm926::access_of(*r);
          s.asked = a.asked;
          s.victim = r->write && a.victim;
        }
        return s;
      });
  scr.crossbar().observe(recorder.get());
  tap.attach(recorder.get());
  return recorder;
}

/// Drives the priorities that come from the system module, the EDMA and parameters; the video
/// subsystem drives its own.
void Dm365::route_priorities() {
  const std::uint32_t mstpri0 = mstpri0_.read();
  for (const MasterInfo& m : kMasters.rows) {
    auto& priority = priority_[index(m.id)];
    switch (m.priority) {
      case PrioritySource::kArm:
        priority.write(mstpri0 & 7u);
        break;
      case PrioritySource::kImcop:
        priority.write(mstpri0 >> 16 & 7u);
        break;
      case PrioritySource::kQueue:
        priority.write(tc_priority_[m.unit].read());
        break;
      case PrioritySource::kParameter:
        priority.write(load_priority(m.id));
        break;
      case PrioritySource::kVideoRead:
      case PrioritySource::kVideoWrite:
        break;
    }
  }
}

std::uint32_t Dm365::load_priority(Master m) const {
  for (const bus::LoadParams& l : params_.loads)
    if (l.active() && l.reader() == m) return static_cast<std::uint32_t>(l.priority());
  return 7;
}

}  // namespace fovea::soc
