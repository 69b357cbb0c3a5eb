// Registers of the DDR2/mDDR controller (U-Boot, asm/arch-davinci/ddr2_defs.h; SPRU986B).
#pragma once
#include "model/common/regbank.h"

namespace fovea::mem {

struct DdrRegs : RegBank {
  struct Sdrstat : Reg {
    using Reg::Reg;
    Field phyrdy{*this, "PHYRDY", 2, 1, Mode::kRo, "0: the memory's clock stands"};
  } sdrstat{*this, "SDRSTAT", 0x04, "status", 0x4};

  struct Sdbcr : Reg {
    using Reg::Reg;
    Field pagesize{*this, "PAGESIZE", 0, 3, Mode::kRw, "256 * 2^n words in a page"};
    Field ibank{*this, "IBANK", 4, 3, Mode::kRw, "2^n banks"};
    Field cl{*this, "CL", 9, 3, Mode::kRw, "CAS latency; taken with TIMUNLOCK or BOOTUNLOCK"};
    Field nm{*this, "NM", 14, 1, Mode::kRw, "1: 16-bit bus, the only one bonded out"};
    Field timunlock{*this, "TIMUNLOCK", 15, 1, Mode::kRw, "opens CL and the timing registers"};
    Field sdramen{*this, "SDRAMEN", 16, 1, Mode::kRw, "SDRAM"};
    Field ddren{*this, "DDREN", 17, 1, Mode::kRw, "DDR"};
    Field ddrdrive{*this, "DDRDRIVE", 18, 2, Mode::kRw, "drive strength; no effect here"};
    Field ddr2en{*this, "DDR2EN", 20, 1, Mode::kRw, "DDR2"};
    Field ddrdllen{*this, "DDRDLL_DIS", 21, 1, Mode::kRw, "DLL; no effect here"};
    Field ddqs{*this, "DDQS", 22, 1, Mode::kRw, "differential DQS; no effect here"};
    Field bootunlock{*this, "BOOTUNLOCK", 23, 1, Mode::kRw, "opens CL, and with the next write the type bits"};
    Field ddrdrive1{*this, "DDRDRIVE1", 24, 1, Mode::kRw, "drive strength; no effect here"};
    Field mddren{*this, "MSDRAMEN", 25, 1, Mode::kRw, "mobile DDR"};
    Field ibank_pos{*this, "IBANK_POS", 26, 1, Mode::kRw, "1: bank address on top of the row"};
    Field term{*this, "DDRTERM", 27, 2, Mode::kRw, "termination; no effect here"};
  } sdbcr{*this, "SDBCR", 0x08, "SDRAM bank configuration; reset value assumed", 0x00053832};

  struct Sdrcr : Reg {
    using Reg::Reg;
    Field rr{*this, "RR", 0, 16, Mode::kRw, "refresh interval in DDR clocks"};
    Field sr_pd{*this, "SR_PD", 23, 1, Mode::kRw, "power-down instead of self-refresh"};
    Field mclkstopen{*this, "MCLKSTOPEN", 30, 1, Mode::kRw,
                     "with LPMODEN: the memory's clock stands in self-refresh"};
    Field lpmoden{*this, "LPMODEN", 31, 1, Mode::kRw, "low power"};
  } sdrcr{*this, "SDRCR", 0x0C, "refresh control; reset value assumed", 0x00000535};

  struct Sdtimr : Reg {
    using Reg::Reg;
    Field wtr{*this, "T_WTR", 0, 3, Mode::kRw, "clocks - 1"};
    Field rrd{*this, "T_RRD", 3, 3, Mode::kRw, "clocks - 1"};
    Field rc{*this, "T_RC", 6, 5, Mode::kRw, "clocks - 1"};
    Field ras{*this, "T_RAS", 11, 5, Mode::kRw, "clocks - 1"};
    Field wr{*this, "T_WR", 16, 3, Mode::kRw, "clocks - 1"};
    Field rcd{*this, "T_RCD", 19, 3, Mode::kRw, "clocks - 1"};
    Field rp{*this, "T_RP", 22, 3, Mode::kRw, "clocks - 1"};
    Field rfc{*this, "T_RFC", 25, 7, Mode::kRw, "clocks - 1"};
  } sdtimr{*this, "SDTIMR", 0x10, "timing, first word; reset value assumed", 0xFFFFFFFF};

  struct Sdtimr2 : Reg {
    using Reg::Reg;
    Field cke{*this, "T_CKE", 0, 5, Mode::kRw, "clocks - 1"};
    Field rtp{*this, "T_RTP", 5, 3, Mode::kRw, "clocks - 1"};
    Field xsrd{*this, "T_XSRD", 8, 8, Mode::kRw, "clocks - 1"};
    Field xsnr{*this, "T_XSNR", 16, 7, Mode::kRw, "clocks - 1"};
    Field odt{*this, "T_ODT", 23, 2, Mode::kRw, "clocks"};
    Field xp{*this, "T_XP", 25, 2, Mode::kRw, "clocks - 1"};
    Field rasmax{*this, "T_RASMAX", 27, 4, Mode::kRw, "refresh intervals - 1"};
  } sdtimr2{*this, "SDTIMR2", 0x14, "timing, second word; reset value assumed", 0x7FFFFFFF};

  struct Sdbcr2 : Reg {
    using Reg::Reg;
    Field rowsize{*this, "ROWSIZE", 0, 3, Mode::kRw,
                  "9 + n row address bits, with IBANK_POS; the model takes the part's"};
    Field pasr{*this, "PASR", 16, 3, Mode::kRw,
               "self-refresh of a mobile part keeps 0: 4 banks, 1: 2, 2: 1, 5: 1/2, 6: 1/4 of one"};
  } sdbcr2{*this, "SDBCR2", 0x1C, "row size and partial-array self-refresh"};
  struct Pbbpr : Reg {
    using Reg::Reg;
    Field pr_old_count{*this, "PR_OLD_COUNT", 0, 8, Mode::kRw,
                       "transfers after which the oldest command is raised; 0xFF never"};
  } pbbpr{*this, "PBBPR", 0x20, "peripheral bus burst priority", 0xFF};
  Reg irr{*this, "IRR", 0xC0, Mode::kW1c, "raw interrupts"};
  Reg imr{*this, "IMR", 0xC4, Mode::kW1c, "masked interrupts"};
  Reg imsr{*this, "IMSR", 0xC8, Mode::kRw, "interrupt enable"};
  Reg imcr{*this, "IMCR", 0xCC, Mode::kRw, "interrupt disable"};
  struct Ddrphycr : Reg {
    using Reg::Reg;
    Field rl{*this, "RL", 0, 3, Mode::kRw, "read latency, clocks"};
    Field other{*this, "CTRL", 3, 29, Mode::kRw, "power-down, strobes, DLL; no effect here"};
  } ddrphycr{*this, "DDRPHYCR", 0xE4, "PHY control; reset value assumed", 0x50006405};
  Reg ddrphycr2{*this, "DDRPHYCR2", 0xE8, Mode::kRw, "PHY control 2; no effect here"};

  DdrRegs() : RegBank("DDR") {}
};

}  // namespace fovea::mem
