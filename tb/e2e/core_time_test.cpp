// Simulated time on the board while only the core is active: a timer's interrupt, a change of the
// core's clock.
#include <gtest/gtest.h>

#include <systemc>

#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

TEST(AlarmTest, ItComesToTheClockWithNothingElsePending) {
  Rig rig(PROGRAM_DIR "/alarms.elf");
  auto& soc = rig.build().dm365;
  std::vector<std::pair<std::uint32_t, Picoseconds>> shown;
  const Subscription pins = soc.gpio.observe_outputs([&](unsigned bank, std::uint32_t out, Picoseconds at) {
    if (bank == 2 && out) shown.emplace_back(out, at);
  });
  rig.advance(kPsPerMs);
  ASSERT_EQ(shown.size(), 4u);
  for (unsigned k = 0; k < 4; ++k) ASSERT_EQ(shown[k].first, k + 1);
  const Picoseconds first = shown[1].second - shown[0].second;
  const Picoseconds second = shown[3].second - shown[2].second;
  // 24 MHz, for the timer and, from reset, for the core; each sled instruction is one clock. 60 counts
  // more are 2.5 us; edges are rounded down to whole picoseconds.
  EXPECT_NEAR(static_cast<double>(second - first), 2.5e6, 1);
  // From the start of counting to the write of the pin: the mark and the way into the handler are
  // under 40 clocks.
  EXPECT_GT(first, 160 * kPsPerSecond / 24'000'000);
  EXPECT_LT(first, 240 * kPsPerSecond / 24'000'000);
}

/// The core's clock changes by a factor of eight some time after a command, while the core runs on or
/// waits for the end of a long clock: its next edge moves. A case a process: each elaborates a board.
struct Change {
  const char* name;
  const char* program;
  bool strict;
  const char* go_time;      ///< from the command to the change
  double two_instructions;  ///< between command and pin, in ps: two clocks, as the bus runs at half
  unsigned from = 2;        ///< with as many instructions, the change lies before all of the two last
};
void PrintTo(const Change& c, std::ostream* out) { *out << c.name; }
class ClockChangeTest : public testing::TestWithParam<Change> {};
TEST_P(ClockChangeTest, TheChangeComesWhenItIsDue) {
  const Change& c = GetParam();
  Rig rig(std::string(PROGRAM_DIR "/") + c.program);
  rig.set("pll.go_time", c.go_time);
  if (c.strict) rig.strict();
  auto& soc = rig.build().dm365;
  std::vector<Picoseconds> shown;
  const Subscription pins = soc.gpio.observe_outputs([&](unsigned bank, std::uint32_t out, Picoseconds at) {
    if (bank == 2 && out) shown.push_back(at);
  });
  rig.advance(3 * kPsPerMs);
  EXPECT_EQ(soc.arm.failure(), "");
  ASSERT_EQ(shown.size(), 48u);
  const auto took = [&](unsigned n) { return static_cast<double>(shown[2 * n + 1] - shown[2 * n]); };
  for (unsigned n = c.from; n < 24; ++n)
    EXPECT_NEAR(took(n), took(n - 2) + c.two_instructions, 2) << n;
}
INSTANTIATE_TEST_SUITE_P(
    Clocks, ClockChangeTest,
    testing::Values(Change{"Faster", "faster.elf", false, "500ns", 2e12 / 24e6},
                    Change{"FasterStrict", "faster.elf", true, "500ns", 2e12 / 24e6},
                    Change{"BeforeItGetsFaster", "faster.elf", false, "20us", 2e12 / 3e6},
                    Change{"BeforeItGetsFasterStrict", "faster.elf", true, "20us", 2e12 / 3e6},
                    Change{"Slower", "slower.elf", false, "40ns", 2e12 / 3e6, 4},
                    Change{"SlowerStrict", "slower.elf", true, "40ns", 2e12 / 3e6, 4},
                    Change{"BeforeItGetsSlower", "slower.elf", false, "20us", 2e12 / 24e6}),
    [](const auto& c) { return c.param.name; });

}  // namespace
}  // namespace fovea::e2e
