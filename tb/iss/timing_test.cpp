// Issue clocks and interlocks, and the parameters that affect them.
#include "tb/iss/timing_cases.h"

namespace fovea::cpu::test {
namespace {

class TimingTest : public testing::TestWithParam<TimingCase> {};

TEST_P(TimingTest, TakesThePublishedClocks) {
  EXPECT_EQ(clocks_in_ram(GetParam()), GetParam().clocks) << GetParam().text;
}
TEST_P(TimingTest, TakesThemFromEachPlaceInACachedLine) {
  const auto clocks = clocks_by_place(GetParam());
  for (unsigned place = 0; place < clocks.size(); ++place)
    EXPECT_EQ(clocks[place], GetParam().clocks) << GetParam().text << " from word " << place;
}
INSTANTIATE_TEST_SUITE_P(Rows, TimingTest, testing::ValuesIn(kTimingCases),
                         [](const auto& row) { return std::string(row.param.name); });

/// Parameters that move the table's rows.
TEST(TimingParameterTest, ShiftedAddressAndTcmWaitStates) {
  const auto clocks = [](const Machine::Settings& settings, const char* text) {
    Machine m(settings);
    m.execute(std::string("ldr r4, =0x4000\n mov r5, #3\n svc #1\n") + text + "\n svc #1\n");
    return m.marks[1] - m.marks[0];
  };
  const char* const shifted = "ldr r0, [r4, r5, lsl #2]";
  EXPECT_EQ(clocks({}, shifted), 3u + 2);
  EXPECT_EQ(clocks({{"cpu.shifted_address_cycle", "false"}}, shifted), 3u + 1);
  // One wait state: each fetch and the load pay it.
  EXPECT_EQ(clocks({{"cpu.tcm.wait_states", "1 cycles"}}, "nop\n ldr r0, [r4]"),
            3u + 1 + 1 + (2 + 1) + 1);
}

}  // namespace
}  // namespace fovea::cpu::test
