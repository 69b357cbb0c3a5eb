// Gives main.cpp the stand-in board.
#include "tb/unit/fake_board.h"

namespace fovea::app {
std::unique_ptr<Simulation> make_simulation() { return std::make_unique<test::FakeBoard>(); }
}  // namespace fovea::app
