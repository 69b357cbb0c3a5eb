// Texts of rtl/ that follow from the declaration of the remap engine's registers.
#pragma once
#include <string>

#include "model/common/regbank.h"

namespace fovea::soc {

struct RtlText {
  std::string package;  ///< rtl/remap/remap_regs_pkg.sv
  std::string table;    ///< rows of the table of registers in rtl/README.md
};

/// @param fresh registers with their reset values; nothing acts on a write to them. They are left as after writes.
/// @pre no register at or above 0x400
RtlText rtl_text(RegBank& fresh);

/// Of the registers of the remap engine.
RtlText rtl_text();

}  // namespace fovea::soc
