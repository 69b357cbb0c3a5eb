// What the controller's registers mean to its core, and what is wrong with them.
#pragma once
#include <string>
#include <vector>

#include "model/mem/core/ddr_controller.h"
#include "model/mem/ddr_regs.h"

namespace fovea::mem {

/// Timing fields hold clocks - 1. The controller keeps what was programmed, whatever the part would
/// like; only reserved values become others (README.md says which).
DdrConfig decode(const DdrRegs& regs);

/// One line for each value that makes no sense by itself or with this part: register and field, the
/// value, what the model does. Timing against the data sheet is DdrCheck's.
std::vector<std::string> invalid_register_values(const DdrRegs& regs, const DdrParams& params);

}  // namespace fovea::mem
