// Top level of the VPSS (video processing subsystem): interrupt routing, clock gates, priorities.
#pragma once
#include <functional>
#include <systemc>

#include "model/common/bus_target.h"
#include "model/common/timer.h"

namespace fovea::video {

/// The ISP5 registers from offset 0 (0x01C70000) and the VPSS clock control at offset 0x200, as one
/// block of 0x400 bytes. Source: TI's register header for the DM36x, Linux vpss.c.
struct VpssRegs : RegBank {
  Reg pid{*this, "PID", 0x00, Mode::kRo, "peripheral identification", 0x4C180800};
  struct Pccr : Reg {
    using Reg::Reg;
    Field bl{*this, "BL", 0, 1, Mode::kRw, "buffer logic clock", Modelled{1}};
    Field isif{*this, "ISIF", 1, 1, Mode::kRw, "ISIF clock"};
    Field h3a{*this, "H3A", 2, 1, Mode::kRw, "H3A clock; block not modelled"};
    Field rsz{*this, "RSZ", 3, 1, Mode::kRw, "resizer clock; block not modelled"};
    Field ipipe{*this, "IPIPE", 4, 1, Mode::kRw, "IPIPE clock; block not modelled"};
    Field ipipeif{*this, "IPIPEIF", 5, 1, Mode::kRw, "IPIPEIF clock; block not modelled"};
    Field sync{*this, "SYNC", 6, 1, Mode::kRw, "internal pixel clock", Modelled{1}};
    Field psync{
        *this,     "PSYNC_CLK_SEL",
        7,         1,
        Mode::kRw, "clock of the sync module: 0 registers', 1 VPSS; no effect on what is modelled"};
  } pccr{*this, "PCCR", 0x04, "clock gates of the front end", 0x7F};
  struct Bcr : Reg {
    using Reg::Reg;
    Field ldc_ipipe{*this, "SRC_SEL_RB", 0, 1, Mode::kRw, "read buffer: IPIPE or LDC; kept"};
    Field isif_wb{
        *this,     "SRC_SEL_WB",
        1,         1,
        Mode::kRw, "1: the write buffer is the ISIF's; 0: nothing captured reaches memory"};
    Field rd_pri{*this, "RD_PRI", 2, 3, Mode::kRw, "priority of VPSS reads, 0 highest"};
    Field wr_pri{*this, "WR_PRI", 5, 3, Mode::kRw, "priority of VPSS writes, 0 highest"};
  } bcr{*this, "BCR", 0x08, "buffer control", 0x2};
  Reg intstat{*this, "INTSTAT", 0x0C, Mode::kW1c, "events seen, one bit per source"};
  struct Select : Reg {
    using Reg::Reg;
    Field n0{*this, "N0", 0, 5, Mode::kRw, "source of the first output"};
    Field n1{*this, "N1", 8, 5, Mode::kRw, "source of the second output"};
    Field n2{*this, "N2", 16, 5, Mode::kRw, "source of the third output"};
    Field n3{*this, "N3", 24, 5, Mode::kRw, "source of the fourth output"};
  };
  // After reset all outputs follow source 0, ISIF_INT0 (TI's register header).
  Select intsel1{*this, "INTSEL1", 0x10, "sources of VPSSINT0 ... 3"};
  Select intsel2{*this, "INTSEL2", 0x14, "sources of VPSSINT4 ... 7"};
  Select intsel3{*this, "INTSEL3", 0x18, "source of VPSSINT8"};
  Select evtsel{*this, "EVTSEL", 0x1C, "sources of the EDMA events VPSS_EVT1 ... 4"};
  Reg ccdcmux{*this, "CCDCMUX", 0x20, Mode::kRw, "input multiplexer", 0, Modelled{0}};
  Reg mpsr{*this, "MPSR", 0x2C, Mode::kRw, "memory access of the blocks' tables; kept"};
  struct Clkctrl : Reg {
    using Reg::Reg;
    Field vpbe{*this, "VPBE_CLK", 0, 1, Mode::kRw, "OSD and VENC register clock"};
    Field reserved1{*this, "RSV1", 1, 1, Mode::kRw, "kept"};
    Field venc{*this,
               "VENC_CLK_SEL",
               2,
               1,
               Mode::kRw,
               "VENC clock: 0 ENC_CLK, 1 ENC_CLK/2 (Linux vpss.h); what it does to the standard "
               "raster: vpss.venc_clk_sel"};
    Field ldc{*this, "LDC_CLK", 3, 1, Mode::kRw, "LDC clock; block not modelled"};
    Field fdif{*this, "FDIF_CLK", 4, 1, Mode::kRw, "face detection clock; block not modelled"};
    Field osd_sel{*this, "OSD_CLK_SEL", 6, 1, Mode::kRw, "clock of the OSD", Modelled{0}};
    Field ldc_sel{*this, "LDC_CLK_SEL", 7, 1, Mode::kRw, "clock of the LDC; block not modelled"};
  } clkctrl{*this, "VPSS_CLK_CTRL", 0x200, "clock gates and selectors of the back end", 0x19};
  VpssRegs() : RegBank("VPSS") {}
};

/// Routes events to interrupts: each VPSSINT output follows the input that its INTSEL field
/// selects, so a pulse of an input is a rising edge at the interrupt controller. INTSTAT records
/// rising inputs and does not gate the outputs (Linux never clears it). The EDMA events VPSS_EVT1 to 4
/// follow EVTSEL in the same way. Modelled sources: 0 to 2 VDINT0 to VDINT2, 21 VENC; 31 is none.
class VpssTop : public WithRegs<VpssRegs>, public BusTarget {
 public:
  static constexpr unsigned kOutputs = 9, kEvents = 4;
  static constexpr unsigned kVencSource = 21, kNoSource = 31;
  /// The source that an output follows.
  unsigned source_of(unsigned output) const {
    const VpssRegs::Select* const selects[] = {&regs.intsel1, &regs.intsel2, &regs.intsel3};
    return selects[output / 4]->fields()[output % 4]->get();
  }
  sc_core::sc_in<bool> psc_enabled{"psc_enabled"};
  sc_core::sc_vector<sc_core::sc_in<bool>> isif_int{"isif_int", 3};
  sc_core::sc_in<bool> venc_int{"venc_int"};
  sc_core::sc_vector<sc_core::sc_out<bool>> vpssint{"vpssint", kOutputs};  ///< AINTC inputs 0 to 8
  sc_core::sc_out<bool> isif_gate{"isif_gate"};
  sc_core::sc_out<bool> isif_owns_write_buffer{"isif_owns_write_buffer"};
  sc_core::sc_out<bool> vpbe_gate{"vpbe_gate"}, venc_clk_sel{"venc_clk_sel"};
  sc_core::sc_out<std::uint32_t> read_priority{"read_priority"}, write_priority{"write_priority"};

  /// A rising edge of VPSS_EVTn, n = 1 .. 4, now. Set by the chip; may be empty.
  std::function<void(unsigned n)> on_event;

  SC_HAS_PROCESS(VpssTop);
  explicit VpssTop(sc_core::sc_module_name name);

 protected:
  bool clocked() const override { return psc_enabled.read(); }

 private:
  void on_reset(ResetKind) override {
    selection_.soon();
    controls_.soon();
  }
  void route();
  void route_events(std::uint32_t level);
  void events_selected();
  void drive_controls();
  Timer selection_, controls_;
  std::uint32_t level_ = 0, event_level_ = 0;
};

}  // namespace fovea::video
