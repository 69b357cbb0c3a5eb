// Links main.cpp with the fake board, which cannot run other programs.
#include "sw/fovea/machine/executor.h"
#include "tb/unit/fake_board.h"

namespace fovea::app {
std::unique_ptr<Simulation> make_simulation() { return std::make_unique<test::FakeBoard>(); }
std::unique_ptr<Executor> make_executor() { throw UserError("no machine for exec"); }
}  // namespace fovea::app
