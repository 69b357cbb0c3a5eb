// The TMS320DM365: wiring only. The constructor reads like the block diagram.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <systemc>
#include <vector>

#include "model/bus/config_bus.h"
#include "model/bus/load_generator.h"
#include "model/bus/scr.h"
#include "model/bus/shared_port.h"
#include "model/bus/wait_stats.h"
#include "model/common/block.h"
#include "model/common/end_of_instant.h"
#include "model/common/observers.h"
#include "model/contract/memory_map.h"
#include "model/cpu/arm926.h"
#include "model/cpu/tcm_dma.h"
#include "model/dma/edma_cc.h"
#include "model/dma/edma_tc.h"
#include "model/engine/engine_params.h"
#include "model/mem/ddr_module.h"
#include "model/periph/aintc.h"
#include "model/periph/clock_tree.h"
#include "model/periph/gpio.h"
#include "model/periph/i2c_controller.h"
#include "model/periph/interrupt_mux.h"
#include "model/periph/pll_controller.h"
#include "model/periph/psc.h"
#include "model/periph/system_module.h"
#include "model/periph/timer64.h"
#include "model/periph/uart16550.h"
#include "model/soc/placement.h"
#include "model/trace/bus_tap.h"
#include "model/video/isif.h"
#include "model/video/osd.h"
#include "model/video/venc.h"
#include "model/video/vpss_top.h"

namespace fovea::soc {

struct ChipStats : StatGroup {
  Counter resets{*this, "resets", "1", "resets of the running chip, by its watchdog or from outside"};
  ChipStats() : StatGroup("soc") {}
};

struct Dm365Params : ParamTree {
  explicit Dm365Params(Placements blocks = dm365_blocks()) : rows(std::move(blocks)) {
    for (const Placement& row : rows) row.declare(block_params);
  }
  Declared<cpu::CpuParams> cpu{*this};
  Declared<bus::CrossbarParams> crossbar{*this};
  Declared<bus::ConfigBusParams> config_bus{*this};
  std::array<Declared<bus::LoadParams>, 4> loads{
      {{*this, "load"}, {*this, "load.1"}, {*this, "load.2"}, {*this, "load.3"}}};

  /// The blocks that the chip has, and their parameters.
  Placements rows;
  BlockParams block_params{*this};
  mem::DdrParams& ddr = block_params.get<mem::DdrParams>();
  dma::EdmaParams& edma = block_params.get<dma::EdmaParams>();
  engine::EngineParams& engine = block_params.get<engine::EngineParams>();
  dma::EdmaTcParams& edma_tc = block_params.get<dma::EdmaTcParams>();
  periph::PllParams& pll = block_params.get<periph::PllParams>();
  periph::PscParams& psc = block_params.get<periph::PscParams>();
  periph::SystemParams& system = block_params.get<periph::SystemParams>();
  periph::AintcParams& aintc = block_params.get<periph::AintcParams>();
  video::VpssParams& vpss = block_params.get<video::VpssParams>();
};

/// Outside pins: osc, the decoder's video input, the display output, I2C, UART0, GPIO.
class Dm365 : public sc_core::sc_module, public Block {
 public:
  /// @param entry where the core starts: the code that loads the program does the ROM boot loader's work
  /// @param external the board's devices on the asynchronous memory interface
  Dm365(sc_core::sc_module_name name, const Dm365Params& params, std::uint32_t entry, bool strict,
        const Placements& external = {});

  ClockIn osc{"osc"};                                  ///< 24 MHz oscillator
  sc_core::sc_port<video::DisplayLineIf> display{"display"};

  /// The 32 KB internal RAM behind both TCM ports.
  std::array<std::uint8_t, INTERNAL_RAM_BYTES> internal_ram{};

  EndOfInstant end_of_instant{"end_of_instant"};
  cpu::Arm926 arm;
  cpu::TcmDma tcm_dma;
  bus::Scr scr;
  bus::ConfigBus config;
  /// All blocks with registers, as the rows have them; below, those that need more wires.
  PlacedBlocks placed;
  mem::DdrModule& ddr = placed.get<mem::DdrModule>("ddr");
  dma::EdmaCc& edma = placed.get<dma::EdmaCc>("edma");
  std::array<dma::EdmaTc*, kTransferControllers> edma_tcs{
      &placed.get<dma::EdmaTc>("edma_tc0"), &placed.get<dma::EdmaTc>("edma_tc1"),
      &placed.get<dma::EdmaTc>("edma_tc2"), &placed.get<dma::EdmaTc>("edma_tc3")};
  periph::PllController& pll1 = placed.get<periph::PllController>("pll1");
  periph::PllController& pll2 = placed.get<periph::PllController>("pll2");
  periph::Psc& psc = placed.get<periph::Psc>("psc");
  periph::SystemModule& system = placed.get<periph::SystemModule>("system");
  periph::Aintc& aintc = placed.get<periph::Aintc>("aintc");
  /// TIMER0 to TIMER4; TIMER2 is the watchdog.
  std::array<periph::Timer64*, 5> timers{
      &placed.get<periph::Timer64>("timer0"), &placed.get<periph::Timer64>("timer1"),
      &placed.get<periph::Timer64>("timer2"), &placed.get<periph::Timer64>("timer3"),
      &placed.get<periph::Timer64>("timer4")};
  periph::Uart16550& uart0 = placed.get<periph::Uart16550>("uart0");
  periph::Uart16550& uart1 = placed.get<periph::Uart16550>("uart1");
  periph::Gpio& gpio = placed.get<periph::Gpio>("gpio");
  periph::I2cController& i2c = placed.get<periph::I2cController>("i2c");
  video::VpssTop& vpss = placed.get<video::VpssTop>("vpss");
  video::Isif& isif = placed.get<video::Isif>("isif");
  video::Osd& osd = placed.get<video::Osd>("osd");
  video::Venc& venc = placed.get<video::Venc>("venc");
  periph::ClockTree clocks{"clocks"};
  periph::InterruptMux interrupt_mux{"interrupt_mux"};
  std::vector<std::unique_ptr<bus::LoadGenerator>> loads;
  trace::BusTap tap{"tap"};
  /// All blocks of the chip.
  Platform platform;

  /// The source of an input of the interrupt controller, as ARM_INTMUX and the VPSS select it now.
  struct InterruptSource {
    std::string name;  ///< block.interrupt, such as `edma.region0`
    cpu::WakeEvent event;
  };
  InterruptSource interrupt_source(unsigned input) const;
  /// What has ended the core's sleep: the source of its most urgent interrupt.
  cpu::WakeEvent wake_event() const;

  /// The watchdog asks for a reset of the chip, with the cause. The function that is set here calls
  /// reset_chip(), or ends the simulation at this instant.
  std::function<void(const std::string& cause)> on_reset_request;
  /// Resets all blocks at the end of the present instant. The core's first instruction follows after
  /// `system.reset_time`, or later if answers to requests from before the reset are still under way.
  void reset_chip(ResetKind kind);
  /// Called just before the core starts again: the observer that stands in for the ROM boot loader loads
  /// the program.
  using BootObserver = std::function<void(ResetKind kind)>;
  Subscription observe_boot(BootObserver observer) { return boot_observers_.add(std::move(observer)); }
  ChipStats stats;

  /// A recorder of the bus traffic, which gets requests, interrupts, transfers and what the core sees of them as
  /// long as it lives.
  struct Recording {
    std::unique_ptr<trace::BusRecorder> recorder;
    Subscription requests, interrupts, transfers, ram;
    trace::BusRecorder* operator->() const { return recorder.get(); }
  };
  Recording record_bus();

  /// Ports that a synthetic load shares with a block of the chip.
  std::vector<std::unique_ptr<bus::SharedPort>> shared_ports;
  /// Of the masters that are there.
  std::vector<std::unique_ptr<bus::WaitStats>> waits;

 private:
  void list_blocks();
  void connect(const Placement& row, BusTarget& block);
  void connect(Irq line, InterruptOut& source);
  void connect(const MasterInfo& m, const std::vector<MemInitiatorSocket<32>*>& sockets);
  ClockSignal& signal_of(BlockClock clock);
  trace::Surroundings transfer_surroundings();
  void route_priorities();
  std::uint32_t load_priority(Master m) const;
  void set_wait_states();
  void watch_reset();
  void begin_reset(ResetKind kind);
  void end_reset();
  void wire_clocks();
  void wire_memory();
  void wire_interrupts();
  void wire_edma();
  void edma_event(unsigned channel);
  void edma_events_selected();
  void edma_events_enabled(std::uint64_t events);
  sc_core::sc_signal<bool>& signal_of(Irq line);
  void wire_video();

  template <class T>
  using Signals = sc_core::sc_vector<sc_core::sc_signal<T>>;
  Signals<Frequency> pll1_clk_{"pll1_clk", 9}, pll2_clk_{"pll2_clk", 5};
  ClockSignal arm_clk_, ddr_clk_, edma_clk_, vpss_clk_, venc_clk_, aux_clk_, uart1_clk_;
  Signals<bool> lpsc_{"lpsc", periph::kLpscCount};
  Signals<bool> irq_{"irq", 64};
  Signals<bool> vdint_{"vdint", 3};
  /// From the blocks whose input of the interrupt controller has a choice of two sources.
  Signals<bool> irq_source_{"irq_source", 2 * periph::kInterruptChoices.size()};
  std::set<std::pair<unsigned, bool>> irqs_taken_;
  Signals<std::uint32_t> priority_{"priority", kMasterCount};
  Signals<std::uint32_t> tc_priority_{"tc_priority", kTransferControllers};
  sc_core::sc_signal<bool> arm_irq_, arm_fiq_, venc_int_, pll1_locked_, pll2_locked_, reset_asked_;
  sc_core::sc_signal<bool> uart0_pins_, uart1_pins_, i2c_pins_;
  sc_core::sc_signal<bool> isif_gate_, isif_owns_write_buffer_, vpbe_gate_, venc_clk_sel_;
  sc_core::sc_signal<std::uint32_t> mstpri0_, vpss_clk_ctrl_, peri_clk_ctrl_, misc_, arm_intmux_,
      edma_evtmux_;
  std::optional<ResetKind> reset_under_way_;
  Observers<BootObserver> boot_observers_;
  const Dm365Params& params_;
};

}  // namespace fovea::soc
