// The ARM926EJ-S as a SystemC module with its two AHB ports.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <systemc>

#include "model/bus/lookahead_initiator.h"
#include "model/common/block.h"
#include "model/common/sc_ports.h"
#include "model/cpu/core/bus_port.h"
#include "model/cpu/core/core.h"

namespace fovea::cpu {

/// SystemC wrapper of the core. The core runs on an SC_THREAD, so that a call that blocks can
/// suspend it at any bus access and resume it there. bus::LookaheadInitiator contains the rules of time.
class Arm926 final : public bus::LookaheadInitiator<Arm926>, public Block, private BusPort {
 public:
  static constexpr unsigned kInstructionPort = 0, kDataPort = 1;
  ClockIn clk{"clk"};
  sc_core::sc_in<bool> irq{"irq"}, fiq{"fiq"};

  Arm926(sc_core::sc_module_name name, const CpuParams& params, std::span<std::uint8_t> tcm,
         std::uint32_t entry);
  Core& core() { return core_; }
  const Core& core() const { return core_; }
  /// The message of the guest failure that ended the core and stopped the simulation; empty if none
  /// did.
  const std::string& failure() const { return failure_; }
  /// True while the core waits for an interrupt, at kernel time.
  bool asleep() const { return asleep_; }
  /// The core's access that belongs to one of its requests on the bus.
  static const BusAccess& access_of(const MemRequest& r) {
    return *static_cast<const Record*>(static_cast<const Transaction*>(r.owner))->access;
  }
  /// Waits until kernel time has reached the core's time. To be called from the core's own thread,
  /// at an instruction boundary.
  void catch_up();

  /// The core finishes its instruction, without effect on blocks in reset, and is held at the next
  /// boundary until leave_reset().
  void reset(ResetKind) override;
  bool idle() const override;
  void leave_reset() override;

 private:
  friend bus::LookaheadInitiator<Arm926>;
  void run();
  void stay_in_reset();
  void clock_changed();
  void take_clock();
  void interrupt_changed();

  void submit(BusAccess& access, Picoseconds at) override;
  bool poll(BusAccess& access, Picoseconds until) override;
  void finish(BusAccess& access) override;
  Picoseconds horizon() override { return LookaheadInitiator::horizon(); }
  void sleep_until(Picoseconds until) override;
  Picoseconds wait_for_interrupt(Picoseconds from) override;
  Picoseconds background_next() const { return core_.next_act(); }
  void background_act() { core_.act(); }
  void completed(Transaction& tx);

  /// The request of an access; its constant members are set only once.
  struct Record : Transaction {
    BusAccess* access = nullptr;
  };
  static Transaction& record_of(const BusAccess& a) { return *static_cast<Record*>(a.record); }
  void take_in(BusAccess& a);

  Core core_;
  std::uint32_t entry_;
  std::array<Record, Core::kAccesses> records_;
  std::size_t record_count_ = 0;
  Timer interrupt_, clock_runs_, released_;
  bool irq_ = false, fiq_ = false, asleep_ = false;
  bool in_reset_ = false, held_ = false;
  unsigned clock_changes_ = 0;
  Picoseconds asserted_ = 0;  // time at which IRQ or FIQ was asserted
  std::string failure_;
};

}  // namespace fovea::cpu
