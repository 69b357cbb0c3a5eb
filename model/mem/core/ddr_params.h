// Parameters of the DDR2 controller and of the memory behind it.
#pragma once
#include <string_view>

#include "model/common/check.h"
#include "model/common/param.h"

namespace fovea::mem {

struct DdrParams : ParamGroup {
  using U = IntParam::Unit;
  static constexpr const char* kSisters =
      "TMS320DM643x, TMS320C642x, AM1808 (SPRU986B, SPRUEM4A, SPRUH82C): the same controller";
  static constexpr const char* kSistersAgree = "the guides of three sister chips agree";
  static constexpr const char* kLevels =
      "refresh urgency levels of the same controller in sister chips (SPRU986B)";
  static constexpr const char* kLevelsBelief =
      "the levels are known of older chips; JESD79-2 lets eight refreshes be postponed";
  EnumParam part{*this, "part", "mt47h64m16", {"mt47h32m16", "mt47h64m16", "mt47h128m16",
                                                "mt46h32m16lf", "mt46h64m16lf"},
                 "x16 part, 2 KiB page: DDR2 of 64, 128, 256 MiB (4, 8, 8 banks) or mobile DDR of "
                 "64, 128 MiB (4 banks)",
                 Origin::kChoice, "Micron data sheets"};
  EnumParam grade{*this, "grade", "default", {"default", "37e", "3", "25e", "25", "5", "6", "75"},
                  "speed grade of the part that warnings refer to; default: 37e, 3, 25e, "
                  "6, 6 for the parts in their order",
                  Origin::kChoice, "JESD79-2, JESD209"};
  EnumParam check{*this, "check", "none", {"none", "commands"},
                  "commands: independent checkers read the SDRAM's command bus; violations of the "
                  "part's data sheet are reported as warnings with a count",
                  Origin::kChoice, ""};
  IntParam command_fifo{*this, "command_fifo", U::kCount, 7, 1, 16,
                        "entries of the controller's command FIFO", Origin::kFamily, kSisters,
                        {"7", "7", kSistersAgree}};
  IntParam write_fifo{*this, "write_fifo", U::kBytes, 88, 64, 512,
                      "write data the controller holds: 11 x 64 bit", Origin::kFamily, kSisters,
                      {"88B", "88B", kSistersAgree}};
  IntParam read_fifo{*this, "read_fifo", U::kBytes, 136, 64, 512,
                     "read data the controller holds: 17 x 64 bit", Origin::kFamily, kSisters,
                     {"136B", "136B", kSistersAgree}};
  IntParam request_latency{*this, "request_latency", U::kCycles, 8, 0, 32,
                           "DDR clocks from the request's arrival to its first DRAM command",
                           Origin::kAssumed, "no public figure",
                           {"6 cycles", "10 cycles",
                            "synchronisation, FIFO and decision take about two clocks each"}};
  IntParam return_latency{*this, "return_latency", U::kCycles, 2, 0, 16,
                          "DDR clocks from the last data beat at the PHY to the crossbar",
                          Origin::kAssumed, "no public figure",
                          {"1 cycles", "4 cycles",
                           "DDRPHYCR.RL covers the PHY; a FIFO and a register stage remain"}};
  IntParam clock_restart{*this, "clock_restart", U::kCycles, 1, 0, 64,
                         "DDR clocks from the restart of a stopped memory clock (MCLKSTOPEN) to CKE",
                         Origin::kAssumed, "no public figure",
                         {"1 cycles", "4 cycles",
                          "JESD209 asks for a stable clock before CKE rises; one clock is the least"}};
  IntParam retention{*this, "retention", U::kTime, 64 * kPsPerMs, 1, 3600 * kPsPerSecond,
                     "self-refresh longer than this loses what partial-array self-refresh leaves out",
                     Origin::kAssumed, "rows are refreshed every 64 ms (JESD209)",
                     {"64ms", "10s", "guaranteed at the hottest; cool cells keep data for seconds"}};
  IntParam refresh_release{*this, "refresh.release", U::kCount, 3, 0, 64,
                           "refresh backlog down to which refreshes follow each other once it was above "
                           "refresh.must",
                           Origin::kFamily, kLevels,
                           {"3", "11", "SPRU986B has the level; that requests wait until then is said of "
                                       "AM335x only (SPRUH73): 11 is one refresh at a time"}};
  IntParam refresh_need{*this, "refresh.need", U::kCount, 7, 0, 32,
                        "refresh backlog above which refresh goes before writes", Origin::kFamily,
                        kLevels, {"3", "8", kLevelsBelief}};
  IntParam refresh_must{*this, "refresh.must", U::kCount, 11, 0, 64,
                        "refresh backlog above which refresh goes before everything",
                        Origin::kFamily, kLevels, {"7", "12", kLevelsBelief}};
  IntParam refresh_gap{*this, "refresh.gap", U::kCount, 7, 1, 64,
                       "intervals without a REF above which four are issued before requests",
                       Origin::kFamily, kSisters, {"7", "7", kSistersAgree}};
  EnumParam scheduler{*this, "scheduler", "ti", {"ti", "fcfs", "frfcfs", "closed_page"},
                      "ti: the chip's; fcfs: data strictly by age, rows opened ahead; frfcfs: what is "
                      "ready first, so open rows, then age, of all; closed_page: ti, but a row that no request "
                      "waits for is closed after its access",
                      Origin::kChoice, ""};
  EnumParam ti_open_row{*this, "ti_open_row", "activated", {"activated", "ready"},
                        "which rows ti and closed_page serve first as open: activated, all from their "
                        "ACT on; ready, those whose data command is legal first (tRCD is over)",
                        Origin::kAssumed,
                        "\"the ACTV command opens a row\" (SPRUH82C 14.2.3.3), a sister chip; the choice "
                        "among open rows is not public",
                        {"activated", "ready", "a controller may know which rows can be read already"}};
  EnumParam ideal{*this, "ideal", "none", {"none", "row_timing", "cas_latency", "turnaround", "refresh"},
                  "one thing better than any part has it, whatever is programmed, to find out what binds: rows open "
                  "and close in 1 clock; CL and RL of 4 clocks at most; write to read in 1 clock; no refresh",
                  Origin::kChoice, ""};
  DdrParams() : ParamGroup("ddr") {
    ti_open_row.matters_only("ddr.scheduler = ti or closed_page", {&scheduler},
                             [this] { return scheduler.is("ti") || scheduler.is("closed_page"); });
  }

  std::uint64_t size_bytes() const { return std::uint64_t{row().mebibytes} << 20; }
  bool mobile() const { return row().mobile; }
  unsigned banks() const { return row().banks; }

 private:
  struct Part {
    std::string_view name;
    unsigned mebibytes, banks;
    bool mobile;
  };
  static constexpr Part kParts[] = {{"mt47h32m16", 64, 4, false},
                                    {"mt47h64m16", 128, 8, false},
                                    {"mt47h128m16", 256, 8, false},
                                    {"mt46h32m16lf", 64, 4, true},
                                    {"mt46h64m16lf", 128, 4, true}};
  const Part& row() const {
    for (const Part& p : kParts)
      if (part.is(p.name)) return p;
    FOVEA_CHECK(false, "no such part: " + part());
  }
};

}  // namespace fovea::mem
