// OSD, VENC and display: the display gets the contents of memory at the right time.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tb/video/display_bench.h"

namespace fovea::video {
namespace {

TEST_F(DisplayTest, MemoryPictureEqualsWhatTheDisplayReceives) {
  show(2);
  EXPECT_EQ(wrong(b.frames[0].picture), 0u);
  for (std::size_t field = 0; field < 4; ++field) EXPECT_EQ(b.latches.at(field).address, kBuffer);
  EXPECT_EQ(underflows(), 0u);
}

TEST_F(DisplayTest, AFrameIsRepeatedIfItHasTheBuffersAndThePixelsOfTheOneBefore) {
  // A change is made between the last row of a frame and the latch of the next one, two lines later at the earliest.
  b.venc_regs.write(VMOD, kOn);
  const auto next_frame = [this] {
    for (const std::size_t before = b.frames.size(); b.frames.size() == before;) run_for(10 * kPsPerUs);
  };
  const auto after = [&](auto change) {
    const std::uint64_t before = repeated();
    change();
    next_frame();
    return repeated() - before;
  };
  b.osd_regs.write(VIDWINMD, 0);
  next_frame();
  next_frame();
  EXPECT_EQ(after([this] { b.osd_regs.write(VIDWINMD, 3); }), 0u) << "black before";
  EXPECT_EQ(after([] {}), 1u);
  EXPECT_EQ(after([this] {
              for (unsigned i = 0; i < kRows * kPitch; ++i) b.memory.at(kOther)[i] = b.memory.at(kBuffer)[i];
              set_address(kOther);
            }),
            0u)
      << "the same pixels in another buffer";
  EXPECT_EQ(after([] {}), 1u);
  EXPECT_EQ(after([this] { b.memory.at(kOther)[kRows * kPitch - 1] ^= 1; }), 0u);
  EXPECT_EQ(after([] {}), 1u);
  EXPECT_EQ(after([this] { b.osd_regs.write(VIDWINMD, 2); }), 0u) << "the window is off";
  EXPECT_EQ(after([] {}), 0u) << "black is not counted";
}

TEST_F(DisplayTest, FirstFieldShowsTheUpperRows) {
  show(1);
  ASSERT_GE(b.tap.firsts.size(), 2u);
  EXPECT_EQ(b.tap.firsts[0].number, kIs625 ? 23u : 20u);
  EXPECT_EQ(b.tap.firsts[0].byte, pattern(0, 0));
  EXPECT_EQ(b.tap.firsts[1].number, kIs625 ? 336u : 283u);
  EXPECT_EQ(b.tap.firsts[1].byte, pattern(1, 0));
}

TEST_F(DisplayTest, FieldInversionShowsTheLowerRowsFirst) {
  b.osd_regs.write(MODE, 1u << 9);
  show(1);
  EXPECT_EQ(b.tap.firsts[0].byte, pattern(1, 0));
  EXPECT_EQ(b.tap.firsts[1].byte, pattern(0, 0));
}

TEST_F(DisplayTest, WindowFieldInversionShowsTheLowerRowsFirst) {
  b.osd_regs.write(VIDWINMD, 1u << 15 | 3u);
  show(1);
  EXPECT_EQ(b.tap.firsts[0].byte, pattern(1, 0));
  EXPECT_EQ(b.tap.firsts[1].byte, pattern(0, 0));
  b.venc_regs.write(VMOD, 0);
  run_for(kPsPerMs);
  b.tap.firsts.clear();
  b.osd_regs.write(MODE, 1u << 9);  // inverted twice
  show(1);
  EXPECT_EQ(b.tap.firsts[0].byte, pattern(0, 0));
  EXPECT_EQ(b.tap.firsts[1].byte, pattern(1, 0));
}

TEST_F(DisplayTest, WithoutFieldModeBothFieldsShowTheSameRows) {
  b.osd_regs.write(VIDWINMD, 1);
  show(1);
  EXPECT_EQ(b.frames[0].picture.row(2)[0], pattern(1, 0));
  EXPECT_EQ(b.frames[0].picture.row(3)[0], pattern(1, 0));
}

TEST_F(DisplayTest, FrameRateIsExact) {
  const unsigned n = kIs625 ? 25 : 30;
  show(n + 1);
  const Picoseconds expected = kIs625 ? kPsPerSecond : 1'001'000'000'000;
  const Picoseconds measured = b.frames[n].times.display_start - b.frames[0].times.display_start;
  EXPECT_LE(measured > expected ? measured - expected : expected - measured, 1u);
}

TEST_F(DisplayTest, RasterInterruptsAndStatusComeAtTheFieldStarts) {
  const Clock clock(kByteClock);
  const std::uint64_t origin = clock.edge_after(kernel_time());
  show(1);
  // Field 1 of the raster begins with the raster; field 2 where F changes.
  const unsigned lines = kIs625 ? 312 : 262;
  ASSERT_GE(b.edges.rises.size(), 2u);
  EXPECT_EQ(b.edges.rises[0], clock.edge(origin));
  EXPECT_EQ(b.edges.rises[1], clock.edge(origin + std::uint64_t{lines} * kStd.line_bytes));
  EXPECT_EQ(b.frames[0].times.display_start,
            clock.edge(origin + (kIs625 ? 22u : 16u) * kStd.line_bytes + kStd.active_offset()));
  b.edges.rises.clear();
  while (b.edges.rises.size() < 1) run_for(kPsPerUs);
  EXPECT_EQ(b.venc_regs.read(VSTAT) >> 4 & 1, b.latches.back().f ? 1u : 0u);
}

TEST_F(DisplayTest, NewAddressTakesEffectAtTheNextFieldStart) {
  for (unsigned i = 0; i < kRows * kPitch; ++i) b.memory.at(kOther)[i] = 0x55;
  b.venc_regs.write(VMOD, kOn);
  run_for(kField / 2);  // in the first field's picture
  set_address(kOther);
  while (b.frames.empty()) run_for(kPsPerMs);
  EXPECT_EQ(b.frames[0].picture.row(kRows - 2)[7], pattern(kRows - 2, 7));
  EXPECT_EQ(b.frames[0].picture.row(kRows - 1)[7], 0x55);
  ASSERT_GE(b.latches.size(), 2u);
  EXPECT_EQ(b.latches[0].address, kBuffer);
  EXPECT_EQ(b.latches[1].address, kOther);
}

/// Every register of the OSD, written in the middle of a field's picture: this field stays as it was, and the next one
/// has the new settings (assumed: Linux davinci_vpbe writes them at any time and counts on the next field).
TEST_F(DisplayTest, EachSettingOfTheWindowWaitsForTheNextField) {
  const std::set<std::string> taken{"MODE",   "VIDWINMD",  "VIDWIN0OFST", "VIDWINADH", "VIDWIN0ADL", "BASEPX",
                                    "BASEPY", "VIDWIN0XP", "VIDWIN0YP",   "VIDWIN0XL", "VIDWIN0YL"};
  const auto shown = [&](const Reg* written) {
    SetUp();
    b.venc_regs.write(VMOD, kOn);
    run_for(kField / 2);
    if (written) {
      // Bit 26 of an address must be 1; a larger window would be cut to the picture.
      const std::string& name = written->name();
      const std::uint32_t flip = name == "VIDWIN0OFST" ? 0x1FFu
                                 : name == "VIDWIN0XL" ? 0x40u
                                 : name == "VIDWIN0YL" ? 0x30u
                                                       : ~0u;
      b.osd_regs.write(written->offset(), b.osd_regs.read(written->offset()) ^ (written->writable() & flip));
    }
    while (b.frames.empty()) run_for(kPsPerMs);
    std::pair<std::vector<std::uint8_t>, std::vector<std::uint8_t>> rows;
    for (unsigned r = 0; r < kRows; ++r) {
      auto& to = r % 2 ? rows.second : rows.first;
      const std::uint8_t* from = b.frames[0].picture.row(r);
      to.insert(to.end(), from, from + kPitch);
    }
    if (written) b.osd_regs.write(written->offset(), written->reset_value());
    return rows;
  };
  const auto usual = shown(nullptr);
  unsigned checked = 0;
  for (const Reg* r : b.osd.bank().regs()) {
    const auto [now, next] = shown(r);
    EXPECT_TRUE(now == usual.first) << r->name() << " acts in the middle of a field";
    EXPECT_EQ(next != usual.second, taken.contains(r->name())) << r->name();
    ++checked;
  }
  EXPECT_GE(checked, 40u);
}

TEST_F(DisplayTest, WithFrameLatchTheWholeFrameKeepsItsAddress) {
  b.params.osd_latch.set("frame");
  b.venc_regs.write(VMOD, kOn);
  run_for(kField / 2);
  set_address(kOther);
  while (b.frames.size() < 2) run_for(kPsPerMs);
  b.params.osd_latch.set("field");
  EXPECT_EQ(wrong(b.frames[0].picture), 0u);
  ASSERT_GE(b.latches.size(), 3u);
  EXPECT_EQ(b.latches[1].address, kBuffer);
  EXPECT_EQ(b.latches[2].address, kOther);
}

TEST_F(DisplayTest, WindowOriginMovesThePictureByItsPixelsAndLines) {
  b.osd_regs.write(XP, 40);
  b.osd_regs.write(XL, 640);
  b.osd_regs.write(YP, 8);
  b.osd_regs.write(YL, 100);
  show(1);
  const Picture& p = b.frames[0].picture;
  EXPECT_EQ(p.row(16)[80], pattern(0, 0));
  EXPECT_EQ(p.row(17)[80], pattern(1, 0));
  EXPECT_EQ(p.row(16)[79], 0x10) << "black left of it";
  EXPECT_EQ(p.row(16)[80 + 1279], pattern(0, 1279));
  EXPECT_EQ(p.row(16)[80 + 1280], 0x80);
  EXPECT_EQ(p.row(15)[80], 0x80);
  EXPECT_EQ(p.row(16 + 199)[80], pattern(199, 0));
  EXPECT_EQ(p.row(16 + 200)[80], 0x80);
}

TEST_F(DisplayTest, BasepxOnePairFurtherMovesThePictureByOnePair) {
  b.osd_regs.write(BASEPX, (kIs625 ? 0x7E : 0x79) + 2);
  show(1);
  EXPECT_EQ(b.frames[0].picture.row(0)[0], 0x80);
  EXPECT_EQ(b.frames[0].picture.row(0)[4], pattern(0, 0));
}

TEST_F(DisplayTest, WindowThatBeginsLeftOfThePictureIsCutThere) {
  b.osd_regs.write(BASEPX, (kIs625 ? 0x7E : 0x79) - 6);
  show(1);
  const Picture& p = b.frames[0].picture;
  // Six pixels of each row lie left of the first active one; the row ends six pixels early.
  for (unsigned r : {0u, 1u, kRows - 1})
    for (unsigned i = 0; i < kPitch; ++i)
      ASSERT_EQ(p.row(r)[i], i < kPitch - 12 ? pattern(r, i + 12)
                             : i % 2         ? 0x10
                                             : 0x80)
          << "row " << r << " byte " << i;
}

TEST_F(DisplayTest, WrongPitchShears) {
  b.osd_regs.write(VIDWIN0OFST, 0x1000 | (kPitch / 32 - 1));
  show(1);
  for (unsigned r : {1u, 2u, 100u}) {
    const unsigned at = r * (kPitch - 32);
    EXPECT_EQ(b.frames[0].picture.row(r)[0], pattern(at / kPitch, at % kPitch)) << "row " << r;
  }
}

TEST_F(DisplayTest, ChromaSwapExchangesCbAndCr) {
  b.osd_regs.write(MODE, 1u << 15);
  show(1);
  EXPECT_EQ(b.frames[0].picture.row(0)[0], pattern(0, 2));
  EXPECT_EQ(b.frames[0].picture.row(0)[1], pattern(0, 1));
  EXPECT_EQ(b.frames[0].picture.row(0)[2], pattern(0, 0));
}

TEST_F(DisplayTest, WindowOffIsBlackAndReadsNothing) {
  b.osd_regs.write(VIDWINMD, 2);
  show(1);
  EXPECT_TRUE(b.memory.log.empty());
  EXPECT_EQ(b.frames[0].picture, Picture(720, kRows));
  EXPECT_FALSE(b.latches.at(0).window);
}

TEST_F(DisplayTest, BlankedEncoderIsBlack) {
  b.venc_regs.write(VMOD, kOn | 1u << 3);
  while (b.frames.empty()) run_for(kPsPerMs);
  EXPECT_EQ(b.frames[0].picture, Picture(720, kRows));
}

TEST_F(DisplayTest, EncoderWithoutItsClockShowsNothing) {
  for (const std::uint32_t off : {0x00u, 0x10u}) {  // bit 4 is the digital LCD's
    b.venc_regs.write(CLKCTL, off);
    b.venc_regs.write(VMOD, kOn);
    run_for(3 * kField);
    EXPECT_TRUE(b.edges.rises.empty());
    EXPECT_TRUE(b.frames.empty());
  }
  b.venc_regs.write(CLKCTL, 1);
  run_for(3 * kField);
  EXPECT_FALSE(b.frames.empty());
  b.venc_regs.write(CLKCTL, 0);
  run_for(kPsPerUs);
  const std::size_t rises = b.edges.rises.size(), frames = b.frames.size();
  run_for(3 * kField);
  EXPECT_EQ(b.edges.rises.size(), rises);
  EXPECT_EQ(b.frames.size(), frames);
}

TEST_F(DisplayTest, VpbeClockGatesTheRasterAndTheRegisters) {
  b.venc_regs.write(VMOD, kOn);
  b.vpbe_gate.write(false);
  run_for(3 * kField);
  EXPECT_TRUE(b.frames.empty());
  b.vpbe_gate.write(true);
  run_for(3 * kField);
  EXPECT_FALSE(b.frames.empty());
}

TEST_F(DisplayTest, ClockSelectorLeavesTheStandardRasterAloneByDefault) {
  b.clk_sel.write(true);
  run_for(kPsPerUs);
  show(2);
  EXPECT_EQ(wrong(b.frames[0].picture), 0u);
  const Picoseconds frame = kStd.frame_bytes() * (kPsPerSecond / 1'000'000) / 27;
  EXPECT_NEAR(static_cast<double>(b.frames[1].times.display_start - b.frames[0].times.display_start),
              static_cast<double>(frame), 1.0);
  b.clk_sel.write(false);
}

TEST_F(DisplayTest, OtherStandardIsTakenWhileTheEncoderRuns) {
  b.venc_regs.write(VMOD, kOn);
  run_for(kField / 2);
  const std::size_t first = b.tap.firsts.size();
  ASSERT_GE(first, 1u);
  b.venc_regs.write(VMOD, kOn ^ 0x40);
  const Clock clock(kByteClock);
  const std::uint64_t origin = clock.edge_after(kernel_time());
  const Standard& other = standard_of(!kIs625);
  while (b.tap.firsts.size() < first + 2) run_for(kPsPerMs);
  // A new raster begins at once, with the other standard's first field.
  EXPECT_EQ(b.tap.firsts[first].number, other.active_first[0]);
  EXPECT_FALSE(b.tap.firsts[first].f);
  EXPECT_EQ(
      b.tap.firsts[first].start,
      clock.edge(origin + (kIs625 ? 16u : 22u) * other.line_bytes + other.active_offset()));
  EXPECT_EQ(b.tap.firsts[first + 1].number, other.active_first[1]);
  b.venc_regs.write(VMOD, 0);
  run_for(kPsPerUs);
}

TEST_F(DisplayTest, SettingsWithoutEffectAreWarnedOfByName) {
  Diagnostics& d = b.diagnostics;
  d.clear();
  const auto names = [&d] {
    std::vector<std::string> out;
    for (const auto& [what, times] : d.counts())
      out.push_back(what.second.substr(0, what.second.find(' ', 5)));
    d.clear();
    return out;
  };
  using Names = std::vector<std::string>;
  // What Linux writes for these rasters.
  for (const auto& [offset, value] :
       std::initializer_list<std::pair<std::uint32_t, std::uint32_t>>{{CLKCTL, 1},
                                                                      {0x04, 0},
                                                                      {0x0C, 0x20},
                                                                      {0x12C, 1},
                                                                      {0x130, 2},
                                                                      {0xC4, 0},
                                                                      {0x08, 0},
                                                                      {0xE0, 0x100},
                                                                      {0xDC, 0}})
    b.venc_regs.write(offset, value);
  for (const std::uint32_t offset : {0x08u, 0x0Cu, 0x10u, 0xE0u, 0xE4u})
    b.osd_regs.write(offset, 0);
  b.osd_regs.write(0xE8, 0x10);
  EXPECT_EQ(names(), Names{});
  b.venc_regs.write(0x08, 0x100);
  EXPECT_EQ(names(), Names{"VENC VDPRO.CBMD"});
  b.venc_regs.write(0x08, 0x200);
  EXPECT_EQ(names(), Names{}) << "the kind of colour bars, without bars";
  b.venc_regs.write(0xC4, 0xF000);
  b.venc_regs.write(0x12C, 0);
  b.venc_regs.write(0x130, 1);
  EXPECT_EQ(names(), (Names{"VENC DACTST", "VENC OSDCLK0", "VENC OSDCLK1"}));
  b.osd_regs.write(0x08, 1);
  b.osd_regs.write(0x0C, 0x8001);
  b.osd_regs.write(0x10, 1);
  EXPECT_EQ(names(), (Names{"OSD OSDWIN0MD.ACT", "OSD OSDWIN1MD.ACT", "OSD RECTCUR.ACT"}));
  b.osd_regs.write(0xE8, 1u << 14 | 1u << 7);
  EXPECT_EQ(names(), (Names{"OSD MISCCTL.RGBEN", "OSD MISCCTL.S420D"}));
  b.venc_regs.write(VMOD, kOn & ~2u);
  run_for(kPsPerNs);
  EXPECT_EQ(names(), Names{"VENC VMOD.VIE"});
  for (const std::uint32_t offset : {0x08u, 0x0Cu, 0x10u, 0xE8u}) b.osd_regs.write(offset, 0);
  b.venc_regs.write(0x08, 0);
  b.venc_regs.write(0xC4, 0);
  d.clear();
}

TEST_F(DisplayTest, PositionsHaveTheirRegistersWidths) {
  b.osd_regs.write(BASEPX, ~0u);
  b.osd_regs.write(BASEPY, ~0u);
  EXPECT_EQ(b.osd_regs.read(BASEPX), 0x3FFu);
  EXPECT_EQ(b.osd_regs.read(BASEPY), 0x1FFu);
  for (std::uint32_t offset = XP; offset <= 0x94; offset += 4) {
    b.osd_regs.write(offset, ~0u);
    EXPECT_EQ(b.osd_regs.read(offset), 0x7FFu) << offset;
    b.osd_regs.write(offset, 0);
  }
  b.diagnostics.clear();
}

}  // namespace
}  // namespace fovea::video

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  fovea::video::Bench bench;
  fovea::video::bench = &bench;
  return RUN_ALL_TESTS();
}
