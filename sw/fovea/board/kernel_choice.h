// Which remap kernel the camera's firmware takes: what is asked for, and what ran.
#pragma once
#include <string>
#include <string_view>

#include "model/board/board_params.h"

namespace fovea::app {

/// Warns if the firmware will not take the kernel that is asked for, as far as that is known before it runs: a remap
/// engine without its kernel, its kernel without an engine, a kernel without a form for a composed view.
void check_kernel(const board::BoardParams& params);

/// The kernels that the firmware, or one made from it, names on its UART once it has prepared its tables, each once,
/// separated by ", "; empty if the program names none. Warns if none is the one that was asked for and check_kernel()
/// did not know.
std::string kernel_that_ran(const board::BoardParams& params, std::string_view uart);

}  // namespace fovea::app
