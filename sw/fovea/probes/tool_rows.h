// All tools of this program.
#pragma once
#include <vector>

#include "sw/fovea/tools/tool.h"

namespace fovea::app {

/// In the order in which they are made, which is that of the help.
std::vector<ToolRow> tool_rows();

}  // namespace fovea::app
