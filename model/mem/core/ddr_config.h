// What the registers of the SDRAM controller say, decoded.
#pragma once
#include "model/mem/core/ddr_params.h"
#include "model/mem/core/ddr_timing.h"

namespace fovea::mem {

/// What an idle controller does with the part (SDRCR.LPMODEN, SR_PD and MCLKSTOPEN). kClockStop:
/// self-refresh, and the memory's clock stands.
enum class LowPower : std::uint8_t { kOff, kSelfRefresh, kPowerDown, kClockStop };
constexpr bool refreshes_itself(LowPower p) {
  return p == LowPower::kSelfRefresh || p == LowPower::kClockStop;
}

/// SDBCR, SDBCR2, SDTIMR, SDTIMR2, SDRCR, PBBPR and DDRPHYCR.
struct DdrConfig {
  DdrTiming timing;
  unsigned read_latency = 5;         ///< DDRPHYCR.RL, clocks; CL is the floor
  unsigned refresh_interval = 1895;  ///< SDRCR.RR, clocks; 0: no refresh
  unsigned old_count = 0xFF;         ///< PBBPR.PR_OLD_COUNT; 0xFF: never
  unsigned page_log2 = 11;           ///< bytes of a row on the 16-bit bus
  bool bank_on_top = false;          ///< SDBCR.IBANK_POS: row stays in its bank
  LowPower low_power = LowPower::kOff;
  unsigned row_intervals = 16;  ///< SDTIMR2.T_RASMAX + 1: refresh intervals that a row may be open
  /// SDBCR2.PASR of a mobile part: self-refresh keeps the first 1/2^n of the array.
  unsigned refreshed_log2 = 0;
};

/// What the registers say with one thing of `ddr.ideal` better than any part has it.
DdrConfig idealised(DdrConfig config, const DdrParams& params);

}  // namespace fovea::mem
