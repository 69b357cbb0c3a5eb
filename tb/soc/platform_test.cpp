// The walk over the board's blocks reaches all of them; what it does not reach makes the test fail.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>

#include "model/board/board.h"
#include "model/engine/remap_engine.h"
#include "sw/fovea/board/board_debug.h"
#include "sw/fovea/board/loader.h"
#include "tb/soc/reach.h"

namespace fovea::soc {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

using Settings = std::vector<std::pair<std::string, std::string>>;

struct TestBoard {
  explicit TestBoard(const Settings& more = {}, bool cpld = true) {
    params.declare(set);
    set.set("camera.kind", "chart");
    if (cpld) set.set("board.cpld", "true");
    set.set("load.outstanding", "1");
    set.set("load.1.outstanding", "1");
    set.set("load.1.port", "edma_tc0");
    for (const auto& [key, value] : more) set.set(key, value);
    std::vector<video::PictureSource*> pictures;
    for (unsigned n = 0; n < params.camera_count(); ++n) {
      sources.push_back(app::camera_source(params, n));
      pictures.push_back(sources.back().get());
    }
    board = std::make_unique<board::Board>("board", params, pictures, 0, false);
  }
  board::BoardParams params;
  ParamSet set;
  std::vector<std::unique_ptr<video::StampedSource>> sources;
  std::unique_ptr<board::Board> board;
};

// What only some boards have: the engine as each of its models, several cameras behind the decoder's inputs or a
// multiplexer, a camera at the digital port.
const Settings kBoards[] = {
    {},
    {{"engine", "tlm"}},
#ifdef FOVEA_WITH_RTL
    {{"engine", "rtl"}},
    {{"engine", "both"}},
    {{"engine", "both_tlm"}},
#endif
    {{"cameras.count", "4"}},
    {{"cameras.count", "8"}, {"engine", "tlm"}},
    {{"video.standard", "vga_progressive"}},
};

std::string board_name(const testing::TestParamInfo<Settings>& info) {
  std::string name = "plain";
  if (!info.param.empty()) name.clear();
  for (const auto& [key, value] : info.param) name += (name.empty() ? "" : "_") + key + "_" + value;
  std::replace_if(name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
}

struct PlatformOf : testing::TestWithParam<Settings> {};
INSTANTIATE_TEST_SUITE_P(Boards, PlatformOf, testing::ValuesIn(kBoards), board_name);

TEST_P(PlatformOf, WalkReachesEveryBlockBankAndStatistic) {
  TestBoard t(GetParam());
  EXPECT_THAT(unreached(t.board->platform), IsEmpty());
  EXPECT_THAT(undeclared(t.set), IsEmpty());
}

/// What a sleep that this block's interrupt ends is counted as; the VPSS goes by the source.
cpu::WakeEvent expected_event(const BusTarget& block) {
  if (dynamic_cast<const dma::EdmaCc*>(&block) || dynamic_cast<const dma::EdmaTc*>(&block))
    return cpu::WakeEvent::kDma;
  if (dynamic_cast<const periph::Timer64*>(&block)) return cpu::WakeEvent::kTimer;
  if (dynamic_cast<const engine::RemapEngine*>(&block)) return cpu::WakeEvent::kEngine;
  return cpu::WakeEvent::kOther;
}

TEST(Platform, EachInterruptIsCountedAsItsBlock) {
  TestBoard t(Settings{{"engine", "tlm"}});
  const Dm365& chip = t.board->dm365;
  unsigned sources = 0;
  for (std::size_t k = 0; k < chip.placed.size(); ++k) {
    const Placement& row = chip.placed.row(k);
    if (row.name == "vpss") continue;
    EXPECT_EQ(row.wakes, expected_event(chip.placed.block(k))) << row.name;
    for (std::size_t i = 0; i < row.irqs.size(); ++i) {
      if (row.irqs[i].second) continue;  // ARM_INTMUX selects the first source out of reset
      const auto source = chip.interrupt_source(row.irqs[i].input);
      EXPECT_TRUE(source.name.starts_with(row.name + ".")) << source.name;
      EXPECT_EQ(source.event, row.wakes) << source.name;
      ++sources;
    }
  }
  EXPECT_GT(sources, 20u);
}

TEST(Platform, AParameterThatIsNotDeclaredIsFound) {
  TestBoard t;
  struct Forgotten : ParamGroup {
    IntParam p{*this, "p", IntParam::Unit::kCount, 1, 0, 2, "a parameter", Origin::kChoice, ""};
    Forgotten() : ParamGroup("forgotten") {}
  } forgotten;
  EXPECT_THAT(undeclared(t.set), ElementsAre("parameters forgotten"));
}

struct PlantedStats : StatGroup {
  Counter n{*this, "n", "1", "a counter"};
  PlantedStats() : StatGroup("planted") {}
};
struct PlantedRegs : RegBank {
  Reg r{*this, "R", 0, Mode::kRw, "a register"};
  PlantedRegs() : RegBank("PLANTED") {}
};
struct PlantedBlock : WithRegs<PlantedRegs>, BusTarget {
  PlantedStats stats;
  explicit PlantedBlock(sc_core::sc_module_name name) : BusTarget(name, regs) {
    add_statistics(stats);
  }
};

TEST(Platform, ABlockThatTheWalkDoesNotReachIsFound) {
  TestBoard t;
  PlantedBlock planted("planted");
  EXPECT_THAT(unreached(t.board->platform),
              ElementsAre("block planted", "registers PLANTED", "statistics planted"));
  t.board->platform.add("planted", planted);
  EXPECT_THAT(unreached(t.board->platform), IsEmpty());
  PlantedStats loose;  // of a block that does not mention it
  EXPECT_THAT(unreached(t.board->platform), ElementsAre("statistics planted"));
}

TEST(Platform, NamesAndBlocksOccurOnce) {
  TestBoard t;
  EXPECT_EXIT(t.board->platform.add("uart0", t.board->dm365.gpio), testing::ExitedWithCode(4),
              "two blocks named uart0");
  EXPECT_EXIT(t.board->platform.add("another", t.board->dm365.gpio), testing::ExitedWithCode(4),
              "block added twice: another");
}

// Both were missing in lists that were kept by hand.
TEST(Platform, DebuggerAndRegisterLogSeeEdmaAndCpld) {
  TestBoard t;
  std::vector<std::string> names;
  for (const auto& b : app::register_blocks(t.board->platform)) names.push_back(b.name);
  EXPECT_THAT(names, Contains("edma"));
  EXPECT_THAT(names, Contains("cpld"));
  EXPECT_EQ(names.size(), 25u);  // 14, five timers, four transfer controllers, and these
}

TEST(Platform, MonitorHasTheWaits) {
  TestBoard t;
  const app::GdbViews views = app::board_views(*t.board, t.set, nullptr);
  std::vector<std::string> names;
  for (const auto& row : views.stats()) names.push_back(row.name);
  EXPECT_THAT(names, Contains("ddr.vpfe.wait.write.bridge"));
  EXPECT_THAT(names, Contains("ddr.load.wait.read.own"));
  EXPECT_THAT(names, Contains("ddr.edma_tc0.wait.read.own"));
  EXPECT_THAT(names, Contains("display.frames"));
}

}  // namespace
}  // namespace fovea::soc

int sc_main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
