// The whole way: camera pixels in, corrected pixels out. CTest runs each case in its own process,
// since a simulation elaborates once.
#include <gtest/gtest.h>

#include <algorithm>

#include "tb/e2e/expectations.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

constexpr Picoseconds kLimit = 20 * kPsPerSecond;

/// A small centred region: the LUT is built in milliseconds and the caches hold all of it.
void small(Rig& rig, unsigned width = 64, unsigned height = 16) {
  rig.set("video.width", std::to_string(width)).set("video.height", std::to_string(height));
  rig.set("camera.stamp", "false").set("run.frames", "4");
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

// Start-up: nothing is captured before the decoder's lock; the display is in step with the camera.

class LockTimeTest : public testing::TestWithParam<const char*> {};
TEST_P(LockTimeTest, CaptureStartsWithTheFirstWholeFramesAfterTheLock) {
  Rig rig;
  small(rig);
  rig.set("tvp5146.relock_fields", GetParam());
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  const auto& decoder = rig.board().decoder;
  const Picoseconds locked = decoder.field_time(decoder.locked_from_field());
  ASSERT_FALSE(rig.board().log.captures().empty());
  const Picoseconds first = rig.board().log.captures().front();
  // From the lock to the end of the first capture: at most a poll of 10 ms, a frame to find the
  // camera's fields, a frame to be in step, a frame captured.
  EXPECT_GT(first, locked + 20 * kPsPerMs);
  EXPECT_LT(first, locked + 130 * kPsPerMs);
  expect_frames_right(rig);
  EXPECT_EQ(rig.board().uart_text().find("no lock"), std::string::npos);
}
INSTANTIATE_TEST_SUITE_P(Fields, LockTimeTest, testing::Values("10", "23", "40"),
                         [](const auto& i) { return std::string("Of") + i.param; });

TEST(EndToEndTest, ADecoderThatDoesNotLockIsReportedAndShownAsItIs) {
  Rig rig;
  small(rig);
  rig.set("tvp5146.relock_fields", "100");
  rig.run(kLimit);
  EXPECT_NE(rig.board().uart_text().find("decoder: no lock, going on"), std::string::npos);
  ASSERT_EQ(rig.shown().size(), 4u);
  // Black, as the decoder sends it for another second.
  const auto& bytes = rig.shown().front().frame.uyvy;
  for (std::size_t i = 0; i < bytes.size(); ++i) ASSERT_EQ(bytes[i], i % 2 ? 0x10 : 0x80) << i;
}

class CameraPhaseTest : public testing::TestWithParam<const char*> {};
TEST_P(CameraPhaseTest, DisplayIsInStepWithTheCameraWhateverItsPhase) {
  Rig rig;
  small(rig);
  rig.set("tvp5146.phase", GetParam());
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  for (const Shown& s : rig.shown()) {
    EXPECT_FALSE(s.record.repeated);
    ASSERT_TRUE(s.record.capture_end);
    // Next display frame but one millisecond earlier; 22 lines to the first active one; the
    // camera's frame ends for the firmware two lines after the last line.
    const double ms = static_cast<double>(s.record.display_start - *s.record.capture_end) * 1e-9;
    EXPECT_NEAR(ms, 40 - 1 + (22 + 2) * 0.064, 0.15);
  }
}
INSTANTIATE_TEST_SUITE_P(Phases, CameraPhaseTest, testing::Values("0ms", "9ms", "21ms", "33ms"),
                         [](const auto& i) { return std::string("At") + i.param; });

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
                                         "equisolid", "stereographic", "kannala_brandt"),
                         [](const auto& i) { return std::string(i.param); });

TEST(EndToEndTest, LdmKernelIsExact) {
  Rig rig;
  small(rig, 160, 64);
  rig.set("firmware.kernel", "ldm");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  expect_frames_right(rig);
}

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

TEST(EndToEndTest, SerialFlowRunsAtALowerRate) {
  Rig rig;
  small(rig);
  rig.set("firmware.flow", "serial");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 4u);
  expect_lut_right(rig);
  ASSERT_TRUE(rig.board().frame_stats().rate);
  EXPECT_LT(*rig.board().frame_stats().rate, 24.0);
}

// Caches: an omitted operation shows as it would on the board.

/// Bytes in which a frame differs from the nearest remap of what the camera sent around its capture.
std::size_t bytes_off(Rig& rig, const Shown& s) {
  const auto lut = rig.lut();
  const auto guess =
      static_cast<std::uint64_t>(static_cast<double>(*s.record.capture_start) * 1e-12 / 0.04);
  std::size_t best = ~std::size_t{0};
  for (std::uint64_t n = guess > 2 ? guess - 3 : 0; n <= guess + 2; ++n) {
    const auto d = oracle::compare(
        oracle::remap(rig.sent(n), lut, rig.geometry().pitch_bytes), s.frame);
    best = std::min(best, d ? d->count : 0);
  }
  return best;
}

TEST(CoherencyTest, WithoutInvalidateAfterCaptureThePictureIsStale) {
  Rig rig("omit_d_invalidate.elf");
  small(rig);
  rig.set("firmware.flow", "serial").set("run.frames", "8");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 8u) << rig.board().uart_text();
  // Source and table of this region fit the cache and nothing else evicts them: the words that the
  // first remap read are read again from the cache, whatever the camera has sent since.
  unsigned stale = 0;
  for (const Shown& s : rig.shown()) stale += bytes_off(rig, s) > 0;
  EXPECT_GE(stale, 6u);
  const auto same = oracle::compare(rig.shown()[2].frame, rig.shown()[6].frame);
  EXPECT_LT(same ? same->count : 0, rig.shown()[2].frame.uyvy.size() / 2)
      << "the picture should hardly move";
}

TEST(CoherencyTest, WithInvalidateTheSameRunIsExact) {
  Rig rig;
  small(rig);
  rig.set("firmware.flow", "serial").set("run.frames", "8");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 8u);
  for (const Shown& s : rig.shown()) EXPECT_EQ(bytes_off(rig, s), 0u) << s.record.index;
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

// The overlay halves the luma distance of a 64x16 box to a fixed level: 1,024 bytes of luma, of which
// only those that were at that level already stay as they are.

TEST(CoherencyTest, OverlayIsShownWithClean) {
  Rig rig;
  small(rig, 128, 64);
  rig.set("firmware.flow", "serial").set("firmware.overlay", "true");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  for (const Shown& s : rig.shown()) {
    EXPECT_GT(bytes_off(rig, s), 950u);
    EXPECT_LE(bytes_off(rig, s), 1024u);
  }
}

TEST(CoherencyTest, WithoutCleanTheOverlayIsMissingOnTheDisplay) {
  Rig rig("omit_d_clean.elf");
  small(rig, 128, 64);
  rig.set("firmware.flow", "serial").set("firmware.overlay", "true").set("run.frames", "8");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 8u) << rig.board().uart_text();
  // Lines of the box that later reads evict do reach memory; most of the box does not, until the
  // next remap: before the same result is shown again.
  unsigned fresh = 0;
  for (const Shown& s : rig.shown()) {
    if (s.record.repeated) continue;
    ++fresh;
    EXPECT_LT(bytes_off(rig, s), 700u) << s.record.index;
  }
  EXPECT_GE(fresh, 4u);
}

/// A display that runs, then a load of random reads with or above the display's priority.
std::uint64_t underflows_under_load(unsigned vpss_read_priority, const std::string& load_priority) {
  Rig rig;
  small(rig, 320, 64);
  rig.set("run.frames", "1000").set("load.start", "400ms");
  rig.set("load.outstanding", "16").set("load.pattern", "random").set("load.kind", "read");
  rig.set("load.priority", load_priority);
  auto& board = rig.build();
  rig.advance(390 * kPsPerMs);
  EXPECT_TRUE(board.window_start()) << "the display does not run yet";
  EXPECT_EQ(board.sink.assembler.underflows(), 0u);
  // Register BCR, as the firmware would write it.
  board.dm365.vpss.regs.write(0x08, 4, 0x2u | vpss_read_priority << 2);
  rig.advance(60 * kPsPerMs);
  return board.sink.assembler.underflows();
}

TEST(EndToEndTest, VpssAtLowestPriorityUnderHeavyTrafficUnderflows) {
  EXPECT_GT(underflows_under_load(7, "4"), 100u);
}

TEST(EndToEndTest, SameLoadWithVpssAtHighestPriorityDoesNotUnderflow) {
  EXPECT_EQ(underflows_under_load(0, "4"), 0u);
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
