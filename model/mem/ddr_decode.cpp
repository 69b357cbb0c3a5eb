#include "model/mem/ddr_decode.h"

#include <algorithm>
#include <array>

namespace fovea::mem {
namespace {

constexpr unsigned kLargestCL = 5, kLargestPage = 3, kMostBanks = 3;  // as their fields have them
bool reserved_CL(unsigned CL) { return CL < 2 || CL > kLargestCL; }

/// SDBCR2.PASR as in a mobile part's extended mode register (JESD209): all, a half, a quarter, an eighth, a sixteenth;
/// reserved: all is refreshed.
bool reserved_PASR(unsigned pasr) { return pasr == 3 || pasr == 4 || pasr == 7; }
constexpr std::array<unsigned, 8> kRefreshedLog2{0, 1, 2, 0, 0, 3, 4, 0};

std::string text(unsigned n) { return std::to_string(n); }

}  // namespace

DdrConfig decode(const DdrRegs& regs) {
  DdrConfig c;
  DdrTiming& t = c.timing;
  t.CL = reserved_CL(regs.sdbcr.cl.get()) ? kLargestCL : regs.sdbcr.cl.get();
  t.banks = 1u << std::min(regs.sdbcr.ibank.get(), kMostBanks);
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
  c.row_intervals = regs.sdtimr2.rasmax.get() + 1;
  c.read_latency = regs.ddrphycr.rl.get();
  c.refresh_interval = regs.sdrcr.rr.get();
  // Less leaves no time for anything but refreshes.
  if (c.refresh_interval) c.refresh_interval = std::max(c.refresh_interval, t.least_interval());
  c.old_count = regs.pbbpr.pr_old_count.get();
  c.page_log2 = 9 + std::min(regs.sdbcr.pagesize.get(), kLargestPage);  // 256 words of 2 bytes
  c.bank_on_top = regs.sdbcr.ibank_pos.get() != 0;
  if (regs.sdrcr.lpmoden.get())
    c.low_power = regs.sdrcr.sr_pd.get()        ? LowPower::kPowerDown
                  : regs.sdrcr.mclkstopen.get() ? LowPower::kClockStop
                                                : LowPower::kSelfRefresh;
  if (t.mobile) c.refreshed_log2 = kRefreshedLog2[regs.sdbcr2.pasr.get()];
  return c;
}

std::vector<std::string> invalid_register_values(const DdrRegs& regs, const DdrParams& params) {
  std::vector<std::string> out;
  const auto say = [&](bool wrong, const std::string& line) {
    if (wrong) out.push_back(line);
  };
  const DdrConfig c = decode(regs);
  const DdrTiming& t = c.timing;
  const auto& b = regs.sdbcr;
  const bool mobile = params.mobile();
  say(!b.nm, "SDBCR NM = 0: a 32-bit bus, but the chip has 16 bits; taken as 16");
  say(reserved_CL(b.cl.get()), "SDBCR CL = " + text(b.cl.get()) + " is reserved; taken as 5");
  say(b.ibank.get() > kMostBanks,
      "SDBCR IBANK = " + text(b.ibank.get()) + " is reserved; taken as 3, 8 banks");
  say(b.pagesize.get() > kLargestPage,
      "SDBCR PAGESIZE = " + text(b.pagesize.get()) + " is reserved; taken as 3, 2048 words");
  say(t.mobile != mobile, std::string("SDBCR MSDRAMEN = ") + (mobile ? "0" : "1") +
                              ", but ddr.part = " + params.part() + " is " +
                              (mobile ? "mobile DDR" : "DDR2") + "; timed as programmed");
  say(!b.ddren || (!mobile && !b.ddr2en),
      std::string("SDBCR ") + (b.ddren ? "DDR2EN" : "DDREN") + " = 0: not the type of ddr.part = " +
          params.part() + "; no effect here");
  // The part has more or fewer lines than the controller drives: the chip's addresses would repeat.
  constexpr unsigned kPartPage = 2048;
  const std::string repeats = "; the chip would not reach or repeat some, the model does not";
  const unsigned page = 1u << c.page_log2;
  say(page != kPartPage, "SDBCR PAGESIZE: rows of " + text(page / 2) + " words, but ddr.part = " +
                             params.part() + " has 1024" + repeats);
  say(t.banks != params.banks(), "SDBCR IBANK: " + text(t.banks) + " banks, but ddr.part = " +
                                     params.part() + " has " + text(params.banks()) + repeats);
  if (c.bank_on_top) {
    std::uint64_t rows = params.size_bytes() / kPartPage / params.banks();
    unsigned bits = 0;
    while (rows >>= 1) ++bits;
    say(9 + regs.sdbcr2.rowsize.get() != bits,
        "SDBCR2 ROWSIZE = " + text(regs.sdbcr2.rowsize.get()) + " with IBANK_POS, but ddr.part = " +
            params.part() + " has " + text(bits) + " row address bits; taken as " + text(bits - 9));
  }
  const unsigned pasr = regs.sdbcr2.pasr.get();
  say(reserved_PASR(pasr), "SDBCR2 PASR = " + text(pasr) + " is reserved; all banks are refreshed");
  say(pasr && !t.mobile,
      "SDBCR2 PASR = " + text(pasr) + " without MSDRAMEN; all banks are refreshed");
  say(t.nRAS < t.nRCD, "SDTIMR T_RAS below T_RCD: a row would close before its first column");
  say(t.nRC <= t.nRAS, "SDTIMR T_RC not above T_RAS: T_RAS and T_RP together bind");
  say(t.nRFC <= t.nRP, "SDTIMR T_RFC not above T_RP: a refresh opens and closes a row");
  say(t.nXSRD < t.nXSNR && c.low_power != LowPower::kOff && !t.mobile,
      "SDTIMR2 T_XSRD below T_XSNR: T_XSNR binds");
  const unsigned rr = regs.sdrcr.rr.get();
  say(rr == 0, "SDRCR RR = 0: the SDRAM is never refreshed; the model keeps its data");
  say(rr != c.refresh_interval, "SDRCR RR = " + text(rr) + " leaves no time between refreshes of " +
                                    text(t.nRFC) + " clocks; taken as " + text(c.refresh_interval));
  say(regs.sdrcr.lpmoden && regs.sdrcr.mclkstopen && regs.sdrcr.sr_pd,
      "SDRCR MCLKSTOPEN with SR_PD: the clock must not stop in power-down; it runs on");
  say(c.read_latency < t.CL, "DDRPHYCR RL = " + text(c.read_latency) + " below CL = " + text(t.CL) +
                                 ": read data would be missed; taken as CL");
  return out;
}

}  // namespace fovea::mem
