// Data sheets of the parts that `ddr.part` names, by speed grade, and their numbers in clocks. Typed
// in from public sheets for the checkers alone: the model takes nothing from here.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "model/common/units.h"

namespace fovea::mem::check {

/// Minima in ps unless said.
struct Part {
  std::string name;  ///< with its grade: "MT47H64M16-3"
  bool mobile = false;
  unsigned banks = 8;
  unsigned page_bytes = 2048;
  std::uint64_t bytes = 0;
  std::array<Picoseconds, 8> tCK{};  ///< shortest clock period by CL; 0: CL not offered
  Picoseconds tRCD = 0, tRP = 0, tRAS = 0, tRC = 0, tRRD = 0, tWR = 0, tRFC = 0;
  Picoseconds tWTR = 0, tRTP = 0, tFAW = 0;  ///< tFAW 0: a part of four banks has none
  Picoseconds tXSNR = 0;                     ///< mobile parts: tXSR
  unsigned tWTR_clocks = 0;                  ///< mobile parts give it in clocks
  unsigned tXP = 2, tCKE = 3, tXSRD = 200;   ///< clocks
  Picoseconds tREFI = 7'800'000;             ///< maximum
  Picoseconds tRASmax = 70'000'000;          ///< maximum
};

/// The words of `ddr.part` and `ddr.grade`; grade "default": the one that the table names first for
/// this part. @throws std::out_of_range for a grade that this kind of part does not come in
Part find_part(const std::string& part, const std::string& grade = "default");

/// The numbers of a part at one clock, or what software programmed, in clocks.
struct DataSheet {
  unsigned CL = 5;
  unsigned tRCD = 5, tRP = 5, tRAS = 11, tRC = 16, tRRD = 3;
  unsigned tWR = 4, tWTR = 3, tRTP = 2, tRFC = 31;
  unsigned tXP = 3, tXSNR = 34, tXSRD = 200, tCKE = 3;
  unsigned tFAW = 0;           ///< 0: not checked. TI's controller has no such field.
  unsigned tREFI = 0;          ///< 0: refresh not checked
  std::uint64_t tRASmax = 0;   ///< 0: not checked
  unsigned banks = 8;
  bool mobile = false;         ///< mobile DDR: WL = 1, no tRTP, a read's own data bounds RD to WR
  unsigned postponed_max = 8;  ///< so at most 9 tREFI between two REF
  unsigned tSR = 0;            ///< shortest self-refresh; 0: tCKE alone
  bool refresh_before_sleep = false;  ///< a REF at least between two self-refreshes (DDR2, not mobile DDR)
  bool refresh_after_sleep = false;   ///< the first command behind a self-refresh is a REF
  bool counts_postponed = false;  ///< more than postponed_max refreshes owed at once is an offence too
};

/// Minima rounded up, tREFI and tRASmax down.
DataSheet in_clocks(const Part& part, Frequency clock, unsigned CL);
/// True if the part may run at this clock with this CL.
bool offers(const Part& part, Frequency clock, unsigned CL);

/// "243 MHz", "166.667 MHz".
std::string megahertz(Frequency f);
/// "7.5 ns"
std::string nanoseconds(Picoseconds t);

}  // namespace fovea::mem::check
