#include "model/soc/dm365.h"

#include <algorithm>
#include <utility>

#include "model/soc/edma_events.h"
#include "model/soc/memory_map.h"

namespace fovea::soc {
namespace {

bus::AddressMap address_map(std::size_t internal_bytes) {
  bus::AddressMap map;
  map.ram_size = static_cast<std::uint32_t>(internal_bytes);
  return map;
}

/// The regions by which the core's stalls are counted. All register blocks of the chip share one name.
cpu::RegionMap regions(const Dm365Params& params, std::size_t internal_bytes) {
  cpu::RegionMap out;
  out.add("itcm", INTERNAL_RAM_BASE, internal_bytes);
  out.add("dtcm", INTERNAL_RAM_DATA_BASE, internal_bytes);
  out.add("sdram", bus::AddressMap().ddr_base, params.ddr.size_bytes());
  for (const Placement& row : rows_present(params.rows, params.block_params))
    out.add("registers", row.base, row.size);
  return out;
}

Placements joined(Placements rows, const Placements& more) {
  rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

}  // namespace

Dm365::Dm365(sc_core::sc_module_name name, const Dm365Params& params, std::uint32_t entry, bool strict,
             const Placements& external)
    : sc_module(name),
      arm("arm", params.cpu, internal_ram, entry),
      tcm_dma("tcm_dma", arm.core(), end_of_instant),
      scr("scr", params.crossbar, params.ddr, address_map(internal_ram.size()), strict),
      config("config", params.config_bus, end_of_instant,
             bus_blocks(joined(rows_present(params.rows, params.block_params), external))),
      placed(joined(rows_present(params.rows, params.block_params), external), params.block_params, scr.memory()),
      params_(params) {
  SC_HAS_PROCESS(Dm365);
  for (std::size_t i = 0; i < params.loads.size(); ++i)
    if (params.loads[i].active())
      loads.push_back(std::make_unique<bus::LoadGenerator>(
          i == 0 ? "load" : ("load" + std::to_string(i)).c_str(), params.loads[i]));
  arm.core().set_regions(regions(params, internal_ram.size()));
  list_blocks();
  wire_clocks();
  wire_memory();
  wire_interrupts();
  wire_edma();
  wire_video();
  SC_METHOD(route_priorities);
  sensitive << mstpri0_;
  for (std::size_t i = 0; i < tc_priority_.size(); ++i) sensitive << tc_priority_[i];
  SC_METHOD(set_wait_states);
  sensitive << misc_;
  dont_initialize();
  SC_METHOD(edma_events_selected);
  sensitive << edma_evtmux_;
  dont_initialize();
  SC_METHOD(watch_reset);
  sensitive << reset_asked_ << misc_;
  dont_initialize();
}

void Dm365::list_blocks() {
  add_statistics(stats);
  platform.add("arm", arm);
  platform.add("scr", scr);
  platform.add("waits", *this);
  platform.add("config", config);
  platform.add("tcm_dma", tcm_dma);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    platform.add(placed.row(i).name, placed.block(i));
    connect(placed.row(i), placed.block(i));
  }
  for (auto& load : loads) platform.add(load->basename(), *load);
}

/// Binds what the row says of a block to what the block says of itself.
void Dm365::connect(const Placement& row, BusTarget& block) {
  config.to(row.name).bind(block.reg_socket);
  FOVEA_CHECK(block.clocks().empty() || row.clock != BlockClock::kNone,
              "no clock in the row of " + row.name);
  for (ClockIn* port : block.clocks()) (*port)(signal_of(row.clock));
  if (row.lpsc) {
    for (PowerGateIn* port : block.power_gates()) (*port)(lpsc_[*row.lpsc]);
    block.set_gate("PSC module " + std::to_string(*row.lpsc) + ", " + row.title);
  }
  FOVEA_CHECK(row.irqs.size() == block.interrupts().size(),
              "the row of " + row.name + " has another number of interrupts than the block");
  for (std::size_t i = 0; i < row.irqs.size(); ++i)
    connect(row.irqs[i], *block.interrupts()[i].port);
}

/// A source reaches its input of the interrupt controller directly, or as one of the two sources of a
/// multiplexer.
void Dm365::connect(Irq line, InterruptOut& source) {
  FOVEA_CHECK(irqs_taken_.emplace(line.input, line.second).second,
              "two blocks on interrupt " + std::to_string(line.input));
  const auto choice = periph::InterruptMux::find_choice(line.input);
  if (!choice) {
    FOVEA_CHECK(!line.second, "ARM_INTMUX has no choice for interrupt " + std::to_string(line.input));
    source(irq_[line.input]);
    return;
  }
  auto& signal = signal_of(line);
  source(signal);
  (line.second ? interrupt_mux.second : interrupt_mux.first)[*choice](signal);
}

/// The wire of an interrupt source, before any multiplexer.
sc_core::sc_signal<bool>& Dm365::signal_of(Irq line) {
  const auto choice = periph::InterruptMux::find_choice(line.input);
  return choice ? irq_source_[2 * *choice + line.second] : irq_[line.input];
}

ClockSignal& Dm365::signal_of(BlockClock clock) {
  switch (clock) {
    case BlockClock::kEdma:
      return edma_clk_;
    case BlockClock::kAux:
      return aux_clk_;
    case BlockClock::kUart1:
      return uart1_clk_;
    case BlockClock::kVenc:
      return venc_clk_;
    case BlockClock::kNone:
      break;
  }
  FOVEA_CHECK(false, "no such clock");
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
  system.edma_evtmux(edma_evtmux_);
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

  for (unsigned i = 0; i < periph::kLpscCount; ++i) psc.enabled[i](lpsc_[i]);
}

/// Binds the port of a master: to its block, or to its block and a load.
void Dm365::connect(const MasterInfo& m, const std::vector<MemInitiatorSocket<32>*>& sockets) {
  if (sockets.empty()) return;
  FOVEA_CHECK(sockets.size() <= 2, "three blocks on the port of " + std::string(m.name));
  if (sockets.size() == 1) {
    sockets[0]->bind(*scr.target[index(m.id)]);
  } else {
    const std::string name = "shared_" + std::string(m.name);
    auto& port = *shared_ports.emplace_back(std::make_unique<bus::SharedPort>(name.c_str()));
    sockets[0]->bind(port.first);
    sockets[1]->bind(port.second);
    port.port.bind(*scr.target[index(m.id)]);
  }
  for (const auto& w : waits)
    if (w->is_of(m.id)) return;
  waits.push_back(std::make_unique<bus::WaitStats>(
      m.id, std::vector<WaitTable*>{&scr.crossbar().waits, &ddr.controller().waits()}));
  add_statistics(*waits.back());
}

void Dm365::wire_memory() {
  arm.path(scr.path);
  std::array<std::vector<MemInitiatorSocket<32>*>, kMasterCount> sockets;
  platform.each_master([&](const MasterPort& p) { sockets[index(p.id)].push_back(p.socket); });
  for (const MasterInfo& m : kMasters.rows) connect(m, sockets[index(m.id)]);
  const auto shared = [&sockets](Master m) { return sockets[index(m)].size() > 1; };
  for (unsigned n = 0; n < kTransferControllers; ++n)
    if (shared(edma_read(n)) || shared(edma_write(n))) edma_tcs[n]->report_in_kernel_time();
  for (auto& load : loads) load->sdram_initialised(ddr.initialised);
  scr.config_socket.bind(config.socket);
  config.describe = [this](std::uint32_t address) {
    const BlockParams& params = params_.block_params;
    const std::string absent = absent_at(address, rows_present(params_.rows, params, false));
    return absent.empty() ? not_modelled_at(address, rows_present(params_.rows, params)) : absent;
  };
  scr.ram_socket.bind(tcm_dma.socket);
  tcm_dma.path(scr.path);
  for (std::size_t i = 0; i < kMasterCount; ++i) scr.priority[i](priority_[i]);
  vpss.write_priority(priority_[index(master_with(PrioritySource::kVideoWrite))]);
  vpss.read_priority(priority_[index(master_with(PrioritySource::kVideoRead))]);
  for (unsigned tc = 0; tc < kTransferControllers; ++tc) edma.priority[tc](tc_priority_[tc]);
}

/// Events that an interrupt's wire carries come from there; UARTs, I2C and VPSS have events of their own.
void Dm365::wire_edma() {
  for (const EdmaEvent& e : kEdmaEvents) {
    if (e.wire != EdmaEvent::Wire::kInterrupt) continue;
    sc_core::sc_spawn_options options;
    options.spawn_method();
    options.dont_initialize();
    options.set_sensitivity(&signal_of({e.input, e.second_source_of_input}).posedge_event());
    sc_core::sc_spawn([this, channel = e.channel] { edma_event(channel); },
                      ("edma_event" + std::to_string(e.channel)).c_str(), &options);
  }
  const auto send = [this](unsigned channel) { return [this, channel] { edma_event(channel); }; };
  vpss.on_event = [this](unsigned n) { edma_event(kVpssEvent1 + n - 1); };
  uart0.on_receive_event = send(kUart0Receive);
  uart0.on_transmit_event = send(kUart0Receive + 1);
  uart1.on_receive_event = send(kUart1Receive);
  uart1.on_transmit_event = send(kUart1Receive + 1);
  i2c.on_receive_event = send(kI2cReceive);
  i2c.on_transmit_event = send(kI2cReceive + 1);
  edma.on_events_enabled = [this](std::uint64_t events) { edma_events_enabled(events); };
  for (dma::EdmaTc* tc : edma_tcs) {
    tc->attach(edma);
    tc->misc(misc_);
  }
}

/// An event of the first source of a channel. All second sources are blocks that are not modelled.
void Dm365::edma_event(unsigned channel) {
  const EdmaEvent& e = kEdmaEvents[channel];
  if (e.has_choice() && edma_evtmux_.read() >> e.bit & 1) return;
  edma.event(channel);
}

void Dm365::edma_events_selected() {
  for (const EdmaEvent& e : kEdmaEvents)
    if (e.has_choice() && edma_evtmux_.read() >> e.bit & 1)
      diagnostics().not_modelled("EDMA_EVTMUX bit " + std::to_string(e.bit) + " gives EDMA event " +
                                 std::to_string(e.channel) + " to " + std::string(e.second) + ", which is silent here");
}

/// An event whose source is not modelled never comes.
void Dm365::edma_events_enabled(std::uint64_t events) {
  for (const EdmaEvent& e : kEdmaEvents) {
    const bool second = e.has_choice() && edma_evtmux_.read() >> e.bit & 1;
    if (!(events >> e.channel & 1) || (e.wire != EdmaEvent::Wire::kNone && !second)) continue;
    diagnostics().not_modelled("EESR enables EDMA event " + std::to_string(e.channel) + " of " +
                               std::string(second ? e.second : e.first) + ", which is silent here");
  }
}

void Dm365::wire_interrupts() {
  for (unsigned i = 0; i < 64; ++i) aintc.source[i](irq_[i]);
  aintc.irq(arm_irq_);
  aintc.fiq(arm_fiq_);
  arm.core().wake_event = [this] { return wake_event(); };
  arm.irq(arm_irq_);
  arm.fiq(arm_fiq_);
  tap.irq(arm_irq_);
  tap.fiq(arm_fiq_);
  interrupt_mux.arm_intmux(arm_intmux_);
  for (std::size_t i = 0; i < periph::kInterruptChoices.size(); ++i)
    interrupt_mux.out[i](irq_[periph::kInterruptChoices[i].interrupt]);
  timers[2]->expired(reset_asked_);
}

/// MISC.ARM_WAITST: 1 no wait state, 0 one.
void Dm365::set_wait_states() {
  const bool one = (misc_.read() & 1u) == 0;
  arm.core().set_tcm_wait_states(static_cast<unsigned>(params_.cpu.tcm_wait_states()) + one);
}

/// TIMER2's reset request leaves the timer only while MISC.TIMER2_WDT says that it is the watchdog.
void Dm365::watch_reset() {
  constexpr std::uint32_t kTimer2Wdt = 1u << 4;
  if (reset_asked_.read() && (misc_.read() & kTimer2Wdt) && on_reset_request)
    on_reset_request(timers[2]->reset_cause());
}

void Dm365::reset_chip(ResetKind kind) {
  end_of_instant.at(kernel_time(), InstantRank::kReset, [this, kind] { begin_reset(kind); });
}

void Dm365::begin_reset(ResetKind kind) {
  const bool already = reset_under_way_.has_value();
  reset_under_way_ = kind;
  ++stats.resets;
  for (const Platform::Entry& e : platform.blocks()) e.block->reset(kind);
  if (!already)
    end_of_instant.at(kernel_time() + params_.system.reset_time(), InstantRank::kReset,
                      [this] { end_reset(); });
}

void Dm365::end_reset() {
  for (const Platform::Entry& e : platform.blocks())
    if (!e.block->idle())
      return end_of_instant.at(kernel_time() + params_.system.reset_time(), InstantRank::kReset,
                               [this] { end_reset(); });
  const ResetKind kind = *std::exchange(reset_under_way_, std::nullopt);
  if (kind == ResetKind::kPowerOn) {
    internal_ram.fill(0);
    ddr.store().clear();
  }
  boot_observers_.each([kind](const BootObserver& f) { f(kind); });
  for (const Platform::Entry& e : platform.blocks()) e.block->leave_reset();
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

Dm365::Recording Dm365::record_bus() {
  for (dma::EdmaTc* tc : edma_tcs) tc->report_in_kernel_time();
  const auto ratio = static_cast<unsigned>(params_.cpu.ahb_ratio());
  std::vector<trace::BusRecorder::MasterSetup> masters;
  for (const Platform::Entry& e : platform.blocks())
    for (const MasterPort& p : e.block->masters()) {
      if (p.outstanding == 0) continue;
      const auto shared = std::find_if(masters.begin(), masters.end(),
                                       [&](const auto& m) { return m.id == p.id; });
      if (shared != masters.end()) {  // a load on the port of a block
        if (p.pace != Pace::kTransfers) shared->pace = p.pace;
        shared->reads = shared->writes = std::min(shared->reads + p.outstanding, kMostOutstanding);
        continue;
      }
      auto& setup = masters.emplace_back(trace::BusRecorder::MasterSetup{
          p.id, p.pace, p.outstanding, p.outstanding, true, {}});
      // The sides of one block wait for each other's completions.
      for (const MasterPort& other : e.block->masters())
        if (other.outstanding > 0 && master_info(p.id).partner == other.id) setup.partner = other.id;
    }
  // A load on one side of a transfer controller: neither side's requests are those of its transfers alone.
  for (auto& m : masters) {
    const auto partner = std::find_if(masters.begin(), masters.end(), [&](const auto& o) { return m.partner == o.id; });
    if (m.pace == Pace::kTransfers && (partner == masters.end() || partner->pace != Pace::kTransfers))
      m.pace = Pace::kRepeating;
  }
  edma.accessing = [this] { return config.accessing(); };
  auto recorder = std::make_unique<trace::BusRecorder>(
      masters, ratio, [this](const MemRequest* r) {
        const cpu::Core& core = arm.core();
        trace::CoreState s{core.counts().idle, core.room_waits(), core.drains()};
        s.origin = core.clock().edge_at_or_after(0);
        s.woke = core.woke();
        if (r) {
          const cpu::BusAccess& a = cpu::Arm926::access_of(*r);
          s.asked = a.asked;
          s.victim = r->write && a.victim;
        }
        return s;
      },
      transfer_surroundings());
  trace::BusRecorder& to = *recorder;
  arm.core().watch_ram(&to);
  return {std::move(recorder), scr.crossbar().observe(to), tap.attach(to), edma.observe(to),
          Subscription([this] { arm.core().watch_ram(nullptr); })};
}

trace::Surroundings Dm365::transfer_surroundings() {
  const auto whole = [](const IntParam& p) { return static_cast<unsigned>(p()); };
  return {{whole(params_.edma.request_clocks), whole(params_.edma_tc.fifo), whole(params_.edma_tc.depth),
           whole(params_.cpu.tcm_dma_latency), whole(params_.cpu.tcm_dma_word_clocks),
           params_.config_bus.fast_latency(), whole(params_.cpu.tcm_banks), 1 + whole(params_.cpu.tcm_wait_states),
           params_.cpu.tcm_first.is("core")},
          [this](std::uint32_t address) { return config.latency_at(address); },
          [this](Master m) { return scr.crossbar().priority(m); },
          [this] {
            return edma.active() || std::any_of(edma_tcs.begin(), edma_tcs.end(),
                                                [](const dma::EdmaTc* tc) { return !tc->at_rest(); });
          }};
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
