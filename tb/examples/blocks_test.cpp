// The examples on the board, each added by one row: what the row brings with it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "model/board/board.h"
#include "model/common/host_time_slicer.h"
#include "model/soc/memory_map.h"
#include "sw/fovea/board/board_debug.h"
#include "sw/fovea/board/loader.h"
#include "tb/examples/alarm/alarm.h"
#include "tb/examples/filler/filler.h"
#include "tb/soc/reach.h"

namespace fovea::examples {
namespace {

using testing::Contains;
using testing::IsEmpty;

constexpr std::uint32_t kBase = 0x01C6'A000;  // nothing is documented there
constexpr unsigned kLpsc = 6, kIrq = 42;      // not used by another block

/// A board with one more block, whose core does nothing.
struct Rig {
  explicit Rig(soc::Placement row) : params(rows_with(std::move(row))) { params.declare(set); }
  static soc::Placements rows_with(soc::Placement row) {
    soc::Placements rows = soc::dm365_blocks();
    rows.push_back(std::move(row));
    return rows;
  }
  board::Board& build() {
    set.set("camera.kind", "chart");
    source = video::make_picture_source(params.camera, app::load_footage(params),
                                        params.raster_width(), params.raster_height());
    board = std::make_unique<board::Board>("board", params, *source, 0, false);
    board->load({0, {0xFE, 0xFF, 0xFF, 0xEA}});  // b .
    views.emplace(app::board_views(*board, set, nullptr));  // before the simulation starts
    return *board;
  }
  void run(Picoseconds t) { slicer.run(t); }
  /// By its address, as a debugger does: over the configuration bus.
  std::uint32_t read(std::uint32_t address) {
    app::BoardDebugMemory memory(board->dm365);
    std::array<std::uint8_t, 4> bytes{};
    EXPECT_TRUE(memory.debug_read(address, bytes)) << std::hex << address;
    std::uint32_t word = 0;
    std::memcpy(&word, bytes.data(), 4);
    return word;
  }
  std::uint64_t statistic(const std::string& name) {
    for (const auto& row : views->stats())
      if (row.name == name) return std::get<std::uint64_t>(row.value);
    ADD_FAILURE() << "no statistic " << name;
    return 0;
  }
  std::vector<std::string> blocks() {
    std::vector<std::string> names;
    for (const auto& b : app::register_blocks(board->platform)) names.push_back(b.name);
    return names;
  }

  board::BoardParams params;
  ParamSet set;
  std::unique_ptr<video::PictureSource> source;
  std::unique_ptr<board::Board> board;
  std::optional<app::GdbViews> views;
  HostTimeSlicer slicer;
};

soc::Placement alarm_row() {
  return soc::place<Alarm>({"alarm", "example alarm", kBase, 0x400, bus::ConfigBus::Speed::kSlow,
                            soc::BlockClock::kAux, kLpsc, {kIrq}});
}

TEST(Example, PeripheralIsOneRow) {
  Rig rig(alarm_row());
  rig.set.set("alarm.reset_period", "2400");  // 100 us at 24 MHz
  auto& chip = rig.build().dm365;
  auto& alarm = chip.placed.get<Alarm>("alarm");

  EXPECT_THAT(rig.blocks(), Contains("alarm"));
  EXPECT_THAT(soc::unreached(rig.board->platform), IsEmpty());
  EXPECT_EQ(soc::not_modelled_at(kBase), "");
  rig.run(kPsPerUs);
  EXPECT_EQ(rig.read(kBase + 4), 2400u);

  // Without its clock it does not ring: the gate follows the row's LPSC.
  EXPECT_TRUE(alarm.gated());
  alarm.regs.write(0, 4, 1);
  rig.run(10 * kPsPerMs);
  EXPECT_EQ(rig.statistic("alarm.rings"), 0u);
  alarm.regs.write(0, 4, 0);
  chip.psc.regs.write(0xA00 + 4 * kLpsc, 4, 3);
  chip.psc.regs.write(0x120, 4, 1);
  rig.run(10 * kPsPerUs);
  EXPECT_FALSE(alarm.gated());

  // The interrupt arrives at the row's input: 42 is bit 10 of EINT1, and of IRQ1, which is 0 there while
  // the enabled interrupt is pending.
  chip.aintc.regs.regs.write(0x1C, 4, 1u << (kIrq - 32));
  const auto pending = [&chip] {
    std::uint32_t irq1 = 0;
    chip.aintc.regs.regs.read(0x0C, 4, irq1);
    return (irq1 >> (kIrq - 32) & 1u) == 0;
  };
  EXPECT_FALSE(pending());
  alarm.regs.write(0, 4, 1);
  rig.run(99 * kPsPerUs);
  EXPECT_EQ(rig.statistic("alarm.rings"), 0u);
  EXPECT_FALSE(pending());
  rig.run(2 * kPsPerUs);
  EXPECT_EQ(rig.statistic("alarm.rings"), 1u);
  EXPECT_TRUE(pending());
  rig.run(900 * kPsPerUs);
  EXPECT_EQ(rig.statistic("alarm.rings"), 10u);
  EXPECT_EQ(rig.read(kBase + 8), 10u);

  // The window's start resets its statistics with all others.
  rig.board->platform.each_statistics([](StatGroup& g) { g.reset(); });
  EXPECT_EQ(rig.statistic("alarm.rings"), 0u);
}

TEST(Example, PeripheralsParameterIsAKeyLikeOthers) {
  Rig rig(alarm_row());
  const ParamBase* p = rig.set.find("alarm.reset_period");
  ASSERT_NE(p, nullptr);
  EXPECT_EQ(p->default_text(), "24000");
  EXPECT_THROW(rig.set.set("alarm.reset_period", "0"), UserError);
  EXPECT_THAT(soc::undeclared(rig.set), IsEmpty());
}

TEST(Example, RowsThatContradictTheChipAreRefused) {
  const auto build = [](soc::Placement row) { Rig(std::move(row)).build(); };
  soc::Placement row = alarm_row();
  row.base = 0x01C2'0200;  // inside UART0
  EXPECT_EXIT(build(row), testing::ExitedWithCode(4), "register blocks overlap: alarm");
  row = alarm_row();
  row.irqs = {40};  // UART0's
  EXPECT_EXIT(build(row), testing::ExitedWithCode(4), "two blocks on interrupt 40");
  row = alarm_row();
  row.irqs = {{kIrq, true}};
  EXPECT_EXIT(build(row), testing::ExitedWithCode(4), "no choice for interrupt 42");
  row = alarm_row();
  row.irqs = {};
  EXPECT_EXIT(build(row), testing::ExitedWithCode(4), "alarm has another number of interrupts");
  row = alarm_row();
  row.clock = soc::BlockClock::kNone;
  EXPECT_EXIT(build(row), testing::ExitedWithCode(4), "no clock in the row of alarm");
  row = alarm_row();
  row.name = "gpio";
  EXPECT_EXIT(build(row), testing::ExitedWithCode(4), "");
}

TEST(Example, MasterIsMeasuredUnderItsOwnName) {
  Rig rig(soc::place<Filler>({"filler", "example memory master", kBase, 0x400}));
  auto& chip = rig.build().dm365;
  auto& filler = chip.placed.get<Filler>("filler");
  rig.run(kPsPerUs);
  const std::uint64_t before = rig.statistic("bus.vpfe.write_bytes");
  filler.regs.write(0x00, 4, 0x1'1000);  // internal RAM: the SDRAM is not initialised here
  filler.regs.write(0x04, 4, 0x1234'5678);
  filler.regs.write(0x08, 4, 10);
  EXPECT_EQ(rig.read(kBase + 0xC), 10u);
  rig.run(kPsPerMs);
  EXPECT_EQ(rig.read(kBase + 0xC), 0u);
  for (const std::uint32_t at : {0x1'1000u, 0x1'1000u + 10 * 32 - 4})
    EXPECT_THAT(rig.board->peek(at, 4), testing::ElementsAre(0x78, 0x56, 0x34, 0x12));
  EXPECT_THAT(rig.board->peek(0x1'1000 + 10 * 32, 4), testing::ElementsAre(0, 0, 0, 0));
  EXPECT_EQ(rig.statistic("bus.remap_engine.write_bytes"), 320u);
  EXPECT_EQ(rig.statistic("bus.remap_engine.transactions"), 10u);
  EXPECT_EQ(rig.statistic("bus.vpfe.write_bytes"), before);
  std::vector<std::string> names;
  for (const auto& row : rig.views->stats())
    names.push_back(row.name);
  EXPECT_THAT(names, Contains("ddr.remap_engine.wait.write.bridge"));
}

}  // namespace
}  // namespace fovea::examples

int sc_main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
