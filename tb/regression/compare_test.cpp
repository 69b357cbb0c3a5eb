// `fovea compare`: what stands first, and what is not said.
#include "sw/fovea/compare/compare.h"

#include <nlohmann/json.hpp>

#include "tb/regression/command_fixture.h"

namespace fovea::regression {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class CompareTest : public RegressionCommandTest {
 protected:
  CompareTest() {
    for (RunMaker* r : {&one, &two})
      r->figure("frame.rate", "25", "1/s")
          .figure("frame.window", "1", "s")
          .figure("frame.displayed", "25")
          .figure("ddr.bus_bytes", "100", "B")
          .figure("ddr.utilisation", "0.1", "ratio");
  }
  void set(const char* name, const char* before, const char* after, const char* unit) {
    one.figure(name, before, unit);
    two.figure(name, after, unit);
  }
  /// Names of the table, in order.
  std::vector<std::string> order(std::vector<std::string> options = {}) {
    std::vector<std::string> words = {"compare", one.write(dir, "one").string(), two.write(dir, "two").string()};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(cli(words), 1) << err.str();
    std::vector<std::string> names;
    std::istringstream lines(out.str());
    bool table = false;
    for (std::string line, name; std::getline(lines, line);) {
      if (line.starts_with("where the")) break;
      if (std::istringstream(line) >> name && table) names.push_back(name);
      table = table || line.starts_with("  figure");
    }
    return names;
  }
  RunMaker one = profiled(), two = profiled();
};

TEST_F(CompareTest, TheLargestShareOfTheTimeStandsFirst) {
  set("cpu.stall.tlb", "0", "18", "cycles");              // 1.8 % of 1000 clocks, from nothing
  set("cpu.stall.write_buffer", "500", "540", "cycles");  // 4 %
  set("frame.remap_time.mean", "0.004", "0.012", "s");    // 20 % of the period of 40 ms
  set("ddr.arm_d.wait.read.own", "0.1", "0.2", "s");      // 10 % of the window
  set("ddr.arm_d.latency.mean", "1e-7", "3e-7", "s");     // 0.0005 % of a frame, though tripled
  set("ddr.read_bytes", "100", "150", "B");               // 5 % of what the bus can carry
  set("frame.dropped", "0", "2", "1");                    // 8 % of 25 frames
  set("ddr.activates", "10", "30", "1");                  // a count: tripled
  set("ddr.refreshes", "10", "11", "1");                  // a count: 10 %
  two.figure("new", "1");                                 // in one only
  EXPECT_THAT(order(), testing::ElementsAre("frame.remap_time.mean", "ddr.arm_d.wait.read.own", "frame.dropped",
                                            "ddr.read_bytes", "cpu.stall.write_buffer", "cpu.stall.tlb",
                                            "ddr.arm_d.latency.mean", "ddr.activates", "ddr.refreshes", "new"));
  EXPECT_THAT(out.str(), AllOf(HasSubstr("of a frame\n"), HasSubstr("+20.0 %\n"), HasSubstr("+4.0 %\n")));
}

// No figure of Fovea's is so, but a folder of results may be of another program.
TEST_F(CompareTest, WholeFiguresBelowZeroAndBeyondSixtyFourBitsStayWhatTheyAre) {
  set("a.small", "-5", "-9223372036854775808", "1");
  set("b.large", "18446744073709551615", "1e300", "1");
  set("c.count", "7", "9007199254740993", "1");
  EXPECT_EQ(cli({"compare", one.write(dir, "one").string(), two.write(dir, "two").string(), "--json"}), 1);
  std::map<std::string, nlohmann::json> rows;
  const auto printed = nlohmann::json::parse(out.str());
  for (const auto& row : printed["figures"]) rows[row["name"]] = row;
  EXPECT_EQ(rows["a.small"]["a"].dump(), "-5");
  EXPECT_EQ(rows["a.small"]["b"].dump(), "-9223372036854775808");
  EXPECT_EQ(rows["b.large"]["a"].get<double>(), 0x1p64);
  EXPECT_EQ(rows["b.large"]["b"].get<double>(), 1e300);
  EXPECT_EQ(rows["c.count"]["a"].dump(), "7");
}

TEST_F(CompareTest, ParametersOfOneOnlyAreOneLineUnlessTheyAreFew) {
  for (int n = 0; n < 6; ++n) {
    two.parameters["other.key" + std::to_string(n)] = "1";
    set("cpu.stall.tlb", "0", "18", "cycles");
    order();
    const bool few = n < 5;
    EXPECT_EQ(out.str().find("parameter other.key0 is new: 1") != std::string::npos, few) << n;
    EXPECT_EQ(out.str().find("  6 parameters exist in one of the two only; --all lists them\n") != std::string::npos,
              !few);
    order({"--all"});
    EXPECT_THAT(out.str(), HasSubstr("parameter other.key0 is new: 1"));
  }
  EXPECT_EQ(cli({"compare", (dir / "one").string(), (dir / "two").string(), "--json"}), 1);
  EXPECT_EQ(nlohmann::json::parse(out.str())["settings"].size(), 6u);
}

// From power-up on, the mean clock is longer the more of the time is boot at a slow clock; the core's clock is the
// same.
TEST_F(CompareTest, EqualClocksAreComparedAsClocks) {
  const auto text = [&](bool frames, const char* preset) {
    RunMaker a_run = profiled(), b_run = slow;
    for (RunMaker* r : {&a_run, &b_run}) {
      r->parameters["clocks.preset"] = "297/243";
      if (!frames) r->figures.erase("frame.remap_time.mean");
    }
    b_run.parameters["clocks.preset"] = preset;
    a_run.figure("frame.window", "4e-6", "s");
    b_run.figure("frame.window", "5e-6", "s");
    cli({"compare", a_run.write(dir, "one").string(), b_run.write(dir, "two").string()});
    return out.str();
  };
  EXPECT_THAT(text(false, "297/243"), AllOf(HasSubstr("core's clocks went"), Not(HasSubstr("other lengths"))));
  EXPECT_THAT(text(true, "297/243"), HasSubstr("other lengths")) << "the firmware has set another clock";
  EXPECT_THAT(text(false, "216/172"), HasSubstr("other lengths"));
}

}  // namespace
}  // namespace fovea::regression
