// Time division between cameras: whose frames are displayed, and how often, is read from the pixels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <systemc>

#include "tb/e2e/cameras_rig.h"

namespace fovea::e2e {
namespace {

constexpr Picoseconds kLimit = 20 * kPsPerSecond;
using Shown = CamerasRig::Shown;

/// What the ideal time division captures after `first`, from the cameras' phases alone: at the end of
/// a camera's frame the next camera is selected (a little later, in the vertical blanking); the decoder
/// locks after `relock` of its fields, the one in progress counted; then its next whole frame is captured.
std::vector<Shown::Stamp> ideal(Shown::Stamp first, std::size_t count, double relock,
                                const std::vector<double>& phase_ms) {
  std::vector<Shown::Stamp> out{first};
  while (out.size() < count) {
    const Shown::Stamp last = out.back();
    const double end = phase_ms[last.camera] + 40.0 * (last.number + 1);
    const unsigned next = (last.camera + 1) % static_cast<unsigned>(phase_ms.size());
    const double in_progress = std::floor((end + 0.7 - phase_ms[next]) / 20);
    // The capture counts from the first active line of the field before a frame (VDINT1). Without a re-lock that is
    // the field in progress if it is still in its vertical blanking (22 lines), or else a later one.
    const double since = end + 0.7 - phase_ms[next] - 20 * in_progress;
    const double locked = in_progress + (since < 22 * 0.064 ? relock : std::max(relock, 2.0));
    out.push_back({next, static_cast<unsigned>(std::ceil(locked / 2))});
  }
  return out;
}

void expect_sequence(const std::vector<Shown::Stamp>& expected, const std::vector<Shown::Stamp>& got) {
  ASSERT_EQ(expected.size(), got.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i].camera, expected[i].camera) << i;
    EXPECT_EQ(got[i].number, expected[i].number) << i << ", camera " << expected[i].camera;
  }
}

/// The statistics of each camera are what the displayed pixels say.
void expect_counts(CamerasRig& rig, unsigned step) {
  std::map<unsigned, std::vector<unsigned>> numbers;
  for (const Shown::Stamp& s : sequence(rig)) numbers[s.camera].push_back(s.number);
  const auto stats = rig.board().camera_stats();
  ASSERT_EQ(stats.size(), numbers.size());
  for (const auto& [camera, list] : numbers) {
    const board::CameraFrameStats& s = stats[camera];
    EXPECT_EQ(s.displayed, list.size());
    EXPECT_EQ(s.captured, s.displayed + s.superseded + s.dropped) << "camera " << camera;
    // One of `step` frames of the camera was captured; all of them are on show.
    EXPECT_EQ(s.captured, (list.back() - list.front()) / step + 1) << "camera " << camera;
  }
}

struct Division {
  unsigned cameras, relock;
  const char* multiplexer = "decoder";
  std::string name() const {
    return "Of" + std::to_string(cameras) + "Relock" + std::to_string(relock) +
           (std::string(multiplexer) == "gpio" ? "ByGpio" : "");
  }
};
class GenlockedTest : public testing::TestWithParam<Division> {};
TEST_P(GenlockedTest, EachCameraGivesEveryFrameThatTheDivisionAllows) {
  const auto [n, relock, multiplexer] = GetParam();
  CamerasRig rig;
  small(rig, n);
  rig.set("tvp5146.relock_fields", std::to_string(relock)).set("cameras.multiplexer", multiplexer);
  const unsigned step = n * (2 + relock) / 2;  // frames of the camera from one captured to the next
  rig.set("run.frames", std::to_string(2 * step + n + 1));
  rig.run(kLimit);
  ASSERT_EQ(rig.board().dm365.arm.failure(), "");
  ASSERT_EQ(rig.shown().size(), rig.params.run.frames()) << rig.board().uart_text();
  EXPECT_EQ(rig.wrong_picture(), "");
  const auto got = sequence(rig);
  ASSERT_GE(got.size(), 2u * n) << rig.board().uart_text();
  expect_sequence(ideal(got.front(), got.size(), relock, std::vector<double>(n, 0)), got);
  expect_counts(rig, step);
  for (unsigned c = 0; c < n; ++c) {
    EXPECT_EQ(rig.table_check(c).wrong, 0u) << "table of camera " << c;
    const auto stats = rig.board().camera_stats()[c];
    EXPECT_EQ(stats.superseded + stats.dropped, 0u);
    // 25/(N (1 + relock/2)), to within one frame of the window.
    const double window = static_cast<double>(rig.params.run.frames()) / 25;
    ASSERT_TRUE(stats.rate);
    EXPECT_NEAR(*stats.rate, 25.0 / (n * (1 + relock / 2.0)), 1.001 / window) << "camera " << c;
  }
  EXPECT_TRUE(rig.said().empty()) << rig.said().front();
}
INSTANTIATE_TEST_SUITE_P(Divisions, GenlockedTest,
                         testing::Values(Division{2, 0}, Division{2, 2}, Division{2, 10}, Division{4, 0},
                                         Division{2, 0, "gpio"}, Division{2, 2, "gpio"}, Division{4, 0, "gpio"}),
                         [](const auto& i) { return i.param.name(); });

INSTANTIATE_TEST_SUITE_P(Nightly, GenlockedTest,
                         testing::Values(Division{4, 2}, Division{4, 10}, Division{8, 0}, Division{8, 0, "gpio"}),
                         [](const auto& i) { return i.param.name(); });

/// Fields of the re-lock, and the second camera's phase. Half a frame behind, the lines of its second field
/// go on where those of the first camera's first one would begin.
struct Apart {
  unsigned relock, phase_ms;
  const char* multiplexer = "decoder";
};
class FreeRunningTest : public testing::TestWithParam<Apart> {};
TEST_P(FreeRunningTest, TheNextWholeFrameAfterTheLockIsShown) {
  const auto [relock, phase, multiplexer] = GetParam();
  CamerasRig rig;
  small(rig, 2);
  rig.set("cameras.multiplexer", multiplexer);
  rig.set("cameras.genlocked", "false").set("camera.1.phase", std::to_string(phase) + "ms");
  rig.set("tvp5146.relock_fields", std::to_string(relock));
  rig.set("run.frames", std::to_string(relock < 10 ? 16 : 30));
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), rig.params.run.frames()) << rig.board().uart_text();
  EXPECT_EQ(rig.wrong_picture(), "");
  const auto got = sequence(rig);
  ASSERT_GE(got.size(), 4u) << rig.board().uart_text();
  expect_sequence(ideal(got.front(), got.size(), relock, {0, 1.0 * phase}), got);
  // No frame is shown again for another reason than the syncs.
  const board::FrameStats f = rig.board().frame_stats();
  EXPECT_EQ(f.repeated, rig.shown().size() - got.size());
  EXPECT_EQ(f.repeated_relock, f.repeated);
  EXPECT_TRUE(rig.said().empty()) << rig.said().front();
}
INSTANTIATE_TEST_SUITE_P(Relock, FreeRunningTest, testing::Values(Apart{0, 20}, Apart{2, 27}, Apart{3, 27}),
                         [](const auto& i) { return "Of" + std::to_string(i.param.relock); });
INSTANTIATE_TEST_SUITE_P(InThePicture, FreeRunningTest, testing::Values(Apart{0, 27}),
                         [](const auto& i) { return "Of" + std::to_string(i.param.relock); });
INSTANTIATE_TEST_SUITE_P(ByGpio, FreeRunningTest, testing::Values(Apart{2, 27, "gpio"}),
                         [](const auto& i) { return "Of" + std::to_string(i.param.relock); });
INSTANTIATE_TEST_SUITE_P(Nightly, FreeRunningTest, testing::Values(Apart{10, 27}),
                         [](const auto& i) { return "Of" + std::to_string(i.param.relock); });

/// Four genlocked cameras behind the multiplexer, each frame of the raster captured: frames 3, 7, 11 and so on are in
/// the turn of camera 0. Line 1 of the select lines is stuck low, so those of 2 and 3 lead 0 and 1 through.
constexpr unsigned kStuckLine = 1;
void stick(CamerasRig& rig, unsigned start_ms, unsigned end_ms) {
  small(rig, 4);
  rig.set("tvp5146.relock_fields", "0").set("cameras.multiplexer", "gpio").set("run.frames", "24");
  rig.set("fault.kind", "stuck_select").set("fault.select_line", std::to_string(kStuckLine));
  rig.set("fault.start", std::to_string(start_ms) + "ms").set("fault.end", std::to_string(end_ms) + "ms");
}

/// By the marks: number of the frame, the camera whose turn it is, and the cameras that the rows of its fields show.
/// The table is that of the turn.
struct Turn {
  unsigned number, turn, even, odd;
};
std::optional<Turn> turn_of(const CamerasRig& rig, const Shown& s) {
  for (unsigned turn = 0; turn < 4; ++turn) {
    const ShownFields f = rig.read_stamp(s.frame, turn);
    if (f.even && f.odd && *f.odd == *f.even + 1 && (*f.even / 2u + 1) % 4 == turn)
      return Turn{*f.even / 2u, turn, *f.even_camera, *f.odd_camera};
  }
  return std::nullopt;
}

// The pixels tell what the firmware cannot know: another camera's frames come in the turns of 2 and 3. They are in step
// and locked to, so it says nothing, and corrects them by the table of the camera that it has selected.
TEST(MultiplexerTest, WithAStuckSelectLineTheWrongCamerasAreShownUntilItIsOver) {
  CamerasRig rig;
  constexpr unsigned kStart = 300, kEnd = 780;  // in frames 7 and 19, in the turn of camera 0: nothing changes then
  stick(rig, kStart, kEnd);
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 24u) << rig.board().uart_text();
  unsigned wrong = 0, right = 0, before = 0, behind = 0, last = 0;
  for (const Shown& s : rig.shown()) {
    const auto seen = turn_of(rig, s);
    ASSERT_TRUE(seen) << "frame " << s.record.index;
    const bool stuck = seen->number * 40 >= kStart && seen->number * 40 < kEnd;
    const unsigned camera = stuck ? seen->turn & ~(1u << kStuckLine) : seen->turn;
    EXPECT_EQ(seen->even, camera) << "frame " << seen->number;
    EXPECT_EQ(seen->odd, camera) << "frame " << seen->number;
    EXPECT_EQ(s.record.camera, camera) << "frame " << seen->number;
    if (&s != &rig.shown().front()) {
      EXPECT_EQ(seen->number, last + 1) << "each frame of the raster is shown";
    }
    last = seen->number;
    ++(camera != seen->turn ? wrong : stuck ? right : seen->number * 40 < kStart ? before : behind);
  }
  EXPECT_EQ(wrong, 6u) << "the turns of 2 and 3 in twelve frames";
  EXPECT_EQ(right, 6u) << "those of 0 and 1";
  EXPECT_GT(before, 0u);
  EXPECT_GT(behind, 0u);
  EXPECT_EQ(rig.said(), std::vector<std::string>{});
}

// When the line breaks while camera 2 is captured, the second field of that frame is of camera 0. If the decoder loses
// no lock, the firmware does not see it: the frame of two cameras is shown. Otherwise the frame is left out.
class StickingTest : public testing::TestWithParam<unsigned> {};
TEST_P(StickingTest, InTheMidstOfAFrameIsSeenByTheLockAlone) {
  CamerasRig rig;
  const unsigned relock = GetParam();
  stick(rig, relock ? 340 : 380, 3000);  // frame 8 or 9 of camera 2, from 320 or 360 ms on: between its fields' lines
  rig.set("tvp5146.relock_fields", std::to_string(relock)).set("run.frames", "12");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 12u) << rig.board().uart_text();
  bool mixed = false;
  for (const Shown& s : rig.shown()) {
    if (relock) {
      for (unsigned turn = 0; turn < 4; ++turn) {
        const ShownFields f = rig.read_stamp(s.frame, turn);
        mixed |= f.even && f.odd && f.even_camera != f.odd_camera;
      }
      continue;
    }
    const auto seen = turn_of(rig, s);
    ASSERT_TRUE(seen) << "frame " << s.record.index;
    EXPECT_EQ(seen->even != seen->odd, seen->number == 9) << "frame " << seen->number;
    if (seen->number != 9) continue;
    mixed = true;
    EXPECT_EQ(seen->even, 2u);
    EXPECT_EQ(seen->odd, 0u);
  }
  EXPECT_EQ(mixed, relock == 0);
  // The frames that come again are those of camera 0.
  std::vector<std::string> said;
  if (relock > 0) said = {"camera 2: lock lost, a frame is left out", "camera 2: frames again"};
  EXPECT_EQ(rig.said(), said);
}
INSTANTIATE_TEST_SUITE_P(Relock, StickingTest, testing::Values(0u, 2u),
                         [](const auto& i) { return "Of" + std::to_string(i.param); });

/// From the end of a frame of camera `a` to the start of the first frame of camera `b` that is captured, in ms: the
/// decoder counts the field in progress, and then waits for a first field. Without a re-lock, the frame whose field
/// before is already in its picture cannot be caught: its begin is counted from that field's first active line.
double change_ms(double phase_a, double phase_b, unsigned relock) {
  const double first = std::fmod(phase_b - phase_a + 40, 40);  // to b's next first field
  const double locked = std::fmod(first, 20) + 20.0 * relock - (relock && std::fmod(first, 20) > 0 ? 20 : 0);
  double wait = first;
  while (wait < locked) wait += 40;
  if (relock < 2 && first < 20 - 22 * 0.064) wait += 40;
  return wait;
}

/// What each camera gives in ten seconds is what phases and re-lock allow, to within one frame.
struct Rate {
  unsigned cameras, relock;
  bool genlocked;
};
class RateTest : public testing::TestWithParam<Rate> {};
TEST_P(RateTest, NightlyTenSecondsOfEachDivision) {
  const auto [n, relock, genlocked] = GetParam();
  static constexpr unsigned kPhases[] = {0, 27, 13, 6};
  CamerasRig rig;
  small(rig, n);
  rig.set("tvp5146.relock_fields", std::to_string(relock)).set("run.frames", "250");
  if (!genlocked) rig.set("cameras.genlocked", "false");
  double round = 0;  // ms, in which each camera gives one frame
  for (unsigned c = 0; c < n; ++c) {
    if (genlocked) {
      round += 40 + 20.0 * relock;
      continue;
    }
    if (c) rig.set("camera." + std::to_string(c) + ".phase", std::to_string(kPhases[c]) + "ms");
    round += 40 + change_ms(kPhases[c], kPhases[(c + 1) % n], relock);
  }
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 250u) << rig.board().uart_text();
  EXPECT_EQ(rig.wrong_picture(), "");
  std::vector<unsigned> given(n);
  for (const Shown::Stamp& s : sequence(rig)) ++given.at(s.camera);
  for (unsigned c = 0; c < n; ++c) EXPECT_NEAR(given[c], 10'000 / round, 1.0) << "camera " << c;
  EXPECT_TRUE(rig.said().empty()) << rig.said().front();
}
INSTANTIATE_TEST_SUITE_P(Divisions, RateTest,
                         testing::Values(Rate{2, 0, true}, Rate{2, 2, true}, Rate{2, 10, true}, Rate{4, 0, true},
                                         Rate{4, 2, true}, Rate{4, 10, true}, Rate{2, 0, false}, Rate{2, 2, false},
                                         Rate{2, 10, false}, Rate{4, 0, false}, Rate{4, 2, false}, Rate{4, 10, false}),
                         [](const auto& i) {
                           return "Of" + std::to_string(i.param.cameras) + "Relock" + std::to_string(i.param.relock) +
                                  (i.param.genlocked ? "" : "Free");
                         });

// In full size and in a shorter time, with the kernel that is fast enough for it: 12 frames of the display's 24.
TEST(CamerasTest, NightlyTheRateOfWholePicturesIsWhatTheRelockAllows) {
  CamerasRig rig;
  rig.set("camera.kind", "chart").set("cameras.count", "2").set("camera.1.lens.mapping", "linear");
  rig.set("tvp5146.relock_fields", "2").set("firmware.kernel", "fastest").set("run.frames", "24");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 24u) << rig.board().uart_text();
  EXPECT_EQ(rig.shown().front().frame.width, 720u);
  EXPECT_EQ(rig.shown().front().frame.height, 576u);
  EXPECT_EQ(rig.wrong_picture(), "");
  const auto got = sequence(rig);
  expect_sequence(ideal(got.front(), got.size(), 2, {0, 0}), got);
  std::vector<unsigned> given(2);
  for (const Shown::Stamp& s : got) ++given.at(s.camera);
  for (unsigned c = 0; c < 2; ++c) EXPECT_EQ(given[c], 24 * 40 / 160) << "camera " << c;
  EXPECT_TRUE(rig.said().empty()) << rig.said().front();
}

// Their phases drift apart by 4.8 ms. Each displayed picture is one whole frame of one camera.
TEST(CamerasTest, NightlyTwoFreeRunningCamerasForAMinute) {
  CamerasRig rig;
  small(rig, 2);
  rig.set("cameras.genlocked", "false").set("tvp5146.relock_fields", "2").set("run.frames", "1500");
  rig.set("camera.0.clock_offset", "-30ppm").set("camera.1.clock_offset", "50ppm").set("camera.1.phase", "38ms");
  rig.set("firmware.kernel", "fastest");
  rig.run(80 * kPsPerSecond);
  ASSERT_EQ(rig.shown().size(), 1500u) << rig.board().uart_text();
  EXPECT_EQ(rig.wrong_picture(), "");
  EXPECT_TRUE(rig.said().empty()) << rig.said().front();
  const auto shown = sequence(rig);
  EXPECT_GT(shown.size(), 400u);
  std::map<unsigned, unsigned> last;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (i != 0) {
      EXPECT_NE(shown[i].camera, shown[i - 1].camera) << i;
    }
    const auto [at, first] = last.try_emplace(shown[i].camera, shown[i].number);
    if (!first) {
      EXPECT_GT(shown[i].number, at->second) << i;
      EXPECT_LE(shown[i].number, at->second + 5) << i << ": a round takes up to five frames";
      at->second = shown[i].number;
    }
  }
}

/// Nine look-up tables (eight cameras, and one that is built anew) leave not much more than 128 KiB for the form of
/// each. The addresses of 400 x 300 pixels are 234 KiB, their runs some 200 KiB.
class NoRoomTest : public testing::TestWithParam<const char*> {};
TEST_P(NoRoomTest, TheCoreTakesOverWhereTheListsOfTheEdmaDoNotFit) {
  const std::string kernel = GetParam();
  CamerasRig rig;
  small(rig, 8);
  rig.set("video.width", "400").set("video.height", "300").set("tvp5146.relock_fields", "0");
  rig.set("firmware.kernel", kernel).set("firmware.lut", "fixed_point").set("run.frames", "9");
  rig.run(kLimit);
  ASSERT_EQ(rig.board().dm365.arm.failure(), "");
  ASSERT_EQ(rig.shown().size(), 9u) << rig.board().uart_text();
  EXPECT_EQ(rig.wrong_picture(), "");
  std::set<unsigned> cameras;
  for (const Shown::Stamp& s : sequence(rig)) cameras.insert(s.camera);
  EXPECT_EQ(cameras.size(), 8u);
  const std::string text = rig.board().uart_text(), expected = "kernel " + kernel + ": no memory\r\nkernel: codes, ";
  std::size_t lines = 0;
  for (std::size_t at = text.find("kernel"); at != std::string::npos; at = text.find("kernel", at + expected.size())) {
    EXPECT_EQ(text.substr(at, expected.size()), expected);
    ++lines;
  }
  EXPECT_EQ(lines, 8u) << text;
}
INSTANTIATE_TEST_SUITE_P(Kernels, NoRoomTest, testing::Values("gather", "runs"),
                         [](const auto& i) { return std::string(i.param); });

/// Other pictures than those of PAL and NTSC, byte for byte, each frame of the camera in turn.
struct Input {
  const char* standard;
  unsigned width, height;
  double period_ms;
};
class InputTest : public testing::TestWithParam<Input> {};
TEST_P(InputTest, EveryFrameIsShownByteForByte) {
  const Input& in = GetParam();
  CamerasRig rig;
  rig.set("camera.kind", "chart").set("video.standard", in.standard).set("tvp5146.relock_fields", "2");
  rig.set("firmware.kernel", "fastest").set("run.frames", "3");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 3u) << rig.board().uart_text();
  EXPECT_EQ(rig.wrong_picture(), "");
  EXPECT_EQ(rig.table_check(0).wrong, 0u);
  const auto shown = sequence(rig);
  ASSERT_EQ(shown.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(rig.shown()[i].frame.width, in.width);
    EXPECT_EQ(rig.shown()[i].frame.height, in.height);
    if (i == 0) continue;
    EXPECT_EQ(shown[i].number, shown[i - 1].number + 1);
    const auto period = rig.shown()[i].record.display_start - rig.shown()[i - 1].record.display_start;
    EXPECT_NEAR(static_cast<double>(period) / kPsPerMs, in.period_ms, 1e-6);
  }
}
INSTANTIATE_TEST_SUITE_P(Standards, InputTest,
                         testing::Values(Input{"ntsc_486", 720, 486, 1001 / 30.0}, Input{"mt9v125", 720, 480, 40}),
                         [](const auto& i) { return std::string(i.param.standard); });

class UnpluggedTest : public testing::TestWithParam<unsigned> {};
TEST_P(UnpluggedTest, TheOtherCameraGoesOnAndTheLostOneComesBack) {
  const unsigned relock = GetParam();
  CamerasRig rig;
  small(rig, 2);
  rig.set("tvp5146.relock_fields", std::to_string(relock)).set("run.frames", "50");
  rig.set("fault.kind", "unplugged").set("fault.camera", "1");
  rig.set("fault.start", "615ms").set("fault.end", "705ms");
  const auto said = listen(rig, kLimit);
  ASSERT_EQ(rig.shown().size(), 50u) << rig.board().uart_text();
  EXPECT_EQ(rig.wrong_picture(), "") << "the last good picture stays";
  // Said in time: a turn of each camera, a frame to look at it, and the time of the line on the UART.
  ASSERT_TRUE(said.contains("camera 1: no signal")) << rig.board().uart_text();
  EXPECT_LE(said.at("camera 1: no signal"), (615 + 80 * (1 + relock / 2) + 80 + 10) * kPsPerMs);
  // Asked again after 25 frame boundaries; then a lock, and a frame.
  ASSERT_TRUE(said.contains("camera 1: frames again")) << rig.board().uart_text();
  EXPECT_LE(said.at("camera 1: frames again"),
            said.at("camera 1: no signal") + (40 * (25 + 3 + relock / 2) + 10) * kPsPerMs);
  bool before = false, behind = false;
  for (const Shown::Stamp& s : sequence(rig)) {
    if (s.camera != 1) continue;
    const unsigned from = s.number * 40, to = from + 40;  // of its capture, ms
    EXPECT_TRUE(to <= 615 || from >= 705) << "a frame of the unplugged camera: " << s.number;
    before |= to <= 615;
    behind |= from >= 705;
  }
  EXPECT_TRUE(before && behind);
  std::map<unsigned, unsigned> shown, first;
  for (const Shown::Stamp& s : sequence(rig)) {
    ++shown[s.camera];
    first.try_emplace(s.camera, s.number);
  }
  // What the decoder sends without a signal is no camera's frame. So one is dropped if the cable is pulled while it is
  // captured: frame 15, from 600 ms on and with its rows from 608 ms on, if that is in the turn of camera 1.
  const bool in_turn = (15 - first.at(1)) % (2 + relock) == 0;
  for (unsigned n = 0; n < 2; ++n) {
    const board::CameraFrameStats s = rig.board().camera_stats()[n];
    const unsigned dropped = n == 1 && in_turn ? 1 : 0;
    EXPECT_EQ(s.displayed, shown[n]) << n;
    EXPECT_EQ(s.dropped, dropped) << n;
    EXPECT_EQ(s.superseded, 0u) << n;
    EXPECT_EQ(s.captured, shown[n] + dropped) << n;
  }
}
INSTANTIATE_TEST_SUITE_P(Relock, UnpluggedTest, testing::Values(0u, 2u),
                         [](const auto& i) { return "Of" + std::to_string(i.param); });

TEST(CamerasTest, ACameraOfAnotherStandardIsLeftOut) {
  CamerasRig rig;
  small(rig, 2);
  rig.set("tvp5146.relock_fields", "0").set("camera.1.standard", "525/60").set("run.frames", "12");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 12u) << rig.board().uart_text();
  EXPECT_EQ(rig.said(), std::vector<std::string>{"camera 1: wrong standard"});
  for (const Shown::Stamp& s : sequence(rig)) EXPECT_EQ(s.camera, 0u);
  EXPECT_EQ(rig.wrong_picture(), "");
}

TEST(CamerasTest, AnInputWithNothingOnItIsLeftOut) {
  CamerasRig rig;
  small(rig, 2);
  rig.set("tvp5146.relock_fields", "2").set("camera.0.connected", "false").set("run.frames", "12");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 12u) << rig.board().uart_text();
  EXPECT_EQ(rig.said(), std::vector<std::string>{"camera 0: no signal"});
  for (const Shown::Stamp& s : sequence(rig)) EXPECT_EQ(s.camera, 1u);
}

// 32 pixels, in addition to what the page says of each camera.
TEST(CamerasTest, TheSwitchesShiftTheViewOfEachCamera) {
  CamerasRig rig;
  small(rig, 3);
  rig.set("switches.shift_x", "right").set("switches.shift_y", "up").set("run.frames", "6");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 6u) << rig.board().uart_text();
  for (unsigned c = 0; c < 3; ++c) {
    oracle::Geometry shifted = rig.geometry(c);  // as the page says
    shifted.shift_x += 32;
    shifted.shift_y -= 32;
    rig.add_view(c, shifted);
    rig.keep_table(c, 1);
    EXPECT_EQ(rig.table_check(c, 1).wrong, 0u) << c;
    EXPECT_GT(rig.table_check(c, 0).wrong, 0u) << c;
  }
}

// A corrected frame that never comes on the display: with forty remaps of each frame the loop is too slow.
TEST(CamerasTest, EachCapturedFrameIsDisplayedSupersededOrDropped) {
  CamerasRig rig;
  small(rig, 2);
  rig.set("tvp5146.relock_fields", "0").set("firmware.repeat", "40").set("run.frames", "9");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 9u) << rig.board().uart_text();
  EXPECT_EQ(rig.wrong_picture(), "");
  EXPECT_GT(rig.board().frame_stats().repeated, 0u);
  EXPECT_EQ(rig.board().frame_stats().repeated_relock, 0u) << "the syncs of both are the same";
  const auto shown = sequence(rig);
  std::uint64_t captured = 0, displayed = 0, lost = 0, pending = 0;
  for (const auto& s : rig.board().camera_stats()) {
    EXPECT_EQ(s.captured, s.displayed + s.superseded + s.dropped);
    captured += s.captured;
    displayed += s.displayed;
    lost += s.superseded + s.dropped;
    pending += s.pending;
  }
  // Each camera frame was captured, of one camera or the other.
  EXPECT_EQ(displayed, shown.size());
  const video::FrameTimes& last = rig.shown().back().record;
  ASSERT_TRUE(last.capture_end);
  const std::uint64_t since = (last.display_end - *last.capture_end) / (40 * kPsPerMs);
  EXPECT_EQ(captured + pending, shown.back().number - shown.front().number + 1u + since);
  EXPECT_LE(pending, 3u) << "two frame periods, and the frame that is being corrected";
  EXPECT_GT(lost, 0u);
}

class ShippedFreeTest : public testing::TestWithParam<const char*> {};
TEST_P(ShippedFreeTest, IsExact) {
  CamerasRig rig;
  rig.load(GetParam() + std::string("-free.yaml")).set("run.frames", "250");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 250u) << rig.board().uart_text();
  EXPECT_EQ(rig.wrong_picture(), "");
  EXPECT_TRUE(rig.said().empty()) << rig.said().front();
}
INSTANTIATE_TEST_SUITE_P(Nightly, ShippedFreeTest, testing::Values("two-cameras", "four-cameras", "eight-luts"),
                         [](const auto& i) {
                           std::string name = i.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace fovea::e2e

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
