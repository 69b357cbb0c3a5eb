// Remap methods in which the EDMA alone moves the pixels: each displayed picture is exact, whatever the lens and the
// size; what the controllers report as an error appears on the UART.
#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <systemc>
#include <vector>

#include "model/common/check.h"
#include "model/contract/memory_map.h"
#include "tb/e2e/expectations.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

bool uart_has(Rig& rig, const std::string& text) {
  return rig.board().uart_text().find(text) != std::string::npos;
}

/// @param refreshes_late the SDRAM is too busy for refreshes in time
void expect_good_run(Rig& rig, const std::string& kernel, unsigned frames, bool refreshes_late = false) {
  ASSERT_EQ(rig.board().dm365.arm.failure(), "");
  ASSERT_EQ(rig.shown().size(), frames) << rig.board().uart_text();
  EXPECT_TRUE(uart_has(rig, "kernel: " + kernel + ", ")) << rig.board().uart_text();
  EXPECT_FALSE(uart_has(rig, "EDMA: ")) << rig.board().uart_text();
  for (const auto& [what, times] : rig.diagnostics.counts())
    if (!refreshes_late || what.second.find("postponed REF") == std::string::npos)
      ADD_FAILURE() << times << " times: " << what.second;
}

struct Picture {
  const char* name;
  std::vector<std::pair<const char*, const char*>> keys;
};

/// Widths: 80 pairs are two pieces of 40, 94 are three of 32 that overlap by one, 2 are one piece.
/// A shift moves the view beyond the picture; what is there is black.
const Picture kPictures[] = {
    {"Whole_pieces", {{"video.width", "160"}, {"video.height", "64"}}},
    {"Overlapping_pieces", {{"video.width", "188"}, {"video.height", "12"}}},
    {"Smallest", {{"video.width", "4"}, {"video.height", "4"}}},
    {"Black_rims",
     {{"video.width", "128"}, {"video.height", "48"}, {"lens.shift_x", "41.5px"}, {"lens.shift_y", "-11px"}}},
    {"Ntsc_method_B",
     {{"video.standard", "ntsc"}, {"video.width", "240"}, {"video.height", "20"},
      {"lens.mapping", "stereographic"}, {"lens.pair", "B"}}},
};

class EdmaTest : public testing::TestWithParam<std::tuple<const char*, Picture>> {};
TEST_P(EdmaTest, EveryPictureIsExact) {
  const auto& [kernel, picture] = GetParam();
  Rig rig;
  rig.set("firmware.kernel", kernel).set("camera.stamp", "false").set("run.frames", "4");
  for (const auto& [key, value] : picture.keys) rig.set(key, value);
  rig.run(kLimit);
  expect_good_run(rig, kernel, 4);
  expect_lut_right(rig);
  expect_frames_right(rig);
  // Several buffers are used, each with lists of its own.
  EXPECT_EQ(rig.state().torn, 0u);
  EXPECT_GE(rig.state().remapped, 3u);
}
INSTANTIATE_TEST_SUITE_P(All, EdmaTest,
                         testing::Combine(testing::Values("gather", "runs"), testing::ValuesIn(kPictures)),
                         [](const auto& i) {
                           return std::string(std::get<0>(i.param)) + std::get<1>(i.param).name;
                         });

/// The method, and whether another master reads the source.
class TornTest : public testing::TestWithParam<const char*> {};
// A word of the source's first row changes during the remap, as if the camera had come too soon.
TEST_P(TornTest, AFrameThatChangesDuringItsRemapIsCounted) {
  Rig rig;
  rig.set("firmware.kernel", GetParam()).set("camera.stamp", "false").set("run.frames", "4");
  rig.set("video.width", "160").set("video.height", "64");
  board::Board& board = rig.build();
  unsigned remaps = 0;
  bool under_way = false;
  const Subscription phases = board.observe_phases([&](board::Phase phase, Picoseconds) {
    under_way = phase == board::Phase::kRemapStart;
    remaps += under_way;
  });
  while (!(under_way && remaps == 2)) rig.advance(10 * kPsPerUs);
  EXPECT_EQ(rig.state().torn, 0u);
  rig.advance(60 * kPsPerUs);  // the first sum of 80 words has been taken
  ASSERT_TRUE(under_way) << "the remap takes longer than that";
  const auto stride = rig.elf().find("frame_stride"), in = rig.elf().find("frame_in");
  std::uint32_t bytes = 0;
  std::memcpy(&bytes, board.peek(stride->address, 4).data(), 4);
  for (unsigned n = 0; n < 3; ++n)
    board.dm365.ddr.store().at(in->address - DDR_BASE + n * bytes + rig.lut()[7])[1] ^= 0xFF;
  rig.run(kLimit);
  EXPECT_EQ(rig.state().torn, 1u) << rig.board().uart_text();
}
INSTANTIATE_TEST_SUITE_P(Kernels, TornTest, testing::Values("plain", "gather", "staged"),
                         [](const auto& i) { return std::string(i.param); });

TEST(EdmaTest, TheBlackRimsOfTheTestAreBlack) {
  Rig rig;
  rig.set("firmware.kernel", "runs").set("camera.stamp", "false").set("run.frames", "1");
  for (const auto& [key, value] : kPictures[3].keys) rig.set(key, value);
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 1u);
  const auto lut = rig.lut();
  const std::uint32_t black = rig.geometry().pitch_bytes * 48;
  const auto count = std::count(lut.begin(), lut.end(), black);
  EXPECT_GT(count, 100);
  EXPECT_LT(count, static_cast<std::ptrdiff_t>(lut.size()));
}

/// Each displayed frame is one that was sent, unchanged, and they follow each other.
void expect_sent_frames(Rig& rig) {
  std::optional<std::uint64_t> last;
  for (const Shown& s : rig.shown()) {
    const auto guess = static_cast<std::uint64_t>(static_cast<double>(*s.record.capture_start) * 1e-12 * 25);
    std::optional<std::uint64_t> found;
    for (std::uint64_t n = guess > 1 ? guess - 2 : 0; n <= guess + 2; ++n)
      if (!oracle::compare(rig.sent(n), s.frame)) found = n;
    ASSERT_TRUE(found) << "frame " << s.record.index;
    if (last) {
      EXPECT_EQ(*found, *last + 1);
    }
    last = found;
  }
}

TEST(EdmaTest, ACopyShowsWhatTheCameraSent) {
  Rig rig;
  rig.set("firmware.kernel", "copy").set("camera.stamp", "false").set("run.frames", "4");
  rig.set("video.width", "188").set("video.height", "20");
  rig.run(kLimit);
  expect_good_run(rig, "copy", 4);
  expect_lut_right(rig);
  expect_sent_frames(rig);
}

TEST(EdmaTest, ACopyOfTheShippedFootageInFullSizeIsWhatTheCameraSent) {
  Rig rig;
  rig.load("default.yaml").set("firmware.kernel", "copy").set("run.frames", "2");
  rig.run(kLimit);
  // Four controllers keep the SDRAM so busy that it postpones refreshes for longer than JESD79-2 allows.
  expect_good_run(rig, "copy", 2, true);
  EXPECT_EQ(rig.shown()[0].frame.uyvy.size(), 720u * 576 * 2);
  expect_sent_frames(rig);
}

/// As a bus error, or a missed event, would have left them.
TEST(EdmaTest, ErrorsAreReportedOnceAndTheNextFramesAreRight) {
  Rig rig;
  rig.set("firmware.kernel", "gather").set("camera.stamp", "false").set("run.frames", "6");
  rig.set("video.width", "64").set("video.height", "16");
  rig.build();
  const auto frames_until = [&](std::size_t n) {
    for (unsigned ms = 0; ms < 2000 && rig.shown().size() < n; ++ms) rig.advance(kPsPerMs);
    ASSERT_EQ(rig.shown().size(), n) << rig.board().uart_text();
  };
  frames_until(2);
  EXPECT_FALSE(uart_has(rig, "EDMA: "));
  rig.board().dm365.edma.regs.emr.set(1u << 20);
  rig.board().dm365.edma_tcs[2]->regs.errstat.set(1);
  frames_until(6);
  const std::string text = rig.board().uart_text();
  const auto at = text.find("EDMA: errors 0x00000041\r\n");
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_EQ(text.find("EDMA: ", at + 1), std::string::npos) << text;
  EXPECT_EQ(rig.board().dm365.edma.regs.emr.get(), 0u);
  EXPECT_EQ(rig.board().dm365.edma_tcs[2]->regs.errstat.get(), 0u);
  expect_frames_right(rig);
}

/// Four tables at full size: each has its form. For `runs` look-up tables have to be given up, the first ones first;
/// a picture that `plain` corrects needs them all.
TEST(EdmaTest, FourTablesAtFullSizeHaveRoomForTheirForms) {
  Rig rig;
  rig.set("firmware.tables", "4").set("firmware.repeat", "4").set("firmware.lut", "fixed_point");
  rig.set("firmware.kernel", "runs").set("camera.stamp", "false");
  rig.build();
  for (unsigned ms = 0; ms < 2000 && !uart_has(rig, "running"); ms += 10) rig.advance(10 * kPsPerMs);
  const std::string text = rig.board().uart_text();
  std::size_t forms = 0;
  for (std::size_t at = text.find("kernel"); at != std::string::npos; at = text.find("kernel", at + 1))
    forms += text.compare(at, 14, "kernel: runs, ") == 0 ? 1 : 100;
  EXPECT_EQ(forms, 4u) << text;
  const FwState state = rig.state();
  EXPECT_NE(state.table_address[0], 0u);
  EXPECT_EQ(state.table_address[1], 0u);
  EXPECT_EQ(state.table_address[2], 0u);
  EXPECT_NE(state.table_address[3], 0u);
}

class EdmaWholeFrameTest : public testing::TestWithParam<const char*> {};
TEST_P(EdmaWholeFrameTest, NightlyWholePalFrameIsCorrectedExactly) {
  Rig rig;
  rig.load("default.yaml").set("firmware.kernel", GetParam());
  rig.set("run.frames", "4").set("camera.stamp", "false");
  rig.run(kLimit);
  expect_good_run(rig, GetParam(), 4);
  expect_lut_right(rig);
  expect_frames_right(rig);
  EXPECT_EQ(rig.state().dropped, 0u);
}
/// The pictures of four tables in turn. Look-up tables are read before some of them are given up.
TEST_P(EdmaWholeFrameTest, NightlyFourTablesInTurnAreCorrectedExactly) {
  Rig rig;
  rig.load("throughput.yaml").set("firmware.kernel", GetParam());
  rig.set("run.frames", "5").set("camera.stamp", "false").set("firmware.repeat", "1");
  rig.build();
  while (kernel_time() < kPsPerSecond && !uart_has(rig, "kernel: ")) rig.advance(kPsPerMs);
  std::vector<std::vector<std::uint32_t>> luts;
  for (unsigned k = 0; k < 4; ++k) luts.push_back(rig.lut(k));
  while (kernel_time() < kLimit && rig.shown().size() < 5) rig.advance(10 * kPsPerMs);
  expect_good_run(rig, GetParam(), 5);
  std::set<unsigned> views;
  for (const Shown& s : rig.shown()) {
    const unsigned view = view_of(rig, s);
    views.insert(view);
    const auto guess = static_cast<std::uint64_t>(static_cast<double>(*s.record.capture_start) * 1e-12 * 25);
    bool found = false;
    for (std::uint64_t n = guess > 1 ? guess - 2 : 0; n <= guess + 2 && !found; ++n)
      found = !oracle::compare(oracle::remap(rig.sent(n), luts[view], rig.geometry().pitch_bytes), s.frame);
    EXPECT_TRUE(found) << "frame " << s.record.index << " is not the picture of table " << view;
  }
  EXPECT_EQ(views, (std::set<unsigned>{0, 1, 2, 3}));
  EXPECT_EQ(rig.state().torn, 0u);
}
INSTANTIATE_TEST_SUITE_P(All, EdmaWholeFrameTest, testing::Values("gather", "runs"),
                         [](const auto& i) { return std::string(i.param); });

}  // namespace
}  // namespace fovea::e2e
