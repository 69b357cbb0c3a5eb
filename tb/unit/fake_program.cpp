// Links main.cpp with the fake board, which cannot run other programs.
#include "sw/fovea/machine/machine.h"
#include "sw/fovea/probes/tool_rows.h"
#include "tb/unit/fake_board.h"

namespace fovea::app {
std::unique_ptr<Machine> make_machine(MachineKind kind) {
  if (kind != MachineKind::kBoard) throw UserError("no machine for exec");
  return std::make_unique<test::FakeBoard>();
}
std::vector<ToolRow> tool_rows() { return test::fake_tools(); }
}  // namespace fovea::app
