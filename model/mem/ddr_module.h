// The DDR2 controller's registers, clocks and power gate.
#pragma once
#include <systemc>

#include "model/common/bus_target.h"
#include "model/common/sc_ports.h"
#include "model/mem/core/ddr_controller.h"
#include "model/mem/ddr_check.h"
#include "model/mem/ddr_regs.h"
#include "model/memsys/memory_system.h"

namespace fovea::mem {

/// Software programs the controller by SDBCR, SDBCR2, SDTIMR, SDTIMR2, SDRCR, PBBPR and DDRPHYCR. Data
/// accesses before SDBCR was unlocked and locked again, or while LPSC 13 or the clock is off, end in a
/// bus error (assumed: the chip's reaction is not documented). An address beyond the part's size, inside
/// the chip's window of 256 MiB, is taken modulo that size: the row address bits above the part's are not
/// connected. With the first access after a change of registers or clock, what was programmed is
/// examined: values that the manual does not allow, and times below the part's data sheet, are warnings
/// about the guest.
///
/// A reset of the chip returns the registers to their reset values; software has to initialise the SDRAM
/// again. Requests that the controller has accepted are still executed, later ones end in a bus error.
/// The SDRAM keeps its contents (model/decisions/0015-reset.md).
class DdrModule final : public WithRegs<DdrRegs>, public BusTarget, private memsys::SdramAdmission {
 public:
  using Params = DdrParams;
  ClockIn ddr_clk{"ddr_clk"};
  ClockIn scr_clk{"scr_clk"};
  sc_core::sc_in<bool> enabled{"enabled"};  ///< LPSC 13
  /// Software has programmed the timing and locked it again, and power domain and clock are on.
  sc_core::sc_signal<bool, sc_core::SC_UNCHECKED_WRITERS> initialised{"initialised"};

  /// The controller itself is a part of the memory system.
  DdrModule(sc_core::sc_module_name name, const DdrParams& params, memsys::MemorySystem& memory);

  DdrController& controller() { return memory_.controller(); }
  BackingStore& store() { return memory_.store(); }
  /// What the registers say now.
  DdrConfig programmed() const;

  /// Brings the whole memory system to `now`: for whoever looks at its state.
  void settle(Picoseconds now) { memory_.settle(now); }
  void leave_reset() override { in_reset_ = false; }

 private:
  void on_reset(ResetKind) override;
  void clocks_changed();
  void enabled_changed();
  void reconfigure();
  void keep_while_locked(Reg& timing, std::uint32_t& kept);
  void keep_latency_while_locked();
  void keep_type_while_locked();
  void warn_of_lost_type() const;
  void note_initialised();
  void update_open() { memory_.set_open(ready_ && enabled_ && examined_); }
  bool admit(std::uint32_t offset, unsigned bytes) override;

  const DdrParams& params_;
  memsys::MemorySystem& memory_;
  DdrCheck check_;
  bool ready_ = false;      // initialised by the firmware
  bool timed_ = false;      // the timing registers have been open since power-up
  bool enabled_ = false;    // of `enabled`, without a call
  bool examined_ = false;   // what is programmed now
  std::uint32_t sdtimr_, sdtimr2_;  // as last written with TIMUNLOCK
  std::uint32_t cl_;                // SDBCR.CL as last taken
  bool unlocked_ = false;           // the last write of SDBCR opened it
  std::uint32_t type_;              // SDBCR's bits that BOOTUNLOCK opens, as last taken
  std::uint32_t lost_ = 0;          // those of them that the last write did not change, although it would have
  bool boot_unlocked_ = false;      // the last write of SDBCR has set BOOTUNLOCK
  bool in_reset_ = false;
};

}  // namespace fovea::mem
