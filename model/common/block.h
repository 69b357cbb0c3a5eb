// What a block of the chip or the board says of itself, and the list of all blocks.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/common/check.h"
#include "model/common/masters.h"
#include "model/common/mem_sockets.h"
#include "model/common/sc_ports.h"
#include "model/common/stats.h"

namespace fovea {

class BusTarget;

/// A block's port as a memory master.
struct MasterPort {
  Master id;
  MemInitiatorSocket<32>* socket;
  unsigned outstanding;  ///< requests it may have under way; 0: it issues none with these parameters
  Pace pace;
};

/// Why a chip is reset. What each kind leaves as it was: model/decisions/0015-reset.md.
enum class ResetKind : std::uint8_t {
  kPowerOn,   ///< the power-on reset pin; memories have lost their contents
  kWarm,      ///< the reset pin while the power stays on
  kWatchdog,  ///< requested by the watchdog timer
};

/// Any input or output of that kind, whether or not it must be bound.
using PowerGateIn = sc_core::sc_port_b<sc_core::sc_signal_in_if<bool>>;
using InterruptOut = sc_core::sc_port_b<sc_core::sc_signal_inout_if<bool>>;

/// Base of every block. A block states in its constructor what it consists of; code that needs all
/// statistics or all registers walks the Platform instead of keeping a list.
class Block {
 public:
  virtual ~Block() = default;
  const std::vector<StatGroup*>& statistics() const { return statistics_; }
  /// Groups that count in a window of the block's own, such as the core's, which opens and closes at
  /// instruction boundaries. The walk neither resets nor reports them.
  const std::vector<const StatGroup*>& own_windows() const { return own_windows_; }
  const std::vector<MasterPort>& masters() const { return masters_; }
  const std::vector<ClockIn*>& clocks() const { return clocks_; }
  const std::vector<PowerGateIn*>& power_gates() const { return power_gates_; }
  struct Interrupt {
    std::string name;  ///< of the source, such as "tint12"
    InterruptOut* port;
  };
  const std::vector<Interrupt>& interrupts() const { return interrupts_; }
  /// The block's registers on the configuration bus; null if it has none.
  virtual BusTarget* registers() { return nullptr; }

  /// The chip's reset is asserted, at the end of an instant: the block returns to its state after
  /// power-up and starts nothing new. Requests that it has sent to memory are still answered, and it
  /// ignores the answers. Outputs follow in the next delta cycles. Statistics are not touched.
  virtual void reset(ResetKind) {}
  /// During a reset: true if none of the block's requests is under way at the present time. It must
  /// not depend on how far the memory path has been decided ahead of that time.
  virtual bool idle() const { return true; }
  /// The chip leaves reset: all blocks are idle.
  virtual void leave_reset() {}
  /// A sentence about the first difference between two models of this block that are compared while both run. Empty:
  /// there is none, or one model only. The block pauses the kernel when it finds one.
  virtual std::string difference() const { return {}; }
  /// Where the block says its warnings: what was current when it was constructed.
  const DiagnosticsRef& diagnostics() const { return diagnostics_; }

 protected:
  /// The group is reset when the measured window opens and reported when it closes.
  void add_statistics(StatGroup& group) { statistics_.push_back(&group); }
  /// The port is bound to that master's port of the crossbar. `pace`, where it is not that of the row.
  void add_master(Master id, MemInitiatorSocket<32>& socket, unsigned outstanding,
                  std::optional<Pace> pace = {}) {
    const MasterInfo& row = master_info(id);
    FOVEA_CHECK(outstanding <= row.most_outstanding,
                std::string(row.name) + " has more requests under way than its row allows");
    masters_.push_back({id, &socket, outstanding, pace.value_or(row.pace)});
  }
  /// The functional clock, the gate of the power and sleep controller, and an interrupt line: the code that
  /// places the block binds them. Interrupts keep the order of the calls.
  void add_clock(ClockIn& port) { clocks_.push_back(&port); }
  void add_power_gate(PowerGateIn& port) { power_gates_.push_back(&port); }
  void add_interrupt(std::string name, InterruptOut& port) {
    interrupts_.push_back({std::move(name), &port});
  }
  void add_own_window(const StatGroup& group) { own_windows_.push_back(&group); }

 private:
  std::vector<StatGroup*> statistics_;
  std::vector<const StatGroup*> own_windows_;
  std::vector<MasterPort> masters_;
  std::vector<ClockIn*> clocks_;
  std::vector<PowerGateIn*> power_gates_;
  std::vector<Interrupt> interrupts_;
  DiagnosticsRef diagnostics_ = DiagnosticsRef::current();
};

/// The blocks of a chip or a board, each under the name by which tools show it.
class Platform {
 public:
  struct Entry {
    std::string name;
    Block* block;
  };

  void add(std::string name, Block& block) {
    for (const Entry& e : entries_) {
      FOVEA_CHECK(e.name != name, "two blocks named " + name);
      FOVEA_CHECK(e.block != &block, "block added twice: " + name);
    }
    entries_.push_back({std::move(name), &block});
  }
  /// Adds all blocks of a part of this platform, for example those of the chip on a board.
  void add(const Platform& part) {
    for (const Entry& e : part.entries_) add(e.name, *e.block);
  }
  const std::vector<Entry>& blocks() const { return entries_; }

  /// Calls f(group) for each group of statistics.
  template <class F>
  void each_statistics(F f) const {
    for (const Entry& e : entries_)
      for (StatGroup* g : e.block->statistics()) f(*g);
  }
  /// Calls f(port) for each port of each block that is a memory master.
  template <class F>
  void each_master(F f) const {
    for (const Entry& e : entries_)
      for (const MasterPort& p : e.block->masters()) f(p);
  }
  /// Calls f(name, target) for each block with registers.
  template <class F>
  void each_registers(F f) const {
    for (const Entry& e : entries_)
      if (BusTarget* t = e.block->registers()) f(e.name, *t);
  }

 private:
  std::vector<Entry> entries_;
};

}  // namespace fovea
