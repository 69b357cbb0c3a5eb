// The whole system from camera pixels to corrected pixels. CTest runs each case in its own process,
// since a process can elaborate only one simulation.
#include <gtest/gtest.h>

#include <algorithm>

#include "tb/e2e/expectations.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

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
  // The firmware uses nothing that the model lacks, and keeps the chip's rules.
  for (const auto& [what, times] : rig.diagnostics.counts()) ADD_FAILURE() << times << " times: " << what.second;
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

TEST(EndToEndTest, SerialFlowCorrectsEverySecondFrameExactly) {
  Rig rig;
  small(rig);
  rig.set("firmware.flow", "serial").set("run.frames", "8");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 8u);
  expect_lut_right(rig);
  // One input buffer: a camera frame is captured while the result of the one before it is shown.
  expect_frames_right(rig, 2);
  ASSERT_TRUE(rig.board().frame_stats().rate);
  EXPECT_NEAR(*rig.board().frame_stats().rate, 12.5, 0.01);
}

// Caches: an omitted operation shows as it would on the board.

/// The remap of what the camera sent while the frame on show was captured.
oracle::Frame correct_frame(Rig& rig, const Shown& s) {
  std::uint64_t n = 0;
  while (rig.board().decoder.field_time(2 * n + 2) <= *s.record.capture_start) ++n;
  return oracle::remap(rig.sent(n), rig.lut(), rig.geometry().pitch_bytes);
}

/// The firmware's status box on a corrected frame: 64x16 pixels at (32, 32), each luma value Y
/// becomes (Y + 0x50) / 2, rounded down. It is drawn in the first eight frames.
oracle::Frame with_box(oracle::Frame f) {
  for (unsigned y = 32; y < 32 + 16; ++y)
    for (unsigned x = 32; x < 32 + 64; ++x) {
      std::uint8_t& luma = f.uyvy[(std::size_t{y} * f.width + x) * 2 + 1];
      luma = static_cast<std::uint8_t>((luma + 0x50) / 2);
    }
  return f;
}

void expect_equal(const oracle::Frame& expected, const Shown& s) {
  const auto d = oracle::compare(expected, s.frame);
  EXPECT_FALSE(d) << "frame " << s.record.index << ": " << d->text();
}

/// A data cache that is larger than all that the program ever reads. Invalid lines are filled
/// first, so a line that is in it once stays there until an operation of the program removes it.
constexpr const char* kCacheThatHoldsEverything = "128KiB";

TEST(CoherencyTest, WithoutInvalidateAfterCaptureTheFirstPictureIsShownForEver) {
  Rig rig("omit_d_invalidate.elf");
  small(rig);
  rig.set("firmware.flow", "serial").set("run.frames", "8");
  rig.set("cpu.dcache.size", kCacheThatHoldsEverything);
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 8u) << rig.board().uart_text();
  // The first remap reads the first captured frame into the cache. All later ones find it there,
  // whatever the camera has written to memory since.
  const oracle::Frame first = correct_frame(rig, rig.shown().front());
  for (const Shown& s : rig.shown()) expect_equal(first, s);
  EXPECT_TRUE(oracle::compare(first, correct_frame(rig, rig.shown().back())))
      << "the camera's picture does not move: nothing can be stale";
}

TEST(CoherencyTest, WithoutInvalidateThePartsCacheGivesWordsOfEarlierFrames) {
  Rig rig("omit_d_invalidate.elf");
  small(rig);
  rig.set("firmware.flow", "serial").set("run.frames", "8");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 8u) << rig.board().uart_text();
  // Which lines are evicted between two remaps is up to the replacement; but each word is that of a
  // frame captured so far, and in each later picture some are of an earlier one.
  std::vector<oracle::Frame> captured;
  for (const Shown& s : rig.shown()) {
    if (!s.record.repeated) captured.push_back(correct_frame(rig, s));
    std::size_t stale = 0;
    for (std::size_t i = 0; i < s.frame.uyvy.size(); i += 4) {
      const auto is_of = [&](const oracle::Frame& f) {
        return std::equal(&f.uyvy[i], &f.uyvy[i] + 4, &s.frame.uyvy[i]);
      };
      stale += !is_of(captured.back());
      ASSERT_TRUE(std::any_of(captured.begin(), captured.end(), is_of))
          << "frame " << s.record.index << " word " << i / 4;
    }
    EXPECT_EQ(stale > 0, captured.size() > 1) << s.record.index;
  }
  EXPECT_EQ(captured.size(), 4u);
}

TEST(CoherencyTest, WithInvalidateTheSameRunIsExact) {
  Rig rig;
  small(rig);
  rig.set("firmware.flow", "serial").set("run.frames", "8");
  rig.set("cpu.dcache.size", kCacheThatHoldsEverything);
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 8u);
  for (const Shown& s : rig.shown()) expect_equal(correct_frame(rig, s), s);
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

void run_overlay(Rig& rig) {
  small(rig, 128, 64);
  rig.set("firmware.flow", "serial").set("firmware.overlay", "true").set("run.frames", "8");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 8u) << rig.board().uart_text();
}

TEST(CoherencyTest, OverlayIsShownWithClean) {
  Rig rig;
  run_overlay(rig);
  for (const Shown& s : rig.shown()) expect_equal(with_box(correct_frame(rig, s)), s);
}

/// The EDMA writes a result behind the cache, in which the box of an earlier frame in the same buffer is left, unless
/// the remap method itself invalidates the result's lines: the source's invalidation is that of the whole cache here,
/// and would hide that. Nothing else needs it, since the EDMA reads the source from memory.
class OverlayTest : public testing::TestWithParam<const char*> {};
TEST_P(OverlayTest, IsDrawnOnWhatTheEdmaWrote) {
  Rig rig("omit_d_invalidate.elf");
  rig.set("firmware.kernel", GetParam()).set("cpu.dcache.size", kCacheThatHoldsEverything);
  run_overlay(rig);
  for (const Shown& s : rig.shown()) expect_equal(with_box(correct_frame(rig, s)), s);
}
INSTANTIATE_TEST_SUITE_P(Edma, OverlayTest, testing::Values("gather", "runs"),
                         [](const auto& i) { return std::string(i.param); });

// Without a clean the box stays in the cache until the next remap begins, which cleans and
// invalidates all of it. In this flow each result is shown twice, and the next remap begins before the
// second time: the first showing lacks the box, the second one has it.
void expect_next_remap_before_second_showing(const Rig& rig) {
  const auto& shown = rig.shown();
  for (std::size_t i = 2; i < shown.size(); i += 2) {
    ASSERT_TRUE(!shown[i].record.repeated && shown[i - 1].record.repeated);
    EXPECT_LT(*shown[i].record.remap_start, shown[i - 1].record.display_start);
    EXPECT_GT(*shown[i].record.remap_start, shown[i - 2].record.display_end);
  }
}

TEST(CoherencyTest, WithoutCleanTheOverlayIsMissingUntilTheNextRemapCleansTheCache) {
  Rig rig("omit_d_clean.elf");
  rig.set("cpu.dcache.size", kCacheThatHoldsEverything);
  run_overlay(rig);
  expect_next_remap_before_second_showing(rig);
  for (const Shown& s : rig.shown()) {
    const oracle::Frame plain = correct_frame(rig, s);
    expect_equal(s.record.repeated ? with_box(plain) : plain, s);
  }
}

TEST(CoherencyTest, WithoutCleanThePartsCacheShowsOnlyEvictedLinesOfTheOverlay) {
  Rig rig("omit_d_clean.elf");
  run_overlay(rig);
  expect_next_remap_before_second_showing(rig);
  for (const Shown& s : rig.shown()) {
    const oracle::Frame plain = correct_frame(rig, s), boxed = with_box(plain);
    if (s.record.repeated) {
      expect_equal(boxed, s);
      continue;
    }
    std::size_t missing = 0, drawn = 0;
    for (std::size_t i = 0; i < plain.uyvy.size(); ++i) {
      const std::uint8_t got = s.frame.uyvy[i];
      ASSERT_TRUE(got == plain.uyvy[i] || got == boxed.uyvy[i])
          << "frame " << s.record.index << " byte " << i;
      if (plain.uyvy[i] != boxed.uyvy[i]) ++(got == plain.uyvy[i] ? missing : drawn);
    }
    EXPECT_GT(missing, drawn) << s.record.index;
  }
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
  EXPECT_EQ(board.sink.stats.underflows.count(), 0u);
  // Register BCR, as the firmware would write it.
  board.dm365.vpss.regs.write(0x08, 4, 0x2u | vpss_read_priority << 2);
  rig.advance(60 * kPsPerMs);
  return board.sink.stats.underflows.count();
}

TEST(EndToEndTest, VpssAtLowestPriorityUnderHeavyTrafficUnderflows) {
  EXPECT_GT(underflows_under_load(7, "4"), 100u);
}

TEST(EndToEndTest, SameLoadWithVpssAtHighestPriorityDoesNotUnderflow) {
  EXPECT_EQ(underflows_under_load(0, "4"), 0u);
}

/// Runs for 400 ms, of which the decoder's lock takes 200; bit 1 of PCCR, the ISIF's clock, is cleared
/// each time that the firmware sets it.
void run_400_ms(Rig& rig, bool gate_isif) {
  small(rig);
  auto& board = rig.build();
  for (int i = 0; i < 400; ++i) {
    rig.advance(kPsPerMs);
    const std::uint32_t pccr = board.dm365.vpss.regs.pccr.get();
    if (gate_isif && (pccr & 2u)) board.dm365.vpss.regs.write(0x04, 4, pccr & ~2u);
  }
}

TEST(EndToEndTest, GatedIsifGivesNoFrame) {
  Rig rig;
  run_400_ms(rig, true);
  EXPECT_EQ(rig.board().log.captures().size(), 0u);
  EXPECT_FALSE(rig.board().window_start());
}

TEST(EndToEndTest, ClockedIsifGivesFramesInTheSameTime) {
  Rig rig;
  run_400_ms(rig, false);
  EXPECT_GE(rig.board().log.captures().size(), 1u);
  EXPECT_TRUE(rig.board().window_start());
}

}  // namespace
}  // namespace fovea::e2e
