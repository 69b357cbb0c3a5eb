// The whole way: camera pixels in, corrected pixels out. CTest runs each case in its own process,
// since a simulation elaborates once.
#include <gtest/gtest.h>

#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

constexpr Picoseconds kLimit = 20 * kPsPerSecond;

/// A small centred region: the LUT is built in milliseconds and the caches hold all of it.
void small(Rig& rig, unsigned width = 64, unsigned height = 16) {
  rig.set("video.width", std::to_string(width)).set("video.height", std::to_string(height));
  rig.set("camera.stamp", "false").set("run.frames", "4");
}

/// Half (a): every entry of the table in target memory is the oracle's.
void expect_lut_right(Rig& rig) {
  const auto lut = rig.lut();
  const oracle::Geometry g = rig.geometry();
  ASSERT_EQ(lut.size(), std::size_t{g.width} / 2 * g.height);
  const oracle::LutCheck c = oracle::check_lut(lut, g, 0.02);
  EXPECT_EQ(c.wrong, 0u) << c.first_wrong->text();
  std::printf("LUT: %zu entries, %zu wrong, %zu within 0.02 px of a boundary and different\n",
              c.entries, c.wrong, c.near_boundary);
}

/// Half (b): every displayed frame is the host's remap of a frame that the camera sent, and the
/// frames follow each other.
void expect_frames_right(Rig& rig, std::uint64_t step = 1) {
  const auto lut = rig.lut();
  const std::uint32_t pitch = rig.geometry().pitch_bytes;
  ASSERT_FALSE(rig.shown().empty());
  std::uint64_t last = 0;
  for (const Shown& s : rig.shown()) {
    ASSERT_TRUE(s.record.captured && s.record.capture_start);
    EXPECT_EQ(s.underflows, 0u);
    // Which frame the camera sent is found from the pixels, near the time of the capture.
    const double period = rig.params.video.standard.is("pal") ? 0.04 : 1001.0 / 30000;
    const auto guess = static_cast<std::uint64_t>(
        static_cast<double>(*s.record.capture_start) * 1e-12 / period);
    std::optional<std::uint64_t> found;
    std::string difference;
    for (std::uint64_t n = guess > 1 ? guess - 2 : 0; n <= guess + 2 && !found; ++n) {
      const auto d = oracle::compare(oracle::remap(rig.sent(n), lut, pitch), s.frame);
      if (!d) found = n;
      if (n == guess && d) difference = d->text();
    }
    ASSERT_TRUE(found) << "frame " << s.record.index << " is no remap of a sent frame: "
                       << difference;
    if (s.record.index > 0) EXPECT_EQ(*found, last + step) << "order of frames";
    last = *found;
  }
}

TEST(EndToEndTest, SmallRegionIsCorrectedExactly) {
  Rig rig;
  small(rig, 160, 64);
  rig.run(kLimit);
  ASSERT_EQ(rig.board().dm365.arm.failure(), "");
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  expect_lut_right(rig);
  expect_frames_right(rig);
  EXPECT_NE(rig.board().uart_text().find("Fovea"), std::string::npos);
}

TEST(EndToEndTest, WholePalFrameIsCorrectedExactly) {
  Rig rig;
  rig.set("run.frames", "4").set("camera.stamp", "false");
  rig.run(kLimit);
  ASSERT_EQ(rig.board().dm365.arm.failure(), "");
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  expect_lut_right(rig);
  expect_frames_right(rig);
}

TEST(EndToEndTest, NtscPairMethodBIsCorrectedExactly) {
  Rig rig;
  small(rig, 240, 96);
  rig.set("video.standard", "ntsc").set("lens.mapping", "stereographic").set("lens.pair", "B");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  expect_lut_right(rig);
  expect_frames_right(rig);
}

class MappingTest : public testing::TestWithParam<const char*> {};
TEST_P(MappingTest, LutAndPictureAreExact) {
  Rig rig;
  small(rig, 128, 48);
  rig.set("run.frames", "2").set("lens.mapping", GetParam());
  if (std::string(GetParam()) == "rectilinear") rig.set("lens.fov", "100deg");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 2u) << rig.board().uart_text();
  expect_lut_right(rig);
  expect_frames_right(rig);
}
INSTANTIATE_TEST_SUITE_P(All, MappingTest,
                         testing::Values("none", "rectilinear", "linear", "orthographic",
                                         "equisolid", "stereographic"),
                         [](const auto& info) { return std::string(info.param); });

TEST(EndToEndTest, BothHalvesOfTheCheckCanFail) {
  Rig rig;
  small(rig);
  rig.run(kLimit);
  ASSERT_FALSE(rig.shown().empty());
  auto lut = rig.lut();
  lut[17] += 4;
  EXPECT_GE(oracle::check_lut(lut, rig.geometry(), 0.02).wrong, 1u);
  Shown s = rig.shown().front();
  const auto before = s.frame;
  s.frame.uyvy[1001] ^= 1;
  const auto d = oracle::compare(before, s.frame);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->count, 1u);
}

TEST(EndToEndTest, PaperLiteralFocalGivesAnotherTable) {
  Rig rig;
  small(rig, 128, 48);
  rig.set("run.frames", "1").set("lens.paper_literal_focal", "true");
  rig.run(kLimit);
  expect_lut_right(rig);
  oracle::Geometry right = rig.geometry();
  right.paper_literal_focal = false;
  EXPECT_GT(oracle::check_lut(rig.lut(), right, 0.02).wrong, 100u);
}

TEST(EndToEndTest, SerialFlowShowsCorrectFramesAtALowerRate) {
  Rig rig;
  small(rig);
  rig.set("firmware.flow", "serial");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 4u);
  expect_lut_right(rig);
  EXPECT_LT(rig.board().frame_stats().rate, 24.0);
}

// Caches: an omitted operation shows as it would on the board.

TEST(CoherencyTest, WithoutInvalidateAfterCaptureThePictureIsStale) {
  Rig rig("omit_d_invalidate.elf");
  small(rig);
  rig.set("firmware.flow", "serial").set("run.frames", "6");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 6u) << rig.board().uart_text();
  // The region's source and table fit the cache: words read once stay. A later frame repeats
  // words of an earlier one although the camera sent others.
  const auto lut = rig.lut();
  const std::uint32_t pitch = rig.geometry().pitch_bytes;
  unsigned stale = 0;
  for (const Shown& s : rig.shown()) {
    bool exact = false;
    for (std::uint64_t n = 0; n < 400 && !exact; ++n)
      exact = !oracle::compare(oracle::remap(rig.sent(n), lut, pitch), s.frame);
    stale += !exact;
  }
  EXPECT_GE(stale, 1u);
}

TEST(CoherencyTest, WithInvalidateTheSameRunIsExact) {
  Rig rig;
  small(rig);
  rig.set("firmware.flow", "serial").set("run.frames", "6");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 6u);
  const auto lut = rig.lut();
  for (const Shown& s : rig.shown()) {
    bool exact = false;
    for (std::uint64_t n = 0; n < 400 && !exact; ++n)
      exact = !oracle::compare(oracle::remap(rig.sent(n), lut, rig.geometry().pitch_bytes),
                               s.frame);
    EXPECT_TRUE(exact) << "frame " << s.record.index;
  }
}

TEST(CoherencyTest, PatchedCodeRunsOnlyAfterInstructionInvalidate) {
  Rig rig("fovea_firmware.elf");
  small(rig);
  rig.set("firmware.patch", "true").set("run.frames", "1");
  rig.run(kLimit);
  EXPECT_EQ(rig.state().patched_value, 0xC0u);
}

TEST(CoherencyTest, WithoutInstructionInvalidateTheOldInstructionRuns) {
  Rig rig("omit_i_invalidate.elf");
  small(rig);
  rig.set("firmware.patch", "true").set("run.frames", "1");
  rig.run(kLimit);
  EXPECT_EQ(rig.state().patched_value, 0x50u);
}

/// Words of the overlay box: luma halfway to a fixed level, so the frame is no plain remap.
unsigned frames_with_box(Rig& rig) {
  const auto lut = rig.lut();
  unsigned n = 0;
  for (const Shown& s : rig.shown()) {
    bool plain = false;
    for (std::uint64_t k = 0; k < 400 && !plain; ++k)
      plain = !oracle::compare(oracle::remap(rig.sent(k), lut, rig.geometry().pitch_bytes),
                               s.frame);
    n += !plain;
  }
  return n;
}

TEST(CoherencyTest, OverlayIsShownWithCleanAndMissingWithout) {
  Rig rig("omit_d_clean.elf");
  small(rig, 128, 64);
  rig.set("firmware.flow", "serial").set("firmware.overlay", "true").set("run.frames", "4");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  EXPECT_LT(frames_with_box(rig), 4u) << "the box reached memory without a clean";
}

TEST(CoherencyTest, OverlayIsShownWithClean) {
  Rig rig;
  small(rig, 128, 64);
  rig.set("firmware.flow", "serial").set("firmware.overlay", "true").set("run.frames", "4");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  EXPECT_EQ(frames_with_box(rig), 4u);
}

TEST(EndToEndTest, VpssAtLowestPriorityUnderHeavyTrafficUnderflows) {
  // The firmware leaves BCR at its reset value; the test turns the priority by hand after start.
  Rig rig;
  small(rig, 320, 64);
  rig.set("load.outstanding", "16").set("load.pattern", "random").set("load.kind", "read");
  rig.set("load.priority", "0").set("load.start", "20ms").set("vpss.read_outstanding", "1");
  auto& board = rig.build();
  rig.advance(10 * kPsPerMs);
  board.dm365.vpss.regs.bcr.rd_pri.set(7);
  std::uint32_t ignored = 0;
  board.dm365.vpss.regs.read(0x08, 4, ignored);
  board.dm365.vpss.regs.write(0x08, 4, ignored);
  rig.run(3 * kPsPerSecond);
  EXPECT_GT(board.sink.assembler.underflows(), 0u);
}

TEST(EndToEndTest, SameLoadWithVpssAtHighestPriorityDoesNotUnderflow) {
  Rig rig;
  small(rig, 320, 64);
  rig.set("load.outstanding", "16").set("load.pattern", "random").set("load.kind", "read");
  rig.set("load.priority", "7").set("load.start", "20ms");
  rig.run(3 * kPsPerSecond);
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  EXPECT_EQ(rig.board().sink.assembler.underflows(), 0u);
}

TEST(EndToEndTest, GatedIsifGivesNoFrame) {
  Rig rig;
  small(rig);
  auto& board = rig.build();
  // Bit 1 of PCCR gates the ISIF; the firmware's own write to PCCR is undone by the test.
  for (int i = 0; i < 300; ++i) {
    rig.advance(kPsPerMs);
    const std::uint32_t pccr = board.dm365.vpss.regs.pccr.get();
    if (pccr & 2u) board.dm365.vpss.regs.write(0x04, 4, pccr & ~2u);
  }
  EXPECT_EQ(board.log.captures().size(), 0u);
  EXPECT_FALSE(board.window_start());
}

}  // namespace
}  // namespace fovea::e2e

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
