// A kernel_horizon() of the test's own, so that a test can show that a late one is noticed. Only a
// program that links late_horizon.cpp has it.
#pragma once
#include "model/common/units.h"

namespace fovea {

/// Added to every horizon; 0: the horizon is the kernel's.
inline Picoseconds planted_late_horizon = 0;

}  // namespace fovea
