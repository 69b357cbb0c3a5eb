// What the controller's registers mean to its core.
#pragma once
#include <algorithm>

#include "model/mem/core/ddr_controller.h"
#include "model/mem/ddr_regs.h"

namespace fovea::mem {

/// Timing fields hold clocks - 1. The controller keeps what was programmed, whatever the part would
/// like. SDRCR: LPMODEN lets an idle controller put the part to sleep, SR_PD says how.
inline DdrConfig decode(const DdrRegs& regs) {
  DdrConfig c;
  DdrTiming& t = c.timing;
  t.CL = regs.sdbcr.cl.get();
  t.banks = std::min(1u << regs.sdbcr.ibank.get(), DdrDevice::kMaxBanks);
  t.mobile = regs.sdbcr.mddren.get() != 0;
  t.nRFC = regs.sdtimr.rfc.get() + 1;
  t.nRP = regs.sdtimr.rp.get() + 1;
  t.nRCD = regs.sdtimr.rcd.get() + 1;
  t.nWR = regs.sdtimr.wr.get() + 1;
  t.nRAS = regs.sdtimr.ras.get() + 1;
  t.nRC = regs.sdtimr.rc.get() + 1;
  t.nRRD = regs.sdtimr.rrd.get() + 1;
  t.nWTR = regs.sdtimr.wtr.get() + 1;
  t.nRTP = regs.sdtimr2.rtp.get() + 1;
  t.nXP = regs.sdtimr2.xp.get() + 1;
  t.nXSNR = regs.sdtimr2.xsnr.get() + 1;
  t.nXSRD = regs.sdtimr2.xsrd.get() + 1;
  t.nCKE = regs.sdtimr2.cke.get() + 1;
  c.read_latency = regs.ddrphycr.rl.get();
  c.refresh_interval = regs.sdrcr.rr.get();
  c.old_count = regs.pbbpr.pr_old_count.get();
  c.page_log2 = 9 + regs.sdbcr.pagesize.get();  // 256 words of 2 bytes
  c.bank_on_top = regs.sdbcr.ibank_pos.get() != 0;
  if (regs.sdrcr.lpmoden.get())
    c.low_power = regs.sdrcr.sr_pd.get() ? LowPower::kPowerDown : LowPower::kSelfRefresh;
  return c;
}

}  // namespace fovea::mem
