// The parameter page and the switches on the board: what reaches the chip's registers, and what the
// firmware refuses. Each case is a process of its own, as a simulation elaborates once.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <systemc>

#include "sw/fovea/board/parameter_page.h"
#include "sw/fovea/config/clock_setting.h"
#include "sw/lens/lens.h"
#include "tb/e2e/in_child.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

using test::in_child;

Rig& small_page(Rig& rig) {
  return rig.set("video.width", "64").set("video.height", "16").set("camera.stamp", "false");
}

/// What the firmware says of a page that `damage` has changed; with its state if it is not asleep
/// in phase 7.
std::string said(const std::function<void(param_page_t&)>& damage, bool sealed = true,
                 const std::function<void(board::Board&)>& also = nullptr) {
  return in_child([&] {
    Rig rig;
    small_page(rig);
    board::Board& board = rig.build();
    const auto bytes = board.peek(PARAM_PAGE_BASE, sizeof(param_page_t));
    param_page_t page;
    std::memcpy(&page, bytes.data(), sizeof page);
    damage(page);
    if (sealed) param_page_seal(&page);
    board::LoadImage image{PARAM_PAGE_BASE, std::vector<std::uint8_t>(sizeof page)};
    std::memcpy(image.bytes.data(), &page, sizeof page);
    board.load(image);
    if (also) also(board);
    rig.advance(60 * kPsPerMs);
    std::string text = board.uart_text();
    if (board.log.phase() != board::Phase::kFailed) text += "(phase)";
    if (!board.dm365.arm.asleep()) text += "(awake)";
    return text;
  });
}
const auto nothing = [](param_page_t&) {};

TEST(PageTest, EachFaultOfThePageStopsTheBootWithASentence) {
  const std::string prefix = "failed: parameter page: ";
  EXPECT_EQ(said([](param_page_t& p) { p.magic = 0; }, false),
            prefix + "there is none (unknown magic)\r\n");
  EXPECT_EQ(said([](param_page_t& p) { p.version = 6; }, false),
            prefix + "unknown version; this firmware reads version 5\r\n");
  EXPECT_EQ(said([](param_page_t& p) { p.bytes -= 4; }, false),
            prefix + "too small for its version and its cameras\r\n");
  EXPECT_EQ(said([](param_page_t& p) { p.repeats += 1; }, false),
            prefix + "its checksum is wrong\r\n");
  EXPECT_EQ(said([](param_page_t& p) { p.clocks.pll1.multiplier = 0; }),
            prefix + "a PLL's multiplier must be 1 to 1023, its dividers 1 to 32\r\n");
}

TEST(PageTest, EachFaultOfTheApplicationsPartIsNamed) {
  EXPECT_NE(said([](param_page_t& p) { p.kernel = 14; })
                .find("failed: configuration: parameter page: unknown kernel; this firmware has 0 "
                      "(plain) to 13 (engine_radial)\r\n"),
            std::string::npos);
  EXPECT_NE(said([](param_page_t& p) { p.table_builder = 2; }).find("unknown table builder"),
            std::string::npos);
  EXPECT_NE(said([](param_page_t& p) {
              p.tables = 5;
            }).find("too many look-up tables; this firmware has memory for 4\r\n"),
            std::string::npos);
  EXPECT_NE(said([](param_page_t& p) {
              p.camera_count = 2;
            }).find("several cameras; this firmware serves one\r\n"),
            std::string::npos);
  const std::string other_output =
      said(nothing, true, [](board::Board& b) { b.dm365.gpio.set_pin(1, true); });
  EXPECT_NE(other_output.find("failed: configuration: switches 0 and 1: camera and display must "
                              "have the same standard"),
            std::string::npos)
      << other_output;
  EXPECT_EQ(other_output.find("(awake)"), std::string::npos);
  EXPECT_NE(said(nothing).find("(phase)"), std::string::npos) << "a good page is not refused";
}

// The chip's registers after the boot are those of the keys.
TEST(PageTest, ClocksAndPrioritiesReachTheRegisters) {
  Rig rig;
  small_page(rig).set("clocks.arm", "135MHz").set("clocks.ddr", "162MHz");
  rig.set("priority.arm", "3")
      .set("priority.vpfe", "2")
      .set("priority.vpbe", "4")
      .set("priority.remap_engine", "6");
  rig.set("priority.edma_tc0", "1").set("priority.edma_tc3", "5").set("edma.reset_priority", "7");
  board::Board& board = rig.build();
  rig.advance(40 * kPsPerMs);
  soc::Dm365& soc = board.dm365;
  EXPECT_EQ(soc.system.regs.mstpri0.get(), 0x00560013u);
  EXPECT_EQ(soc.vpss.regs.bcr.get(), 0x2u | 4u << 2 | 2u << 5);
  EXPECT_EQ(soc.edma.regs.quepri.get(), 0x5771u);
  EXPECT_EQ(soc.arm.clk.read(), Frequency(135'000'000));
  EXPECT_EQ(soc.ddr.ddr_clk.read(), Frequency(162'000'000));
  EXPECT_EQ(soc.scr.clk.read(), Frequency(81'000'000));
  EXPECT_NE(board.uart_text().find("boot: clocks 135000/162000 kHz\r\n"), std::string::npos)
      << board.uart_text();
  const app::DdrRegisters words = app::ddr_registers(Frequency(162'000'000));
  const struct {
    std::uint32_t offset, word;
  } rows[] = {{0x0C, words.sdrcr}, {0x10, words.sdtimr}, {0x14, words.sdtimr2}};
  for (const auto& row : rows) {
    std::uint32_t value = 0;
    EXPECT_EQ(soc.ddr.regs.read(row.offset, 4, value), Access::kOk);
    EXPECT_EQ(value, row.word) << row.offset;
  }
  EXPECT_EQ(words.sdrcr, 1263u) << "7.8 us at 162 MHz";
}

// The switches' shift is that of the key, moved by 32 pixels; so is the table that the board has
// built.
TEST(PageTest, TheShiftOfTheSwitchesMovesTheView) {
  Rig rig;
  small_page(rig)
      .set("switches.shift_x", "left")
      .set("switches.shift_y", "down")
      .set("lens.shift_x", "3px");
  rig.set("lens.fov", "40deg").set("run.frames", "1");
  rig.build();
  for (int i = 0; i < 400 && rig.state().magic == 0; ++i) rig.advance(kPsPerMs);
  lens_view_t view;
  lens_view_default(&view);
  view.fov_deg = 40;
  view.shift_x = 3 - 32;
  view.shift_y = 32;
  lens_t lens;
  ASSERT_EQ(lens_init(&lens, &view, 64, 16), LENS_OK);
  std::vector<std::uint32_t> expected(lens_lut_entries(64, 16));
  lens_build_lut(&lens, expected.data(), 128);
  EXPECT_EQ(rig.lut(), expected);
}

/// The table in memory, and the time that it took in ticks of 24 MHz behind it.
std::string table_built(const char* builder) {
  return in_child([&] {
    Rig rig;
    rig.load("default.yaml").set("firmware.lut", builder).set("ddr.check", "none");
    rig.build();
    for (int i = 0; i < 400 && rig.state().magic == 0; ++i) rig.advance(10 * kPsPerMs);
    std::vector<std::uint32_t> words = rig.lut();
    words.push_back(rig.state().lut_time_ticks);
    return std::string(reinterpret_cast<const char*>(words.data()), words.size() * 4);
  });
}

// The shipped lens in full size: each entry that the core computes, and in less than a tenth of a
// second.
TEST(PageTest, BothTableBuildersGiveTheSameTable) {
  const std::string fixed = table_built("fixed_point"), exact = table_built("soft_float");
  ASSERT_EQ(fixed.size(), (720 / 2 * 576 + 1) * 4u);
  ASSERT_EQ(exact.size(), fixed.size());
  const std::size_t bytes = fixed.size() - 4;
  EXPECT_TRUE(fixed.compare(0, bytes, exact, 0, bytes) == 0);
  const auto ticks = [bytes](const std::string& built) {
    std::uint32_t value;
    std::memcpy(&value, built.data() + bytes, 4);
    return value;
  };
  EXPECT_LT(ticks(fixed), 24'000'000u / 10) << "0.1 s";
  EXPECT_GT(ticks(exact), 24'000'000u) << "not computed in double precision";
}

// What does not fit into fixed point is said, and computed in double precision.
TEST(PageTest, ATableThatIsNotInFixedPointIsReported) {
  const auto with = [](double centre_x, std::uint32_t builder) {
    return said([&](param_page_t& p) {
      p.table_builder = builder;
      p.camera[0].view.centre_x = centre_x;
    });
  };
  const std::string far = with(9000, BUILDER_FIXED);
  EXPECT_NE(far.find("LUT: not in fixed point: lens and view do not fit into 32 bits\r\n"
                     "LUT: 512 entries in "),
            std::string::npos)
      << far;
  for (const std::string& text : {with(0, BUILDER_FIXED), with(9000, BUILDER_DOUBLE)}) {
    EXPECT_EQ(text.find("fixed point"), std::string::npos) << text;
    EXPECT_NE(text.find("LUT: 512 entries in "), std::string::npos) << text;
  }
}

// A key's priority in time: the core's reads against a synthetic load of priority 3.
TEST(PageTest, APriorityMovesTheTimeOfItsMaster) {
  const auto mean = [](const char* key, const char* level, Master m, const char* gap) {
    return std::stod(in_child([&] {
      Rig rig;
      rig.set("video.width", "320")
          .set("video.height", "64")
          .set("camera.stamp", "false")
          .set("run.frames", "1000");
      rig.set("load.outstanding", "12").set("load.kind", "mixed").set("load.pattern", "random");
      rig.set("load.priority", "3")
          .set("load.start", "300ms")
          .set("load.base", "32MiB")
          .set("load.gap", gap);
      rig.set(key, level);
      board::Board& board = rig.build();
      rig.advance(500 * kPsPerMs);
      soc::Dm365& soc = board.dm365;
      const auto sums = [&] {
        soc.scr.settle();
        double ps = 0;
        for (const WaitTable* t : {&soc.scr.crossbar().waits, &soc.ddr.controller().waits()})
          for (std::size_t c = 0; c < kCulprits; ++c)
            ps += static_cast<double>((*t)[index(m)].read.ps[c] + (*t)[index(m)].write.ps[c]);
        return std::pair(
            ps, static_cast<double>(soc.scr.crossbar().stats[stat_index(m)]->transactions.count()));
      };
      const auto before = sums();
      rig.advance(80 * kPsPerMs);
      const auto after = sums();
      return std::to_string((after.first - before.first) / (after.second - before.second) * 1e-3);
    }));
  };
  const struct {
    const char* key;
    Master master;
    const char* gap;  ///< of the load: at 3 us it hardly ever meets the camera's bursts
  } rows[] = {{"priority.arm", Master::kArmD, "3us"},
              {"priority.vpbe", Master::kVpbe, "3us"},
              {"priority.vpfe", Master::kVpfe, "2100ns"}};
  for (const auto& row : rows) {
    const double urgent = mean(row.key, "0", row.master, row.gap);
    const double patient = mean(row.key, "7", row.master, row.gap);
    std::printf("  %-14s %.0f ns at 0, %.0f ns at 7\n", row.key, urgent, patient);
    EXPECT_LT(urgent * 1.01, patient) << row.key;
  }
}

}  // namespace
}  // namespace fovea::e2e
