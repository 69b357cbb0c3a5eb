// The watchdog of the programs for several cameras: a program that hangs is reset, says why it starts again and shows
// pictures again; one that gets on is not reset, whatever its cameras do. watchdog.sh tries periods at their limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <systemc>

#include "tb/e2e/cameras_rig.h"
#include "tb/e2e/program_hang.h"
#include "tb/e2e/views_rig.h"

namespace fovea::e2e {
namespace {

constexpr Picoseconds kLimit = 20 * kPsPerSecond;
constexpr Picoseconds kPeriod = 300 * kPsPerMs, kHang = 610 * kPsPerMs;
constexpr Picoseconds kField = 20 * kPsPerMs, kFrame = 40 * kPsPerMs;
/// A line of 60 characters at 115200 Bd, and the end of what is being sent before.
constexpr Picoseconds kLine = 6 * kPsPerMs;

app::ElfImage image(const char* name) {
  return app::ElfImage::load(std::filesystem::path(FOVEA_FIRMWARE_DIR) / name);
}

/// What the program says of watchdog and stalls, and when; and when it has served the watchdog.
class Listener : private RegisterObserver {
 public:
  explicit Listener(board::Board& board)
      : uart_(board.observe_uart([this](std::uint8_t byte) { take(byte); })),
        timer_(board.dm365.timers[2]->observe(*this)) {}
  struct Line {
    std::string text;
    Picoseconds at;
  };
  const std::vector<Line>& said() const { return said_; }
  std::vector<std::string> texts() const {
    std::vector<std::string> out;
    for (const Line& l : said_) out.push_back(l.text);
    return out;
  }
  /// The last time before `at`.
  Picoseconds served(Picoseconds at) const { return *std::prev(std::lower_bound(served_.begin(), served_.end(), at)); }

 private:
  void take(std::uint8_t byte) {
    if (byte == '\r') return;
    if (byte != '\n') {
      line_ += static_cast<char>(byte);
      return;
    }
    if (line_.find("watchdog") != std::string::npos) said_.push_back({line_, kernel_time()});
    line_.clear();
  }
  void accessed(const RegisterAccess& a) override {
    if (a.write && a.offset == 0x28 && a.value >> 16 == 0xDA7E) served_.push_back(kernel_time());
  }
  std::string line_;
  std::vector<Line> said_;
  std::vector<Picoseconds> served_;
  Subscription uart_, timer_;
};

const std::string kStall = "watchdog: no progress, the program is at 0x80ffff00";
const std::string kReset = "reset by the watchdog: the program had stalled";

/// Keeps from the rig, and counts, what the display shows around the reset: the frame that it cuts, and black ones from
/// the display's start until the first picture.
template <class AnyRig>
void leave_out_the_dark(AnyRig& rig, unsigned& dark) {
  rig.keep = [&board = rig.board(), &dark](const video::FrameTimes& r) {
    const bool is_cut = !board.resets().empty() && r.display_start <= board.resets().front().at &&
                        board.resets().front().at < r.display_end;
    const bool kept = !is_cut && r.captured.has_value();
    if (!kept) ++dark;
    return kept;
  };
}

/// Lets the program hang at kHang, in `function`.
template <class AnyRig>
Picoseconds hang(AnyRig& rig, ProgramHang& program, const char* function, bool masked) {
  while (kernel_time() < kHang) rig.advance(kPsPerMs);
  program.arm(function, masked);
  while (!program.since() && kernel_time() < kHang + kPsPerSecond) rig.advance(kPsPerMs);
  EXPECT_GT(program.since(), 0u);
  return program.since();
}

/// The reset comes a period after the watchdog was last served, and a stall is said at half of that.
void expect_reset_in_time(board::Board& board, const Listener& heard, Picoseconds since, bool masked) {
  ASSERT_EQ(board.resets().size(), 1u) << board.uart_text();
  const board::ChipReset& reset = board.resets().front();
  EXPECT_EQ(reset.cause, "the watchdog expired");
  EXPECT_EQ(reset.pc, ProgramHang::kLoop);
  const Picoseconds served = heard.served(reset.at);
  EXPECT_LE(served, since);
  EXPECT_LT(since - served, 2 * kFrame) << "a frame each before";
  EXPECT_NEAR(static_cast<double>(reset.at - served), static_cast<double>(kPeriod), 1e6);
  using Texts = std::vector<std::string>;
  ASSERT_EQ(heard.texts(), masked ? Texts{kReset} : (Texts{kStall, kReset})) << board.uart_text();
  EXPECT_GT(heard.said().back().at, reset.at);
  EXPECT_LT(heard.said().back().at, reset.at + 50 * kPsPerMs) << "before the tables are built";
  if (masked) return;
  EXPECT_GT(heard.said().front().at, served + kPeriod / 2);
  EXPECT_LE(heard.said().front().at, served + kPeriod / 2 + kField + kLine);
}

struct Hang {
  const char *name, *function;
  bool masked;
};
void PrintTo(const Hang& h, std::ostream* out) { *out << h.name; }
class HangTest : public testing::TestWithParam<Hang> {};
TEST_P(HangTest, IsSaidEndsInAResetAndPicturesComeAgain) {
  CamerasRig rig;
  small(rig, 2);
  rig.set("tvp5146.relock_fields", "0").set("firmware.watchdog", "300ms");
  rig.set("run.resets", "1").set("run.frames", "40");
  const app::ElfImage elf = image("fovea_cameras.elf");
  ProgramHang program(rig.build(), elf);
  Listener heard(rig.board());
  unsigned dark = 0;
  leave_out_the_dark(rig, dark);
  const Picoseconds since = hang(rig, program, GetParam().function, GetParam().masked);
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size() + dark, 40u) << rig.board().uart_text();
  EXPECT_LE(dark, 6u);
  expect_reset_in_time(rig.board(), heard, since, GetParam().masked);
  const Picoseconds reset = rig.board().resets().front().at;
  EXPECT_EQ(rig.wrong_picture(), "") << "the last good picture stays, and no other one is shown";
  // What was on show when the program hung stays until the reset; then both cameras' frames come again.
  Picoseconds first = 0, again = 0;
  std::vector<CamerasRig::Shown::Stamp> after;
  std::optional<unsigned> last;
  for (const auto& s : rig.shown()) {
    ASSERT_TRUE(s.stamp) << s.record.index;
    const Picoseconds at = s.record.display_start;
    if (!first) first = at;
    if (at > since + 2 * kFrame && at < reset) {
      EXPECT_EQ(s.stamp->number, last.value_or(s.stamp->number)) << s.record.index;
      last = s.stamp->number;
    }
    if (at < reset) continue;
    if (!again) again = at;
    if (after.empty() || after.back().number != s.stamp->number) after.push_back(*s.stamp);
  }
  ASSERT_TRUE(last);
  ASSERT_GE(after.size(), 10u);
  EXPECT_LE(again - reset, first + kFrame) << "a start takes what the first one took, and the wait for a frame";
  for (std::size_t i = 1; i < after.size(); ++i) {
    EXPECT_EQ(after[i].number, after[i - 1].number + 1) << i;
    EXPECT_NE(after[i].camera, after[i - 1].camera) << i;
  }
}
INSTANTIATE_TEST_SUITE_P(Places, HangTest,
                         testing::Values(Hang{"InARemap", "remap_plain", false},
                                         Hang{"BetweenFrames", "camera_events_say", false}),
                         [](const auto& i) { return std::string(i.param.name); });
INSTANTIATE_TEST_SUITE_P(Nightly, HangTest,
                         testing::Values(Hang{"InARemapWithInterruptsMasked", "remap_plain", true}),
                         [](const auto& i) { return std::string(i.param.name); });

TEST(WatchdogViewsTest, AComposedViewThatHangsIsResetAndShownAgain) {
  ViewsRig rig;
  rig.set("cameras.count", "4").set("camera.kind", "chart").set("camera.stamp", "false");
  rig.set("tvp5146.relock_fields", "0").set("video.width", "160").set("video.height", "120");
  rig.set("firmware.view", "four_way").set("firmware.kernel", "fastest").set("firmware.watchdog", "300ms");
  rig.set("run.resets", "1").set("run.frames", "24");
  const app::ElfImage elf = image("fovea_views.elf");
  ProgramHang program(rig.build(), elf);
  Listener heard(rig.board());
  unsigned dark = 0;
  leave_out_the_dark(rig, dark);
  const Picoseconds since = hang(rig, program, "remap_ldm", false);
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size() + dark, 24u) << rig.board().uart_text();
  EXPECT_LE(dark, 6u);
  expect_reset_in_time(rig.board(), heard, since, false);
  EXPECT_EQ(rig.wrong_picture(rig.table()), "");
  const Picoseconds reset = rig.board().resets().front().at, first = rig.shown().front().start;
  const auto again = std::ranges::find_if(rig.shown(), [&](const auto& s) { return s.start > reset; });
  ASSERT_NE(again, rig.shown().end());
  EXPECT_LE(again->start - reset, first + kFrame);
  for (unsigned n = 0; n < 4; ++n) EXPECT_TRUE(rig.shown().back().number[n]) << n << " has not come again";
}

// It sleeps, is woken by each interrupt and looks for a frame, but finds none, though the camera gives frames.
TEST(WatchdogTest, ALoopThatTurnsWithoutFramesIsResetToo) {
  CamerasRig rig;
  small(rig, 1);
  rig.set("firmware.program", "cameras").set("firmware.watchdog", "300ms").set("run.frames", "200");
  const app::ElfImage elf = image("fovea_cameras.elf");
  ProgramHang program(rig.build(), elf);
  Listener heard(rig.board());
  while (kernel_time() < kHang) rig.advance(kPsPerMs);
  program.skip("pipeline_take");
  while (!rig.board().chip_reset() && kernel_time() < kHang + kPsPerSecond) rig.advance(kPsPerMs);
  ASSERT_TRUE(rig.board().chip_reset()) << rig.board().uart_text();
  const Picoseconds reset = rig.board().chip_reset()->at;
  EXPECT_GT(reset, kHang + kPeriod - 2 * kFrame);
  EXPECT_LE(reset, kHang + kPeriod);
  ASSERT_EQ(heard.said().size(), 1u) << rig.board().uart_text();
  EXPECT_TRUE(heard.said().front().text.starts_with("watchdog: no progress, the program is at 0x80"));
}

TEST(WatchdogTest, AStallThatEndsIsSaidAndNeedsNoReset) {
  CamerasRig rig;
  small(rig, 2);
  rig.set("tvp5146.relock_fields", "0").set("firmware.watchdog", "300ms").set("run.frames", "30");
  const app::ElfImage elf = image("fovea_cameras.elf");
  ProgramHang program(rig.build(), elf);
  Listener heard(rig.board());
  const Picoseconds since = hang(rig, program, "remap_plain", false);
  const Picoseconds served = heard.served(since);
  while (kernel_time() < served + 250 * kPsPerMs) rig.advance(kPsPerMs);
  program.release();
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 30u) << rig.board().uart_text();
  EXPECT_TRUE(rig.board().resets().empty());
  ASSERT_EQ(heard.said().size(), 2u) << rig.board().uart_text();
  EXPECT_EQ(heard.said()[0].text, kStall);
  const std::string goes_on = "watchdog: the program goes on after ";
  ASSERT_TRUE(heard.said()[1].text.starts_with(goes_on)) << heard.said()[1].text;
  // The rest of the frame's remap comes on top: the whole of it takes less than a frame.
  const auto ms = std::stoul(heard.said()[1].text.substr(goes_on.size()));
  EXPECT_GE(ms, 250u);
  EXPECT_LT(ms, 290u);
  EXPECT_EQ(rig.wrong_picture(), "");
  unsigned dropped = 0;
  for (const auto& stats : rig.board().camera_stats()) {
    EXPECT_EQ(stats.captured, stats.displayed + stats.superseded + stats.dropped);
    EXPECT_EQ(stats.superseded, 0u);
    dropped += static_cast<unsigned>(stats.dropped);
  }
  // Of the frames that were complete during the stall the newest one waits.
  const auto shown = sequence(rig);
  unsigned missing = 0;
  for (std::size_t i = 1; i < shown.size(); ++i) missing += shown[i].number - shown[i - 1].number - 1;
  EXPECT_EQ(dropped, missing);
  EXPECT_GE(missing, 4u);
}

TEST(WatchdogTest, NightlyThatIsOffResetsNothing) {
  CamerasRig rig;
  small(rig, 1);
  rig.set("firmware.program", "cameras").set("firmware.watchdog", "0s").set("run.frames", "200");
  const app::ElfImage elf = image("fovea_cameras.elf");
  ProgramHang program(rig.build(), elf);
  Listener heard(rig.board());
  hang(rig, program, "remap_plain", false);
  while (kernel_time() < 2 * kPsPerSecond) rig.advance(kPsPerMs);
  EXPECT_FALSE(rig.board().chip_reset());
  EXPECT_TRUE(heard.said().empty()) << rig.board().uart_text();
  EXPECT_EQ(rig.board().dm365.timers[2]->regs.wdtcr.get(), 0u);
}

/// What cameras do that give no frames for longer than the period.
struct Calm {
  const char* name;
  std::vector<std::pair<const char*, const char*>> keys;
  const char* said = "";  ///< of a camera, at least
};
void PrintTo(const Calm& c, std::ostream* out) { *out << c.name; }
class CalmTest : public testing::TestWithParam<Calm> {};
TEST_P(CalmTest, IsNoReasonForAReset) {
  CamerasRig rig;
  small(rig, 1);
  rig.set("firmware.program", "cameras").set("tvp5146.relock_fields", "2").set("run.frames", "1000");
  // The longest gap is that of six fields of the display and two frames, of which half the period knows nothing.
  rig.set("firmware.watchdog", "420ms").set("fault.start", "445ms").set("fault.end", "1600ms");
  for (const auto& [key, value] : GetParam().keys) rig.set(key, value);
  Listener heard(rig.build());
  while (kernel_time() < 2 * kPsPerSecond) rig.advance(kPsPerMs);
  EXPECT_FALSE(rig.board().chip_reset()) << rig.board().uart_text();
  EXPECT_TRUE(heard.said().empty()) << rig.board().uart_text();
  EXPECT_NE(rig.board().uart_text().find(GetParam().said), std::string::npos) << rig.board().uart_text();
  EXPECT_EQ(rig.board().dm365.arm.failure(), "");
}
INSTANTIATE_TEST_SUITE_P(
    Cameras, CalmTest,
    testing::Values(Calm{"Unplugged", {{"fault.kind", "unplugged"}}, "camera 0: no signal"},
                    Calm{"WrongStandard", {{"fault.kind", "wrong_standard"}}, "camera 0: wrong standard"},
                    Calm{"NoFields",
                         {{"fault.kind", "sync_noise"}, {"fault.wrong_bits", "2"}},
                         "camera 0: no frames"},
                    Calm{"AllFramesLeftOut", {{"fault.kind", "short_lines"}}, "camera 0: irregular"},
                    Calm{"TenFieldsOfRelock",
                         {{"cameras.count", "2"}, {"cameras.genlocked", "false"}, {"tvp5146.relock_fields", "10"}}}),
    [](const auto& i) { return std::string(i.param.name); });

}  // namespace
}  // namespace fovea::e2e
