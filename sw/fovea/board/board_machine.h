// The DM365 board as a machine.
#pragma once
#include <memory>

#include "sw/fovea/machine/machine.h"

namespace fovea::app {

/// @param for_program what is known of the camera's firmware does not hold: the user brings a program
std::unique_ptr<Machine> make_board(bool for_program);

}  // namespace fovea::app
