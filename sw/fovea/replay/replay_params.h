// What `fovea replay` can change: the parameters of crossbar and controller as in a run, and what the
// firmware programs there.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/board/clock_presets.h"
#include "model/bus/core/crossbar_params.h"
#include "model/mem/core/ddr_controller.h"
#include "model/trace/core/trace.h"

namespace fovea::app {

/// Clocks of the path.
struct PathClocks : ParamGroup {
  using U = IntParam::Unit;
  IntParam clock{*this, "clock", U::kHertz, 121'500'000, 1'000'000, 1'000'000'000,
                 "crossbar clock (SYSCLK4)", Origin::kChoice, ""};
  PathClocks() : ParamGroup("bus") {}
};

struct ChipClocks : ParamGroup {
  EnumParam preset{*this, "preset", "as_recorded",
                   board::clock_preset_names({"as_recorded"}),
                   "as clocks.preset of a run, for ddr.clock, which bus.clock follows; the core's clock "
                   "stays as recorded, and so do timings in clocks",
                   Origin::kSourced, "TI boot loader for the DM36x (UBL, device.c)"};
  ChipClocks() : ParamGroup("clocks") {}
};

/// The controller's registers, in clocks and decoded; defaults are what the firmware writes at 243 MHz.
struct DdrRegisterParams : ParamGroup {
  using U = IntParam::Unit;
  // JESD79-2: tCK(avg) 1.875 to 8 ns. JESD209: 5 ns and more, no DLL that bounds it.
  IntParam clock{*this, "clock", U::kHertz, 243'000'000, 1'000'000, 600'000'000,
                 "SDRAM clock; DDR2 125 to 533 MHz, mobile DDR up to 200 MHz", Origin::kChoice, ""};
  IntParam CL = timing("CL", 5, 2, 7, "CAS latency; DDR2 3 to 7, mobile DDR 2 or 3");
  IntParam RL = timing("RL", 5, 1, 15, "DDRPHYCR.RL, read latency of the PHY; at least CL counts");
  IntParam tRFC = timing("tRFC", 31, 1, 128, "REF to REF or ACT");
  IntParam tRP = timing("tRP", 5, 1, 8, "PRE to ACT");
  IntParam tRCD = timing("tRCD", 5, 1, 8, "ACT to RD or WR");
  IntParam tWR = timing("tWR", 4, 1, 8, "write recovery to PRE");
  IntParam tRAS = timing("tRAS", 11, 1, 32, "ACT to PRE");
  IntParam tRC = timing("tRC", 16, 1, 32, "ACT to ACT, same bank");
  IntParam tRRD = timing("tRRD", 4, 1, 8, "ACT to ACT, other bank");
  IntParam tWTR = timing("tWTR", 3, 1, 8, "write to read");
  IntParam tRTP = timing("tRTP", 2, 1, 8, "RD to PRE");
  IntParam tREFI = timing("tREFI", 1895, 0, 65535, "SDRCR.RR, refresh interval; 0: no refresh");
  EnumParam low_power{*this, "low_power", "off",
                      {"off", "self_refresh", "power_down", "clock_stop"},
                      "SDRCR.LPMODEN, SR_PD, MCLKSTOPEN: what an idle controller does with the part",
                      Origin::kChoice, ""};
  IntParam tXP = timing("tXP", 3, 1, 8, "end of power-down to a command");
  IntParam tXSNR = timing("tXSNR", 34, 1, 128, "end of self-refresh to a command");
  IntParam tXSRD = timing("tXSRD", 200, 1, 256, "end of self-refresh to RD");
  IntParam tCKE = timing("tCKE", 4, 1, 8, "CKE low, or high, at least");
  IntParam row_intervals{*this, "row_intervals", U::kCount, 8, 1, 16,
                         "SDTIMR2.T_RASMAX + 1, refresh intervals that a row may be open",
                         Origin::kChoice, ""};
  IntParam old_count{*this, "old_count", U::kCount, 0xFE, 0, 0xFF,
                     "PBBPR.PR_OLD_COUNT, transfers after which the oldest command is raised; 255 "
                     "never",
                     Origin::kChoice, ""};
  EnumParam preset{*this, "preset", "as_recorded", {"as_recorded", "data_sheet"},
                   "data_sheet: clock, CL, RL, timings, refresh, banks and page that are not set by "
                   "hand are those of ddr.part in ddr.grade, in clocks of ddr.clock",
                   Origin::kChoice, "JESD79-2, JESD209"};
  IntParam page{*this, "page", U::kBytes, 2048, 512, 4096, "bytes of a row", Origin::kChoice, ""};
  IntParam banks{*this, "banks", U::kCount, 8, 1, 8, "banks that the controller uses",
                 Origin::kChoice, ""};
  BoolParam bank_on_top{*this, "bank_on_top", false,
                        "SDBCR.IBANK_POS: bank address above the row address", Origin::kChoice, ""};
  DdrRegisterParams() : ParamGroup("ddr") {}

 private:
  IntParam timing(const char* name, std::uint64_t def, std::uint64_t min, std::uint64_t max,
                  const char* sentence) {
    return {*this, name, U::kCycles, def, min, max, sentence, Origin::kChoice, ""};
  }
};

struct ReplayParams {
  bus::CrossbarParams crossbar;
  PathClocks clocks;
  ChipClocks chip_clocks;
  mem::DdrParams ddr;
  DdrRegisterParams registers;

  void declare(ParamSet& set);
  /// A key of the controller that a trace may hold, but that moves nothing here: a replay plays no
  /// contents, so none can be lost.
  static bool without_effect(std::string_view key) { return key == "ddr.retention"; }
  mem::DdrConfig config() const;
  /// @throws UserError for a set of timings that no part allows
  void check() const;
};

/// What a run has in force, as keys of ReplayParams.
std::vector<std::pair<std::string, std::string>> replay_keys(
    const ParamSet& run, const mem::DdrConfig& programmed, Frequency scr, Frequency ddr);

}  // namespace fovea::app
