// A timer's interrupt on the board while nothing else is pending: it comes when the timer says.
#include <gtest/gtest.h>

#include <systemc>

#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

TEST(InterruptTest, AnAlarmComesToTheClockWithNothingElsePending) {
  Rig rig(ALARMS_ELF);
  auto& soc = rig.build().dm365;
  std::vector<std::pair<std::uint32_t, Picoseconds>> shown;
  soc.gpio.on_output = [&](unsigned bank, std::uint32_t out, Picoseconds at) {
    if (bank == 2 && out) shown.emplace_back(out, at);
  };
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

}  // namespace
}  // namespace fovea::e2e

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
