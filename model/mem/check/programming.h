// What software programmed, held against the part's data sheet at the present clock. It costs nothing
// per command: registers and clock are looked at when they change.
#pragma once
#include <string>
#include <vector>

#include "model/mem/check/data_sheet.h"

namespace fovea::mem::check {

struct Programmed {
  DataSheet clocks;         ///< tREFI: SDRCR.RR; tRASmax: (T_RASMAX + 1) RR; tFAW is not looked at
  bool sleeps = false;      ///< power-down or self-refresh is on: their times count
};

/// One line for each value that the part does not allow: register and field, clocks programmed, what
/// the part needs, by how much it is missed. Empty: all is within the sheet.
std::vector<std::string> violations(const Programmed& programmed, const Part& part, Frequency clock);

}  // namespace fovea::mem::check
