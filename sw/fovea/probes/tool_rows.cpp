#include "sw/fovea/probes/tool_rows.h"

namespace fovea::app {

/// For each NAME, `ToolRow NAME_tool()` in a source of its own. The profile is made before Perfetto, which shares the
/// core's call stacks with it.
#define FOVEA_TOOLS(X) \
  X(profile)           \
  X(perfetto)          \
  X(hazards)           \
  X(around)            \
  X(command_trace)     \
  X(bus_trace)         \
  X(register_log)      \
  X(waves)

#define FOVEA_DECLARE(name) ToolRow name##_tool();
FOVEA_TOOLS(FOVEA_DECLARE)

std::vector<ToolRow> tool_rows() {
#define FOVEA_ROW(name) name##_tool(),
  return {FOVEA_TOOLS(FOVEA_ROW)};
}

}  // namespace fovea::app
