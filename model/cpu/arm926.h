// The ARM926EJ-S on its two AHB sockets.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <systemc>

#include "model/bus/agent.h"
#include "model/common/block.h"
#include "model/common/sc_ports.h"
#include "model/cpu/core/bus_port.h"
#include "model/cpu/core/core.h"

namespace fovea::cpu {

/// Thin wrapper: the core runs on an SC_THREAD, so its blocking calls suspend it at any bus access
/// and resume it there; the rules of time are those of bus::Agent.
class Arm926 final : public bus::Agent<Arm926>, public Block, private BusPort {
 public:
  static constexpr unsigned kInstructionPort = 0, kDataPort = 1;
  ClockIn clk{"clk"};
  sc_core::sc_in<bool> irq{"irq"}, fiq{"fiq"};

  Arm926(sc_core::sc_module_name name, const CpuParams& params, std::span<std::uint8_t> tcm,
         std::uint32_t entry);
  Core& core() { return core_; }
  const Core& core() const { return core_; }
  /// Not empty once the core has ended by a guest failure; the simulation is stopped then.
  const std::string& failure() const { return failure_; }
  /// The core waits for an interrupt, as of the kernel's time.
  bool asleep() const { return asleep_; }
  /// The access behind one of its requests.
  static const BusAccess& access_of(const MemRequest& r) {
    return *static_cast<const Record*>(static_cast<const Transaction*>(r.owner))->access;
  }
  /// From the core's own stack, at an instruction boundary: the kernel comes to its time.
  void catch_up();

 private:
  friend bus::Agent<Arm926>;
  void run();
  void clock_changed();
  void interrupt_changed();

  void submit(BusAccess& access, Picoseconds at) override;
  bool poll(BusAccess& access, Picoseconds until) override;
  void finish(BusAccess& access) override;
  Picoseconds horizon() override { return Agent::horizon(); }
  void sleep_until(Picoseconds until) override;
  Picoseconds wait_for_interrupt(Picoseconds from) override;
  Picoseconds background_next() const { return core_.next_act(); }
  void background_act() { core_.act(); }
  void completed(Transaction& tx);

  /// What of an access does not change is set once.
  struct Record : Transaction {
    BusAccess* access = nullptr;
  };
  static Transaction& record_of(const BusAccess& a) { return *static_cast<Record*>(a.record); }
  void take_in(BusAccess& a);

  Core core_;
  std::uint32_t entry_;
  std::array<Record, Core::kAccesses> records_;
  std::size_t record_count_ = 0;
  Timer interrupt_, clock_runs_;
  bool irq_ = false, fiq_ = false, asleep_ = false;
  unsigned clock_changes_ = 0;
  Picoseconds asserted_ = 0;  // since when IRQ or FIQ is asserted
  std::string failure_;
};

}  // namespace fovea::cpu
