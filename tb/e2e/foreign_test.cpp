// Runs register sequences of public drivers (programs/foreign_sequences.c) on the board, and checks
// what the host observes.
#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <systemc>

#include "model/common/check.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

/// Runs the program to its reset and keeps its verdicts.
struct Foreign {
  Rig rig{PROGRAM_DIR "/foreign_sequences.elf"};
  std::map<std::string, std::string> verdicts;
  explicit Foreign(bool cpld = false) {
    if (cpld) rig.set("board.cpld", "true");
    rig.run(kPsPerSecond);
    std::istringstream lines(rig.board().uart_text());
    for (std::string line; std::getline(lines, line);) {
      if (line.ends_with('\r')) line.pop_back();
      if (const auto colon = line.find(": "); colon != std::string::npos)
        verdicts[line.substr(0, colon)] = line.substr(colon + 2);
    }
  }
};

std::uint64_t not_modelled(const Foreign& f, const std::string& what) {
  const auto counts = f.rig.diagnostics.counts();
  const auto found = counts.find({Diagnostics::Kind::kNotModelled, what});
  return found == counts.end() ? 0 : found->second;
}

TEST(ForeignTest, SequencesOfOtherDriversWork) {
  Foreign f;
  EXPECT_EQ(f.verdicts["i2c write of two bytes"], "ok");
  EXPECT_EQ(f.verdicts["prediv written back"], "ok");
  EXPECT_EQ(f.verdicts["memory size"], "ok");
  EXPECT_EQ(f.verdicts["user page at 0x10000"], "ok");
  EXPECT_EQ(f.verdicts["internal RAM elsewhere"], "ok");
  EXPECT_EQ(f.verdicts["edma CCCFG reads"], "ok");
  EXPECT_EQ(f.verdicts["edma QUEPRI reads"], "ok");
  EXPECT_EQ(f.verdicts["emac aborts"], "ok");
  EXPECT_EQ(not_modelled(f, "bus error: EMAC at 0x01d07000 is not modelled"), 1u);
}

TEST(ForeignTest, WithoutACpldItsAddressesAreANamedBusError) {
  Foreign f;
  EXPECT_NE(f.verdicts["cpld"], "ok");
  // SWITCH, the three writes, and the first of what is read back.
  EXPECT_EQ(not_modelled(f, "bus error: AEMIF chip select 1 at 0x04000000 is not modelled"), 5u);
}

TEST(ForeignTest, TheCpldOfTheEvmAnswersWhereLinuxLooks) {
  Foreign f(true);
  EXPECT_EQ(f.verdicts["cpld"], "ok");
  EXPECT_EQ(not_modelled(f, "bus error: AEMIF chip select 1 at 0x04000000 is not modelled"), 0u);
  EXPECT_EQ(not_modelled(f, "CPLD MUX: a video input other than the TVP5146 (5)"), 0u);
}

TEST(ForeignTest, ARestartAsLinuxDoesItAsksForAChipResetAndStopsThere) {
  Foreign f;
  auto& board = f.rig.board();
  ASSERT_TRUE(board.chip_reset().has_value());
  EXPECT_EQ(board.chip_reset()->cause,
            "a wrong key was written to the active watchdog, as Linux does to restart");
  EXPECT_EQ(board.chip_reset()->at, kernel_time());
  EXPECT_EQ(f.rig.elf().describe(board.chip_reset()->pc).substr(0, 16), "restart_as_linux");
  const std::string& text = board.uart_text();
  EXPECT_TRUE(text.ends_with("restarting\r\n")) << text;
}

}  // namespace
}  // namespace fovea::e2e
