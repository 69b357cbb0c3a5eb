// The DDR2 controller on its sockets: data from the crossbar, registers from the configuration bus.
#pragma once
#include <systemc>
#include <tlm>
#include <vector>

#include "model/common/bus_target.h"
#include "model/common/lookahead.h"
#include "model/common/mem_sockets.h"
#include "model/common/sc_ports.h"
#include "model/mem/core/ddr_controller.h"
#include "model/mem/ddr_check.h"
#include "model/mem/ddr_regs.h"

namespace fovea::mem {

/// What it does: DDR2 timing and scheduling as model/mem/core. Programmed by SDBCR, SDBCR2, SDTIMR,
/// SDTIMR2, SDRCR, PBBPR, DDRPHYCR; data accesses before SDBCR was unlocked and locked again, or
/// while LPSC 13 or the clock is off, end in a bus error (assumed: the chip's reaction is not
/// documented). An address beyond the part's size, inside the chip's window of 256 MiB, is taken modulo
/// that size: the row address bits above the part's are not connected. With the first access after a change of registers or clock, when all of it is
/// written, what was programmed is looked at: nonsense and times below the part's data sheet are
/// remarks about the guest.
class DdrModule final : public BusTarget, public PassiveIf, public MemTargetIf,
                        private DdrClient {
 public:
  using Params = DdrParams;
  MemTargetSocket<64> socket{"socket"};
  sc_core::sc_export<PassiveIf> lookahead{"lookahead"};
  ClockIn ddr_clk{"ddr_clk"};
  ClockIn scr_clk{"scr_clk"};
  sc_core::sc_in<bool> enabled{"enabled"};  ///< LPSC 13
  /// Software has programmed the timing and locked it again, and power domain and clock are on.
  sc_core::sc_signal<bool, sc_core::SC_UNCHECKED_WRITERS> initialised{"initialised"};

  DdrModule(sc_core::sc_module_name name, const DdrParams& params);

  DdrController& controller() { return controller_; }
  BackingStore& store() { return store_; }
  DdrRegs regs;
  /// What the registers say now.
  DdrConfig programmed() const;

  /// Time-ordered access to the state: takes all decisions at or before `now` first.
  void settle(Picoseconds now);

  Picoseconds next_decision() const override { return controller_.next_decision(); }
  void step() override { controller_.step(); }
  const Picoseconds* next_decision_place() const override {
    return controller_.next_decision_place();
  }
  const sc_core::sc_event& replanned() const override { return replanned_.event(); }

  Taken arrive(MemRequest& request, Picoseconds at) override;

  tlm::tlm_sync_enum nb_transport_fw(MemRequest&, MemPhase&, sc_core::sc_time&) override;
  unsigned transport_dbg(MemRequest&) override;

 private:
  void ddr_accepted(void* cookie, Picoseconds at) override;
  void ddr_read_done(void* cookie, Picoseconds first, Picoseconds last) override;
  void clocks_changed();
  void enabled_changed();
  void reconfigure();
  void keep_while_locked(Reg& timing, std::uint32_t& kept);
  void keep_latency_while_locked();
  void note_initialised();
  bool admit(const MemRequest& m);
  Taken arrive_slowly(MemRequest& m, Picoseconds at);
  Taken refuse_in_order(MemRequest& m, Picoseconds at);
  void refuse_after(const void* read, Picoseconds last);

  const DdrParams& params_;
  BackingStore store_;
  DdrController controller_;
  DdrCheck check_;
  Timer replanned_;
  KernelNow now_;
  bool ready_ = false;      // initialised by the firmware
  bool timed_ = false;      // the timing registers have been open since power-up
  bool enabled_ = false;    // of `enabled`, without a call
  bool examined_ = false;   // what is programmed now
  bool open_ = false;       // all three
  std::uint32_t sdtimr_, sdtimr2_;  // as last written with TIMUNLOCK
  std::uint32_t cl_;                // SDBCR.CL as last taken
  bool unlocked_ = false;           // the last write of SDBCR opened it
  /// Reads that nobody answers, behind older ones of their master that are still to be served.
  struct Refused {
    MemRequest* request;
    const void* behind;
    Picoseconds at;
  };
  std::vector<Refused> refused_;
};

}  // namespace fovea::mem
