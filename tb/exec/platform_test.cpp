// The machine of `fovea exec`: the walk over its blocks reaches all of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/board/board_params.h"
#include "model/soc/placement.h"
#include "sw/fovea/board/board_debug.h"
#include "sw/fovea/exec/exec_board.h"
#include "tb/soc/reach.h"

namespace fovea::app {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Machine {
  cpu::CpuParams cpu;
  bus::CrossbarParams crossbar;
  bus::ConfigBusParams config_bus;
  mem::DdrParams ddr;
  board::ClockParams clocks;
  ExecMap map{.ram_base = 0x8000'0000, .ram_size = ddr.size_bytes()};
  ExecBoard board{"exec",
                  {cpu, crossbar, config_bus, ddr},
                  map,
                  ExecClocks::of({clocks.preset(), clocks.arm(), clocks.ddr()}),
                  0x8000'0000};
};

struct LooseStats : StatGroup {
  Counter n{*this, "n", "1", "a counter"};
  LooseStats() : StatGroup("loose") {}
};

TEST(ExecPlatform, WalkReachesEveryBlockBankAndStatistic) {
  Machine m;
  EXPECT_THAT(soc::unreached(m.board.platform), IsEmpty());
  {
    LooseStats loose;
    EXPECT_THAT(soc::unreached(m.board.platform), ElementsAre("statistics loose"));
  }
  std::set<std::string> groups;
  m.board.platform.each_statistics([&](const StatGroup& g) { groups.insert(g.prefix()); });
  for (const char* name : {"bus.config", "bus.arm_i", "bus.arm_d", "ddr", "ddr.arm_i.wait", "ddr.arm_d.wait"})
    EXPECT_TRUE(groups.contains(name)) << name;
  const auto blocks = register_blocks(m.board.platform);
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_EQ(blocks[0].name, "ddr");
}

}  // namespace
}  // namespace fovea::app

int sc_main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
