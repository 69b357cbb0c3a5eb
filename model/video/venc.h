// VENC (video encoder): generates the display raster.
#pragma once
#include <systemc>

#include "model/common/bus_target.h"
#include "model/common/sc_ports.h"
#include "model/common/timer.h"
#include "model/video/osd.h"
#include "model/common/pulse.h"
#include "model/video/venc_regs.h"
#include "model/video/wire.h"

namespace fovea::video {

/// VENC in standard interlaced timing, 625/50 or 525/60 as selected by VMOD.TVTYP, on its own clock
/// (27 MHz for the standard's rates), which CLKCTL bit 0 gates. The raster starts with a field 1 (F
/// = 0) at the clock edge after the encoder was switched on. At the start of each field, where F
/// changes (lines 1 and 313, or 4 and 266), VSTAT changes, the OSD latches its window and the
/// interrupt fires. A line is passed to the display when its last sample has been sent; no process
/// runs more than once per line.
class Venc : public WithRegs<VencRegs>, public BusTarget {
 public:
  using Params = VpssParams;
  ClockIn clock{"clock"};
  sc_core::sc_port<OsdLineIf> osd{"osd"};
  sc_core::sc_port<DisplayLineIf> display{"display"};
  Pulse interrupt{"interrupt"};  ///< bind interrupt.out
  sc_core::sc_in<bool> psc_enabled{"psc_enabled"};
  sc_core::sc_in<bool> vpbe_gate{"vpbe_gate"};
  sc_core::sc_in<bool> clk_sel{"clk_sel"};  ///< VENC_CLK_SEL of the VPSS

  SC_HAS_PROCESS(Venc);
  Venc(sc_core::sc_module_name name, const VpssParams& params);

 protected:
  bool clocked() const override { return psc_enabled.read() && vpbe_gate.read(); }

 private:
  void on_reset(ResetKind) override;
  void stop_raster();
  void reconsider();
  void tick();
  void schedule();
  bool wanted() const;
  Frequency input_frequency() const;
  const Standard& chosen() const { return standard_of(regs.vmod.tvtyp.get() == 1); }

  const VpssParams& params_;
  Clock clock_;
  const Standard* standard_ = nullptr;  // null: the raster is off
  std::uint64_t origin_ = 0;            // clock edge at which line 0 begins
  std::uint64_t next_line_ = 0;
  bool line_out_ = false;  // the line before next_line_ is an active line
  Timer line_timer_, reconsider_timer_;
};

}  // namespace fovea::video
