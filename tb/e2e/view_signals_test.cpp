// Faults of one camera's signal in a composed view: found in time, said once, left out, recovered from, and no other
// camera is to blame. What is displayed is composed of sent frames throughout.
#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <systemc>

#include "tb/e2e/views_rig.h"

namespace fovea::e2e {
namespace {

constexpr Picoseconds kLimit = 20 * kPsPerSecond;
using Lines = std::vector<std::string>;

/// What the firmware has said of its cameras, and when first.
class Said {
 public:
  explicit Said(board::Board& board) : uart_(board.observe_uart([this](std::uint8_t byte) { take(byte); })) {}
  const Lines& lines() const { return lines_; }
  Picoseconds at(const std::string& line) const { return at_.at(line); }

 private:
  void take(std::uint8_t byte) {
    if (byte == '\r') return;
    if (byte != '\n') {
      line_ += static_cast<char>(byte);
      return;
    }
    if (line_.starts_with("camera ")) {
      lines_.push_back(line_);
      at_.emplace(line_, kernel_time());
    }
    line_.clear();
  }
  std::string line_;
  Lines lines_;
  std::map<std::string, Picoseconds> at_;
  Subscription uart_;
};

void four_way(ViewsRig& rig) {
  rig.set("cameras.count", "4").set("camera.kind", "chart").set("camera.stamp", "false");
  rig.set("tvp5146.relock_fields", "0").set("video.width", "160").set("video.height", "120");
  rig.set("firmware.view", "four_way").set("firmware.kernel", "fastest");
}

/// A fault of camera 1, and what is said of it.
struct ViewFault {
  const char* name;
  std::vector<std::pair<const char*, const char*>> keys;
  const char* said;
  unsigned detect_ms;       ///< from the fault's start until the line is out
  unsigned recover_ms = 0;  ///< from its end until "frames again" is out; 0: not in this run
  unsigned frames = 24;
};
void PrintTo(const ViewFault& f, std::ostream* out) { *out << f.name; }

constexpr unsigned kStart = 745, kEnd = 1085;  // ms; in the midst of frames, more than two rounds
/// Its turn comes every four frames. A frame that is damaged in its last field ends a frame later, and the line takes
/// its time.
constexpr unsigned kRound = 160, kTwoFrames = 90;
/// It is asked again every 25 frame boundaries, and a frame of it comes two rounds later at the latest.
constexpr unsigned kBack = 1000 + 2 * kRound + kTwoFrames;
const char* const kIrregular = "irregular syncs, frames are left out";

class ViewFaultTest : public testing::TestWithParam<ViewFault> {};
TEST_P(ViewFaultTest, IsFoundInTimeSaidOnceAndNoOtherCameraIsToBlame) {
  const ViewFault& fault = GetParam();
  ViewsRig rig;
  four_way(rig);
  rig.set("fault.camera", "1").set("run.frames", std::to_string(fault.frames));
  rig.set("fault.start", std::to_string(kStart) + "ms").set("fault.end", std::to_string(kEnd) + "ms");
  for (const auto& [key, value] : fault.keys) rig.set(key, value);
  Said said(rig.build());
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), fault.frames) << rig.board().uart_text();
  const std::string what = std::string("camera 1: ") + fault.said, again = "camera 1: frames again";
  ASSERT_EQ(said.lines(), (fault.recover_ms ? Lines{what, again} : Lines{what})) << rig.board().uart_text();
  EXPECT_GT(said.at(what), kStart * kPsPerMs);
  EXPECT_LE(said.at(what), (kStart + fault.detect_ms) * kPsPerMs);
  if (fault.recover_ms) {
    EXPECT_GT(said.at(again), kEnd * kPsPerMs);
    EXPECT_LE(said.at(again), (kEnd + fault.recover_ms) * kPsPerMs);
  }
  EXPECT_EQ(rig.wrong_picture(rig.table(), 80), "") << "no frame of the fault is shown";
  const auto stats = rig.board().camera_stats();
  for (unsigned n = 0; n < 4; ++n) {
    EXPECT_EQ(stats[n].captured, stats[n].displayed + stats[n].superseded + stats[n].dropped) << n;
    EXPECT_EQ(stats[n].superseded, 0u) << n;
    EXPECT_TRUE(n == 1 || stats[n].dropped == 0) << n;
  }
  // Of every other camera the last picture shows a frame of the last round.
  const auto& last = rig.shown().back();
  for (unsigned n = 0; n < 4; ++n) ASSERT_TRUE(last.number[n]) << n;
  std::uint64_t newest = 0;
  for (unsigned n = 0; n < 4; ++n) newest = std::max(newest, *last.number[n]);
  for (unsigned n = 0; n < 4; ++n) EXPECT_TRUE(n == 1 || newest - *last.number[n] <= 5) << n;
  EXPECT_TRUE(rig.board().resets().empty());
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, ViewFaultTest,
    testing::Values(
        ViewFault{"MissingLine",
                  {{"fault.kind", "missing_lines"}, {"fault.lines", "1"}},
                  kIrregular, kRound + kTwoFrames},
        ViewFault{"ShortLines", {{"fault.kind", "short_lines"}}, kIrregular, kRound + kTwoFrames},
        ViewFault{"TwoWrongBits",
                  {{"fault.kind", "sync_noise"}, {"fault.wrong_bits", "2"}, {"fault.every", "3"}},
                  kIrregular, 2 * kRound + kTwoFrames}),
    [](const auto& i) { return std::string(i.param.name); });
INSTANTIATE_TEST_SUITE_P(
    Nightly, ViewFaultTest,
    testing::Values(
        ViewFault{"WrongStandard", {{"fault.kind", "wrong_standard"}}, "wrong standard", kRound + 140 + 25},
        ViewFault{"ManyMissingLines",
                  {{"fault.kind", "missing_lines"}, {"fault.lines", "40"}},
                  "no frames", kRound + 140 + 25, kBack, 55},
        ViewFault{"TwoWrongBitsInAllCodes",
                  {{"fault.kind", "sync_noise"}, {"fault.wrong_bits", "2"}},
                  "no frames", kRound + 140 + 25, kBack, 55},
        ViewFault{"MissingLinesAndBack",
                  {{"fault.kind", "missing_lines"}},
                  kIrregular, kRound + kTwoFrames, 25 * kRound + kRound + kTwoFrames, 140}),
    [](const auto& i) { return std::string(i.param.name); });

/// A load for 120 ms, above the capture.
TEST(ViewSignalsTest, FramesThatLackPartsAreSaidAndLeftOut) {
  ViewsRig rig;
  four_way(rig);
  rig.set("firmware.check_capture", "true").set("run.frames", "24");
  rig.set("priority.arm", "0").set("priority.vpfe", "7").set("priority.vpbe", "0");
  rig.set("load.outstanding", "16").set("load.priority", "1").set("load.pattern", "random");
  rig.set("load.start", "745ms").set("load.end", "865ms");
  Said said(rig.build());
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 24u) << rig.board().uart_text();
  EXPECT_GT(rig.board().dm365.isif.stats.overflows.count(), 0u);
  EXPECT_EQ(rig.wrong_picture(rig.table(), 40), "") << "no frame with a hole is shown";
  ASSERT_FALSE(said.lines().empty());
  std::uint64_t dropped = 0;
  for (const std::string& line : said.lines()) {
    EXPECT_TRUE(line.ends_with(": overflow, frames are left out")) << line;
    EXPECT_GT(said.at(line), 745 * kPsPerMs);
    EXPECT_LE(said.at(line), (865 + kTwoFrames) * kPsPerMs);
  }
  EXPECT_LE(said.at(said.lines().front()), (745 + kTwoFrames) * kPsPerMs);
  for (const auto& stats : rig.board().camera_stats()) {
    EXPECT_EQ(stats.captured, stats.displayed + stats.superseded + stats.dropped);
    EXPECT_EQ(stats.superseded, 0u);
    dropped += stats.dropped;
  }
  EXPECT_GE(dropped, 2u);
  EXPECT_LE(dropped, 120u / 40 + 2);
}

}  // namespace
}  // namespace fovea::e2e
