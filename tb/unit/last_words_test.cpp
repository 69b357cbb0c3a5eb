// What a command says at its end.
#include "sw/fovea/explain/last_words.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <sstream>
#include <tuple>

#include "tb/unit/support.h"

namespace fovea::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::vector<std::uint64_t> apportion(std::uint64_t total, std::vector<std::uint64_t> shares) {
  return apportioned(total, shares);
}

TEST(ApportionedTest, RoundsSoThatTheSumStays) {
  EXPECT_THAT(apportion(100, {1, 1, 1}), ElementsAre(34, 33, 33));
  EXPECT_THAT(apportion(3, {5, 0, 5}), ElementsAre(2, 0, 1)) << "among equals the first";
  EXPECT_THAT(apportion(400, {262, 2, 136}), ElementsAre(262, 2, 136));
  EXPECT_THAT(apportion(10, {249, 751}), ElementsAre(2, 8));
  EXPECT_THAT(apportion(10, {250, 750}), ElementsAre(3, 7));
  EXPECT_THAT(apportion(10, {0, 0}), ElementsAre(0, 0));
  std::mt19937_64 random(5);
  for (int n = 0; n < 1000; ++n) {
    std::vector<std::uint64_t> shares(1 + random() % 12);
    for (auto& s : shares) s = random() % 300'000'000;
    const std::uint64_t total = random() % 2000;
    const auto parts = apportion(total, shares);
    const auto sum = std::accumulate(shares.begin(), shares.end(), std::uint64_t{0});
    if (sum == 0) continue;
    EXPECT_EQ(std::accumulate(parts.begin(), parts.end(), std::uint64_t{0}), total);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double exact = static_cast<double>(total) * static_cast<double>(shares[i]) / static_cast<double>(sum);
      EXPECT_LT(std::abs(static_cast<double>(parts[i]) - exact), 1.0);
    }
  }
}

StatRow counted(std::string name, std::uint64_t n) { return {std::move(name), n, "cycles", ""}; }

/// A window of 10 frames of 40 ms at 1000 clocks a ms: 400,000 clocks.
std::vector<StatRow> budget_rows() {
  return {{"frame.window", 0.4, "s", ""},         counted("frame.displayed", 10),
          counted("cpu.cycles", 400'000),         counted("cpu.idle", 113'000),
          counted("cpu.issue", 100'000),          counted("cpu.stall.dcache", 187'000),
          counted("cpu.remap.cycles", 286'600),   counted("cpu.remap.idle", 600),
          counted("cpu.spare", 112'400),
          counted("cpu.remap.issue", 98'000),     counted("cpu.remap.stall.dcache", 121'000),
          counted("cpu.remap.stall.write_buffer", 67'000), counted("cpu.remap.stall.icache", 0)};
}

// 286.6 of 400 tenths, 112.4 idle, 1.0 other: rounded they are 287, 112 and 1. Of the remap's 287 tenths:
// 121.2, 98.1, 67.1 and 0.6.
TEST(FrameBudgetTest, AddsUpToThePeriodAndTheRemap) {
  EXPECT_EQ(frame_budget(budget_rows()),
            "budget  40.0 ms a displayed frame: remap 28.7, other work 0.1, idle 11.2\n"
            "        remap 28.7 ms: waiting for D-cache line fills 12.1, executing 9.8,\n"
            "        waiting for room in the write buffer 6.7, waiting for the EDMA or the\n"
            "        remap engine 0.1\n");
}

// Sleeps are told apart by what ended them, and the sum stays.
TEST(FrameBudgetTest, SleepsAreNamedByWhatEndsThem) {
  auto rows = budget_rows();
  rows.push_back(counted("cpu.remap.idle.engine", 600));
  rows.push_back(counted("cpu.idle.engine", 600));
  rows.push_back(counted("cpu.idle.display", 112'000));
  rows.push_back(counted("cpu.idle.capture", 300));
  EXPECT_EQ(frame_budget(rows),
            "budget  40.0 ms a displayed frame: remap 28.7, other work 0.1, idle 11.2\n"
            "        remap 28.7 ms: waiting for D-cache line fills 12.1, executing 9.8,\n"
            "        waiting for room in the write buffer 6.7, waiting for the remap engine\n"
            "        0.1\n");
  EXPECT_EQ(run_words(rows, {}).substr(frame_budget(rows).size() + verdict(rows).size()),
            "core    waiting for D-cache line fills 46.7 %, asleep until the display's\n"
            "        interrupt 28.0 %, executing 25.0 %, waiting for the remap engine 0.2 %,\n"
            "        asleep until the camera's interrupt 0.1 %\n");
}

// The display's interrupt ends the first half of a wait for the EDMA, which goes on behind it: 0.1 ms in all,
// and no idle time. Without the remap it is the display's.
TEST(FrameBudgetTest, AnInterruptInTheMidstOfAWaitMakesNoIdleTime) {
  auto rows = budget_rows();
  for (const auto& [event, all, within] : {std::tuple("dma", 350, 300), std::tuple("display", 112'650, 300)}) {
    rows.push_back(counted(std::string("cpu.idle.") + event, static_cast<std::uint64_t>(all)));
    rows.push_back(counted(std::string("cpu.remap.idle.") + event, static_cast<std::uint64_t>(within)));
  }
  // 50 clocks until the EDMA is done lie outside of remaps, where the pins do not tell what the program does.
  for (StatRow& row : rows)
    if (row.name == "cpu.spare") row.value = std::uint64_t{112'350};
  EXPECT_THAT(frame_budget(rows), HasSubstr("other work 0.1, idle 11.2\n"));
  EXPECT_THAT(frame_budget(rows), HasSubstr("write buffer 6.7, waiting for the EDMA 0.1\n"));
  const std::string text = run_words(rows, {});
  EXPECT_THAT(text, HasSubstr("asleep until the display's\n        interrupt 28.1 %"));
  EXPECT_THAT(text, HasSubstr("waiting for the EDMA 0.2 %")) << "650 of 400,000";
  EXPECT_EQ(text.find("waiting for an interrupt"), std::string::npos);
}

// 0.04 ms of other work in a frame of 40 ms are 0.0: not a word about it.
TEST(FrameBudgetTest, PartsThatRoundToZeroAreLeftOut) {
  auto rows = budget_rows();
  for (StatRow& row : rows)
    if (row.name == "cpu.spare") row.value = std::uint64_t{400'000 - 286'600 - 400};
  EXPECT_THAT(frame_budget(rows), StartsWith("budget  40.0 ms a displayed frame: remap 28.7, idle 11.3\n"));
}

// Both EDMA and engine ended sleeps within remaps: the figures do not tell for which of them the other sleeps were.
TEST(FrameBudgetTest, TwoPartsThatAreWaitedForAreBothNamed) {
  auto rows = budget_rows();
  rows.push_back(counted("cpu.remap.idle.dma", 1));
  rows.push_back(counted("cpu.remap.idle.engine", 599));
  EXPECT_THAT(frame_budget(rows), HasSubstr("waiting for the EDMA or the\n        remap engine 0.1\n"));
}

TEST(FrameBudgetTest, IsLeftOutWithoutARemap) {
  auto rows = budget_rows();
  std::erase_if(rows, [](const StatRow& r) { return r.name == "cpu.remap.cycles"; });
  EXPECT_EQ(frame_budget(rows), "");
  EXPECT_EQ(frame_budget({}), "");
}

/// All statistics of a large run, with long numbers.
std::vector<StatRow> full_run() {
  std::vector<StatRow> rows = budget_rows();
  rows.push_back({"frame.rate", 25.0, "1/s", ""});
  rows.push_back(counted("frame.repeated", 0));
  rows.push_back(counted("frame.dropped", 0));
  for (const char* what : {"frame.remap_time", "frame.latency"})
    for (const char* figure : {".min", ".mean", ".max"})
      rows.push_back({std::string(what) + figure, 0.0286612, "s", ""});
  rows.push_back({"startup.lut_time", 1.64234, "s", ""});
  rows.push_back({"quality.psnr_y", 31.23, "dB", ""});
  rows.push_back({"quality.ssim_y", 0.9543, "1", ""});
  rows.push_back({"quality.straightness", 0.412, "px", ""});
  rows.push_back({"ddr.utilisation", 0.172, "ratio", ""});
  rows.push_back({"ddr.headroom", 0.661, "ratio", ""});
  for (const auto& [name, n] : {std::pair("hits", 8312), std::pair("misses", 1000), std::pair("conflicts", 688)})
    rows.push_back(counted(std::string("ddr.row_") + name, static_cast<std::uint64_t>(n)));
  rows.push_back(counted("ddr.read_bytes", 63'400'000));
  rows.push_back(counted("ddr.write_bytes", 41'490'000));
  int n = 0;
  for (const char* master : {"arm_d", "arm_i", "vpfe", "vpbe", "edma_tc0", "remap_engine"})
    for (const char* direction : {"read", "write"})
      for (const char* culprit : {"service", "bridge", "row_conflict", "vpbe", "own", "refresh"})
        rows.push_back({std::string("ddr.") + master + ".wait." + direction + "." + culprit,
                        1e-3 * (++n % 7), "s", ""});
  return rows;
}
/// Of eight masters.
std::vector<SlowestRow> slowest_rows() {
  std::vector<SlowestRow> rows;
  Picoseconds latency = 9 * kPsPerUs;
  for (const char* master : {"arm_d", "arm_i", "vpfe", "vpbe", "edma_tc0", "edma_tc1", "edma_tc2", "remap_engine"}) {
    const Picoseconds at = 1'879'153'412'345, middle = at + kPsPerUs;
    for (const char* direction : {"read", "write"}) {
      rows.push_back({master,
                      direction,
                      master,
                      "hit",
                      at,
                      latency,
                      0,
                      0,
                      32,
                      0,
                      {{"port", "bridge", at, middle}, {"controller", "own", middle, at + latency}}});
      latency -= 100'000;
    }
  }
  return rows;
}

const std::vector<StatRow> kHost = {{"wall_time", 12.3456, "s", ""},
                                    {"realtime_factor", 0.934, "x", ""},
                                    {"mips", 41.234, "1e6/s", ""},
                                    {"peak_rss", std::uint64_t{566'000'000}, "B", ""}};

void expect_one_screen(const std::string& text, std::size_t lines_below) {
  std::istringstream lines(text);
  std::size_t n = 0;
  for (std::string line; std::getline(lines, line); ++n) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_LE(n + lines_below, 24u) << text;
  for (const char* unit : {"1/s", "s/s", "cycles", "ratio", "nan"}) EXPECT_THAT(text, Not(HasSubstr(unit)));
}

TEST(RunWordsTest, FitOneScreen) {
  const std::string text = run_words(full_run(), kHost, slowest_rows());
  expect_one_screen(text, 5);  // what binds, ended by, results, pictures, report
  EXPECT_THAT(text, StartsWith("frame rate met: 10 of 10 frames shown (25 a second)"));
  EXPECT_THAT(text, HasSubstr("\nbudget  40.0 ms"));
  EXPECT_THAT(text, HasSubstr("\ntimes   a remap 28.66 ms (28.66 to 28.66), capture to display 28.66 ms"));
  EXPECT_THAT(text, HasSubstr("\nSDRAM   data bus busy 17.2 %, no request queued 66.1 %, reads 158.5 MB/s"));
  EXPECT_THAT(text, HasSubstr("row hits 83.1 %"));
  EXPECT_THAT(text, HasSubstr("\nquality PSNR 31.2 dB, SSIM 0.954, straight lines bend by 0.41 pixels\n"));
  EXPECT_THAT(text, HasSubstr("\nslowest read of arm_d: 9.000 us at 1879.153412 ms; queue 8.00, bridges 1.00\n"));
  EXPECT_THAT(text, HasSubstr("\nhost    12.35 s, 0.93x real time, 41.2 million instructions a second, 566 MB of"));
  EXPECT_THAT(text, Not(HasSubstr("binds")));
}

TEST(RunWordsTest, SayNothingOfWhatIsNotThere) {
  EXPECT_EQ(run_words({}, {}), "");
  const std::vector<StatRow> zeros = {{"ddr.vpbe.wait.read.bridge", 0.0, "s", ""},
                                      counted("ddr.row_hits", 0),
                                      counted("ddr.row_misses", 0),
                                      counted("ddr.row_conflicts", 0),
                                      {"quality.psnr_y", std::nan(""), "dB", ""},
                                      counted("cpu.cycles", 0)};
  EXPECT_EQ(run_words(zeros, {}), "");
}

// The core's line adds up to 100 %; zeros are left out.
TEST(RunWordsTest, TheCoresClocksAddUp) {
  EXPECT_EQ(run_words(std::vector<StatRow>{counted("cpu.cycles", 3), counted("cpu.issue", 1),
                                           counted("cpu.idle", 1), counted("cpu.stall.tcm", 1),
                                           counted("cpu.stall.tlb", 0)},
                      {}),
            "core    executing 33.4 %, waiting for an interrupt 33.3 %, waiting for internal\n"
            "        RAM 33.3 %\n");
}

TEST(RunWordsTest, TheLargestWaitIsNamed) {
  const std::vector<StatRow> rows = {
      {"ddr.vpbe.wait.read.service", 0.003, "s", ""}, {"ddr.vpbe.wait.read.vpfe", 0.001, "s", ""},
      {"ddr.arm_d.wait.read.bridge", 0.060, "s", ""}, {"ddr.arm_d.wait.read.service", 0.120, "s", ""},
      {"ddr.arm_d.wait.read.refresh", 0.001, "s", ""}, {"ddr.arm_d.wait.read.own", 0.019, "s", ""},
      {"ddr.arm_d.wait.write.own", 0.0, "s", ""},
  };
  EXPECT_EQ(run_words(rows, {}),
            "waits   all reads of arm_d (the core's data) take 200 ms together: own way\n"
            "        through crossbar and SDRAM controller 60 %, bridges 30 %\n");
}

// 0.5 % is shown as 1, less as nothing. A transfer controller has its name, as there are four.
TEST(RunWordsTest, PartsThatRoundToZeroAreLeftOut) {
  const auto words = [](double part) {
    return run_words(std::vector<StatRow>{{"ddr.edma_tc2.wait.write.bridge", 1 - part, "s", ""},
                                          {"ddr.edma_tc2.wait.write.edma_tc0", part, "s", ""}}, {});
  };
  EXPECT_EQ(words(0.00501),
            "waits   all writes of edma_tc2 take 1 s together: bridges 99 %, behind edma_tc0\n        1 %\n");
  EXPECT_EQ(words(0.00499), "waits   all writes of edma_tc2 take 1 s together: bridges 100 %\n");
}

// Of each master the slower direction, the slowest first; parts as far as the line goes.
TEST(RunWordsTest, TheSlowestRequestsHaveALineEach) {
  std::vector<SlowestRow> rows = slowest_rows();
  rows.resize(4);
  rows[1].latency = 9'500'000;
  rows[1].steps[1].to += 600'000;
  EXPECT_EQ(run_words({}, {}, rows),
            "slowest write of arm_d: 9.500 us at 1879.153412 ms; queue 8.50, bridges 1.00\n"
            "        read of arm_i: 8.800 us at 1879.153412 ms; queue 7.80, bridges 1.00\n");
  rows.resize(1);
  rows[0].steps = {
      {"crossbar", "edma_tc0", 0, 3'000'000}, {"crossbar", "vpfe", 0, 2'000'000}, {"return", "service", 0, 4'000'000}};
  EXPECT_EQ(run_words({}, {}, rows), "slowest read of arm_d: 9.000 us at 1879.153412 ms; own way 4.00\n")
      << "a part too many";
}

TEST(ReplayWordsTest, BeginWithWhatWasReplayed) {
  std::vector<StatRow> rows = full_run();
  rows.push_back({"replay.time", 0.2, "s", ""});
  rows.push_back(counted("replay.requests", 12345));
  rows.push_back({"replay.bandwidth", 524.46e6, "B/s", ""});
  const std::string text =
      replay_words(rows, std::vector<StatRow>{{"requests_per_second", 1234567.0, "1/s", ""}}, slowest_rows());
  expect_one_screen(text, 2);
  EXPECT_THAT(text, StartsWith("replayed 12345 requests in 200 ms of simulated time, 524.5 MB/s\n"));
  EXPECT_THAT(text, HasSubstr("reads 317.0 MB/s"));
  EXPECT_THAT(text, HasSubstr("host    1.23 million requests a second\n"));
}

TEST(ExecWordsTest, SayInstructionsClocksAndTime) {
  const std::vector<StatRow> rows = {counted("cpu.cycles", 2'970), counted("cpu.instructions", 1'000),
                                     counted("cpu.issue", 2'970)};
  EXPECT_EQ(exec_words(rows, Frequency(297'000'000)),
            "core    1000 instructions in 2970 clocks, 2.97 an instruction: 0.000010 s at\n"
            "        297 MHz\n"
            "core    executing 100.0 %\n");
  EXPECT_EQ(exec_words({}, {}), "core    0 instructions in 0 clocks\n");
}

}  // namespace
}  // namespace fovea::app
