// `fovea limits` over a toy board: searches with a known answer, what binds, tables, failures.
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <thread>

#include "sw/fovea/limits/answers.h"
#include "sw/fovea/points/child.h"
#include "tb/unit/support.h"

namespace fovea::limits {
namespace {

using test::read_text;
using test::TempDir;
using test::user_error;
using ::testing::HasSubstr;
using ::testing::Not;

/// The fake program in a folder of its own.
class LimitsTest : public ::testing::Test {
 protected:
  struct Done {
    int status;
    std::string out, err;
  };
  LimitsTest() {
    dir_.write("toy.yaml", "toy:\n  limit: 500\n");
    ::setenv("FAKE_LIMITS_LOG", (dir_ / "log").c_str(), 1);
  }
  std::vector<std::string> command(const std::string& arguments, const std::string& out = "L") const {
    std::vector<std::string> all = {FAKE_LIMITS, "limits", (dir_ / "toy.yaml").string(), "-o", (dir_ / out).string()};
    std::istringstream words(arguments);
    for (std::string w; words >> w;) all.push_back(w);
    return all;
  }
  Done limits(const std::string& arguments, const std::string& out = "L") {
    for (const char* stream : {"out.txt", "err.txt"}) std::filesystem::remove(dir_ / stream);
    points::Child child(command(arguments, out), dir_ / "out.txt", dir_ / "err.txt");
    return wait(child);
  }
  Done wait(points::Child& child) {
    while (!child.ended()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return {child.ended()->status, read_text(dir_ / "out.txt"), read_text(dir_ / "err.txt")};
  }
  std::size_t runs() const {
    const std::string log = read_text(dir_ / "log");
    return static_cast<std::size_t>(std::count(log.begin(), log.end(), '\n'));
  }
  std::string csv(const std::string& name) const { return read_text(dir_ / "L" / name); }
  /// Number of points whose description contains every one of the texts.
  int points_with(const std::vector<std::string>& texts, const std::string& out = "L") const {
    int n = 0;
    for (const auto& p : std::filesystem::directory_iterator(dir_ / out / "points")) {
      const std::string entry = read_text(p.path() / "point.json");
      n += std::all_of(texts.begin(), texts.end(),
                       [&](const std::string& t) { return entry.find('"' + t + '"') != entry.npos; });
    }
    return n;
  }
  TempDir dir_;
};

TEST_F(LimitsTest, FindsTheLargestAndTheSmallestValue) {
  // The longest remap takes 10 + 3 + 3 + 0.18 + 0.02 = 16.2 ms of 40 ms.
  Done d = limits("--find toy.value=0..1000 -s ddr.request_latency=18cycles");
  EXPECT_EQ(d.status, 0) << d.err;
  EXPECT_THAT(d.out,
              testing::ContainsRegex("toy.value: 500 is the largest of the 1[0-9] values tried that meets the "
                                     "conditions; the longest remap leaves 59.5 % of a frame period. With 501: 3 "
                                     "dropped frames.\n"));
  EXPECT_THAT(d.out, HasSubstr("Conditions: no frame is dropped, none is shown twice, but by a loop that slips once or "
                               "while the decoder looks for a camera's syncs, no capture overflows, no display "
                               "underflows; the remaps of a frame take no longer than its period on average.\n"));
  EXPECT_THAT(csv("limits.csv"),
              testing::ContainsRegex("toy.value,,largest,500,,501,3 dropped frames,yes,1[0-9],25.0,"));
  d = limits("--find toy.value=0..1000 -s toy.limit=2000 -s toy.floor=37", "M");
  EXPECT_EQ(d.status, 0) << d.err;
  EXPECT_THAT(d.out, HasSubstr("toy.value: 37 is the smallest of the "));
  EXPECT_THAT(d.out, HasSubstr("With 36: 3 dropped frames."));
}

TEST_F(LimitsTest, StepsUnitsAndRealNumbers) {
  Done d = limits("--find toy.clock=100MHz..1GHz:50MHz -s toy.value=7");
  EXPECT_THAT(d.out, HasSubstr("toy.clock: 250MHz is the smallest of the ")) << d.err;
  EXPECT_THAT(d.out, HasSubstr("With 200MHz: 1 dropped frame."));
  d = limits("--find toy.angle=0deg..90deg:0.5deg", "M");
  EXPECT_THAT(d.out, HasSubstr("toy.angle: 30.5deg is the largest of the ")) << d.err;
  EXPECT_THAT(d.out, HasSubstr("With 31deg: "));
}

TEST_F(LimitsTest, NoLimitNoneAndAlternating) {
  Done d = limits("--find toy.value=0..400:10");
  EXPECT_EQ(d.status, 0);
  // 10 + 3 + 3 + 0.1 = 16.1 ms of 40 ms at every value; the one with the least left is the answer where they differ.
  EXPECT_THAT(d.out,
              HasSubstr("toy.value: all 4 values that were tried from 0 to 400 meet the conditions. The tightest is "
                        "400; the longest remap leaves 59.7 % of a frame period.\n"));
  d = limits("--find bus.arm_d.request_latency=1cycles..17cycles", "A");
  EXPECT_THAT(d.out, testing::ContainsRegex("The tightest is 17 cycles; the longest remap leaves 24.[78] %"));
  EXPECT_THAT(read_text(dir_ / "A" / "limits.csv"), HasSubstr("bus.arm_d.request_latency,,all,17 cycles,"));
  d = limits("--find toy.value=600..900 --probes 0", "M");
  EXPECT_EQ(d.status, 1);
  EXPECT_THAT(d.out,
              HasSubstr("neither 600 (3 dropped frames) nor 900 (3 dropped frames) meets the conditions, nor does one "
                        "of the 2 values tried."));
  d = limits("--find toy.value=0..999 -s toy.floor=400 -s toy.limit=600", "B");
  EXPECT_EQ(d.status, 0) << "not every value is bad";
  EXPECT_THAT(d.out, HasSubstr("neither 0 (3 dropped frames) nor 999 (3 dropped frames) meets the conditions, but "));
  EXPECT_THAT(d.out, HasSubstr(" between them does; the longest remap leaves 59.7 % of a frame period. --probes 1000"));
  EXPECT_THAT(read_text(dir_ / "B" / "limits.csv"), HasSubstr("toy.value,,between,4"));
  d = limits("--find toy.value=0..1000 -s toy.limit=300 -s toy.hole=800", "N");
  EXPECT_EQ(d.status, 0);
  EXPECT_THAT(d.out, HasSubstr("from 0 up to 300 every value that was tried meets the conditions, "));
  EXPECT_THAT(d.out, testing::ContainsRegex("Not monotonic: beyond that, 8[0-9]* meets the conditions too, although a "
                                            "value before it does not."));
  EXPECT_THAT(read_text(dir_ / "N" / "limits.csv"), HasSubstr(",no,"));
}

// The loop slips in the window from 300 on and before it from 400 on; from 500 on it loses every third frame, which
// shows in a window of three frames only as the slip does.
TEST_F(LimitsTest, ASlipCountsAlikeBeforeTheWindowAndWithinIt) {
  const std::string slips = " -s toy.limit=2000 -s toy.slipping=300 -s toy.slipped=400 -s toy.losing=500";
  Done d = limits("--find toy.value=0..1000" + slips);
  EXPECT_EQ(d.status, 0) << d.err;
  EXPECT_THAT(d.out, HasSubstr("toy.value: 499 is the largest of the "));
  EXPECT_THAT(d.out,
              HasSubstr("; frames are shown 118.9 ms after their capture, 40 ms later than with 0, as the loop has "
                        "slipped. With 500: 9 repeated frames.\n"));
  EXPECT_THAT(d.out, Not(HasSubstr("Not monotonic")));
  EXPECT_GT(points_with({"run.frames=27"}), 0) << "a longer window told";
  // An edge within the slips of the window, and the same without them: the same answer.
  d = limits("--find toy.value=0..350 -s toy.limit=340 -s toy.slipping=300", "M");
  EXPECT_THAT(d.out, HasSubstr("toy.value: 340 is the largest of the "));
  d = limits("--find toy.value=0..350 -s toy.limit=340 -s toy.slipped=300", "N");
  EXPECT_THAT(d.out, HasSubstr("toy.value: 340 is the largest of the "));
  // A condition of one's own is taken as it stands.
  d = limits("--find toy.value=0..1000 --probes 12 --require frame.repeated<=0" + slips, "O");
  EXPECT_THAT(d.out, HasSubstr("299 every value that was tried meets the conditions, "));
  d = limits("--find toy.value=0..1000 --require frame.latency.max<=0.08" + slips, "P");
  EXPECT_THAT(d.out, HasSubstr("toy.value: 299 is the largest of the "));
  // The plain run is judged alike.
  EXPECT_EQ(limits("--over toy.value=299,300,400" + slips, "Q").status, 0);
  EXPECT_THAT(read_text(dir_ / "Q" / "limits.csv"), HasSubstr("\n300,as it is,,met,"));
  EXPECT_EQ(limits("--over toy.value=500" + slips, "R").status, 1);
}

TEST_F(LimitsTest, NamesOfFiguresAreCheckedFirst) {
  for (const char* arguments : {"--binds frame.remap.mean", "--find toy.value=0..9 --require frame.drop<=0"}) {
    const std::size_t before = std::filesystem::exists(dir_ / "log") ? runs() : 0;
    const Done d = limits(arguments);
    EXPECT_EQ(d.status, 2);
    EXPECT_EQ(runs(), before + (before ? 0 : 1)) << "one run that ends at once, and it is known the second time";
    EXPECT_THAT(d.out, Not(HasSubstr("no answer")));
    EXPECT_THAT(d.err,
                testing::AnyOf(HasSubstr("error: --binds 'frame.remap.mean': a run has no figure of this name; did "
                                         "you mean 'frame.remap_time.mean'?"),
                               HasSubstr("error: --require 'frame.drop': a run has no figure of this name; did you "
                                         "mean 'frame.dropped'?")));
  }
  EXPECT_EQ(limits("--binds cpu.remap.nothing", "M").status, 2) << "what comes with frames only is known after a run";
}

TEST_F(LimitsTest, ACamerasOwnDropCounts) {
  const Done d = limits("--find toy.value=10..20 --probes 20");
  EXPECT_THAT(d.out, HasSubstr("from 10 up to 12 every value that was tried")) << d.err;
  EXPECT_THAT(d.out, HasSubstr("With 13: 1 dropped frame (camera.1.frame.dropped)."));
}

TEST_F(LimitsTest, NothingRunsTwice) {
  EXPECT_EQ(limits("--find toy.value=0..1000").status, 0);
  const std::size_t first = runs();
  const std::string before = csv("limits.csv") + csv("points.csv") + csv("answer.txt");
  Done d = limits("--find toy.value=0..1000");
  EXPECT_EQ(runs(), first);
  EXPECT_EQ(csv("limits.csv") + csv("points.csv") + csv("answer.txt"), before);
  EXPECT_THAT(d.out, HasSubstr("0 runs made"));
  // Written otherwise, it is still the same configuration; another value is another one.
  dir_.write("toy.yaml", "toy.limit: 500\ntoy.clock: 0.1GHz\n");
  d = limits("--find toy.value=0..1000 -s toy.clock=100000kHz");
  EXPECT_EQ(runs(), first);
  limits("--find toy.value=0..1000 -s toy.contention=1");
  EXPECT_EQ(runs(), 2 * first);
}

TEST_F(LimitsTest, AFilesContentsCountAndNotItsName) {
  const auto a = dir_.write("a.png", "one"), b = dir_.write("b.png", "one");
  limits("--over toy.value=1 -s toy.file=" + a.string());
  limits("--over toy.value=1 -s toy.file=" + b.string());
  EXPECT_EQ(runs(), 1u);
  dir_.write("b.png", "two");
  limits("--over toy.value=1 -s toy.file=" + b.string());
  EXPECT_EQ(runs(), 2u);
}

TEST_F(LimitsTest, EqualCombinationsShareTheirRuns) {
  const Done d = limits("--over toy.value=5,5,6 -j 3");
  EXPECT_EQ(d.status, 0) << d.err;
  EXPECT_EQ(runs(), 2u);
  const std::string table = csv("limits.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4);
}

TEST_F(LimitsTest, ATableOfAllCombinations) {
  const Done d = limits("--find toy.value=0..1000 --over toy.limit=100,200 --over toy.contention=0,1");
  EXPECT_EQ(d.status, 0) << d.err;
  const std::string table = csv("limits.csv");
  EXPECT_THAT(table, HasSubstr("toy.limit,toy.contention,searched,"));
  for (const char* row : {"\n100,0,toy.value,,largest,100,,101,", "\n100,1,toy.value,,largest,100,,101,",
                          "\n200,0,toy.value,,largest,200,,201,", "\n200,1,toy.value,,largest,200,,201,"})
    EXPECT_THAT(table, HasSubstr(row));
  EXPECT_THAT(d.out, HasSubstr("toy.limit=200, toy.contention=1:"));
}

TEST_F(LimitsTest, AFailedPointIsAResultWithItsMessage) {
  Done d = limits("--over toy.mode=good,guest_failure,user_error,defect");
  EXPECT_EQ(d.status, 4);  // the worst one
  const std::string table = csv("limits.csv"), points = csv("points.csv");
  EXPECT_THAT(table, HasSubstr("\ngood,as it is,,met,"));
  EXPECT_THAT(table, HasSubstr("\nguest_failure,as it is,,not met,,,,the guest failed: PC 0x0 in nowhere,"));
  EXPECT_THAT(table, HasSubstr("\nuser_error,as it is,,unknown,,,,a run ended with status 2: error: footage 'x' is "
                               "missing,"));
  EXPECT_THAT(table, HasSubstr("\ndefect,as it is,,unknown,,,,a run ended with status 4: own defect: broken,"));
  EXPECT_THAT(points, HasSubstr(",4,unknown,"));
  const std::size_t first = runs();
  EXPECT_EQ(limits("--over toy.mode=good,guest_failure,user_error,defect").status, 4);
  EXPECT_EQ(runs(), first + 2) << "what may have been the host's fault runs again";
  limits("--over toy.mode=good,guest_failure,user_error,defect --retry-failed");
  EXPECT_EQ(runs(), first + 5);
  EXPECT_EQ(limits("--find toy.value=0..9 -s toy.mode=guest_failure", "M").status, 1);
  EXPECT_EQ(limits("--find toy.value=0..9 -s toy.mode=user_error", "N").status, 2);
  EXPECT_EQ(limits("--binds frame.remap_time.mean -s toy.mode=guest_failure", "O").status, 3);
  d = limits("--over toy.mode=bare", "P");
  EXPECT_EQ(d.status, 2);
  EXPECT_THAT(d.out, HasSubstr("the run has no figure 'frame.dropped'"));
}

/// The line of a resource in binds.csv.
std::string line_of(const std::string& csv, const std::string& resource) {
  const auto at = csv.find("," + resource + ",");
  if (at == csv.npos) return "";
  const auto from = csv.rfind('\n', at) + 1;
  return csv.substr(from, csv.find('\n', at) - from);
}

TEST_F(LimitsTest, NamesWhatBindsAndNothingElse) {
  // 10 + 3 + 3 + 0.1 + 2 = 18.1 ms; the bridge is 33 % of it, the priority 11 %, the controller 0.6 %.
  const Done d = limits("--binds frame.remap_time.mean -s toy.contention=2");
  EXPECT_EQ(d.status, 0) << d.err;
  const std::string table = csv("binds.csv");
  EXPECT_THAT(line_of(table, "bridge_arm_d"), HasSubstr(",bridge_arm_d,yes,0.33149"));
  EXPECT_THAT(line_of(table, "priority_arm"), HasSubstr(",priority_arm,yes,0.11049"));
  EXPECT_THAT(line_of(table, "ddr_latency"), HasSubstr(",ddr_latency,no,0.0055"));
  EXPECT_THAT(line_of(table, "priority_idle"), HasSubstr("no traffic"));
  EXPECT_LT(table.find("bridge_arm_d"), table.find("priority_arm"));
  EXPECT_THAT(d.out, HasSubstr("The bridge of the core's data port binds: without its latency "
                               "(bus.arm_d.request_latency=0 cycles, bus.arm_d.response_latency=0 cycles) it is "
                               "12.1 ms, 33.1 % better."));
  // From 2 + 2 cycles 4 of 16.1 ms would go, from 6 + 6 12 of 24.1 ms.
  EXPECT_THAT(d.out,
              HasSubstr("12.1 ms, 33.1 % better.\n    This is assumed, no public figure: with "
                        "bus.arm_d.request_latency=2 cycles, bus.arm_d.response_latency=2 cycles it would be 16.1 "
                        "ms and 24.8 % of that would go; with bus.arm_d.request_latency=6 cycles, "
                        "bus.arm_d.response_latency=6 cycles it would be 24.1 ms and 49.8 % of that would go.\n"));
  EXPECT_THAT(line_of(table, "bridge_arm_d"), HasSubstr(",assumed,"));
  EXPECT_THAT(d.out,
              HasSubstr("The priority of arm binds: as the highest (priority.arm=0) it is 16.1 ms, 11.0 % better.\n"
                        "  Does not bind: "))
      << "a free choice has no belief";
  EXPECT_THAT(d.out, HasSubstr("Does not bind: ddr_latency (+0.6 %; family, +0.6 to +1.9 %)"));
  // A replay of what is no trace is no answer, and that is said.
  EXPECT_THAT(d.out, HasSubstr("display (its replay failed: error: '"));
  EXPECT_THAT(d.out, HasSubstr("bus.trace':1: it is 'the trace', a line of none of the known trace formats"));
  EXPECT_THAT(d.out, Not(HasSubstr("display (+")));
  EXPECT_THAT(line_of(table, "display"), HasSubstr(",display,,,"));
}

TEST_F(LimitsTest, WhatBindsOnlyAtAnEndOfWhatIsBelieved) {
  // The controller's 0.1 of 16.1 ms is 0.6 %; with 32 clocks there it would be 0.34 of 16.34 ms.
  const Done d = limits("--binds frame.remap_time.mean --relax ddr_latency");
  EXPECT_THAT(d.out, HasSubstr("Does not bind as it is, but may within what is believed: ddr_latency (+0.6 %; family, "
                               "+0.6 to +2.1 %).\n"));
  EXPECT_THAT(line_of(csv("binds.csv"), "ddr_latency"), HasSubstr(",ddr_latency,perhaps,0.0062"));
}

TEST_F(LimitsTest, BindsAtTwoPercentAndJustAbove) {
  // The plain run takes 10 + 0.1 ms and what the bridge and others cost.
  Done d = limits("--binds frame.remap_time.mean --relax priority_arm -s toy.contention=1 "
                  "-s bus.arm_d.request_latency=32cycles -s bus.arm_d.response_latency=6cycles");  // 1 / 49.1 = 2.04 %
  EXPECT_THAT(csv("binds.csv"), HasSubstr("priority_arm,yes,0.0203"));
  d = limits("--binds frame.remap_time.mean --relax priority_arm -s toy.contention=1 "
             "-s bus.arm_d.request_latency=32cycles -s bus.arm_d.response_latency=7cycles");  // 1 / 50.1 = 1.996 %
  EXPECT_THAT(csv("binds.csv"), HasSubstr("priority_arm,no,0.0199"));
  EXPECT_THAT(d.out, HasSubstr("Nothing that was relaxed makes it more than 2 % better."));
}

TEST_F(LimitsTest, BindsAtTheValueThatWasFound) {
  const Done d = limits("--find toy.value=0..600 --binds frame.remap_time.mean --relax bridge_arm_d");
  EXPECT_EQ(d.status, 0) << d.err;
  EXPECT_THAT(d.out, HasSubstr("What binds frame.remap_time.mean at toy.value=500 (16.1 ms)"));
}

TEST_F(LimitsTest, TheLargestLoadByPriority) {
  const Done d = limits("--priorities 0,4 --load-step 20");
  EXPECT_EQ(d.status, 0) << d.err;
  // The toy bears 340 MB/s, and 10 more for each step of the priority.
  EXPECT_THAT(d.out, HasSubstr("port load, priority 0: 340.0 MB/s moved (asked for 340 MB/s); the longest remap "
                               "leaves 59.7 % of a frame period. With 360 MB/s: 1 dropped frame"));
  EXPECT_THAT(d.out, HasSubstr("priority 4: 380.0 MB/s moved (asked for 380 MB/s); the longest remap leaves"));
  EXPECT_THAT(d.out, HasSubstr("USB 2.0 at high speed, bulk needs 53.2 MB/s: it can run beside this at every port"));
  // 4 slots of 64 bytes at 340 MB/s, from the first captured sample on.
  EXPECT_THAT(read_text(dir_ / "L" / "points.csv"), HasSubstr("340 MB/s on port load, priority 0"));
  EXPECT_EQ(points_with({"load.priority=0", "load.gap=752941ps", "load.start=123456ns"}), 1);
}

TEST_F(LimitsTest, ALoadThatLetsNoFrameBeShownIsWaitedForASecondLongerThanThePlainRun) {
  // The toy's first frame comes after 250 ms. The plain run has the experiment's own limit.
  ASSERT_EQ(limits("--priorities 0 --load-step 400").status, 0);
  EXPECT_GE(points_with({"load.priority=0"}), 2);
  EXPECT_EQ(points_with({"load.priority=0"}), points_with({"run.start_limit=1250ms"}));
  ASSERT_EQ(limits("--priorities 0 --load-step 400 -s run.start_limit=1251ms", "M").status, 0);
  EXPECT_EQ(points_with({"load.priority=0"}, "M"), points_with({"run.start_limit=1250ms"}, "M"));
  ASSERT_EQ(limits("--priorities 0 --load-step 400 -s run.start_limit=1249ms", "N").status, 0);
  EXPECT_GE(points_with({"load.priority=0"}, "N"), 2);
  EXPECT_EQ(points_with({"run.start_limit=1250ms"}, "N"), 0);
}

TEST_F(LimitsTest, LoadsThatAreTooMuchOrNeverTooMuch) {
  Done d = limits("--priorities 0 --load-step 400");
  EXPECT_THAT(d.out, HasSubstr("priority 0: none. With 400 MB/s: 1 dropped frame"));
  EXPECT_THAT(d.out, HasSubstr("USB 2.0 at high speed, bulk needs 53.2 MB/s: it cannot run beside this"));
  EXPECT_EQ(d.status, 0);
  d = limits("--priorities 0 --load-most 300 --require frame.dropped<=1", "M");
  EXPECT_THAT(d.out, HasSubstr("priority 0: 700.0 MB/s moved (as much as the port takes)"));
  d = limits("--priorities 0 -s toy.value=600", "N");
  EXPECT_EQ(d.status, 1);
  EXPECT_THAT(d.out, HasSubstr("It does not meet the conditions as it is: 3 dropped frames."));
}

TEST_F(LimitsTest, WrongUseIsOneLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"--find toy.value", "allowed: KEY=LOW..HIGH or KEY=LOW..HIGH:STEP"},
      {"--find toy.valu=0..9", "did you mean 'toy.value'?"},
      {"--find toy.mode=0..9", "'toy.mode' has no numbers but: good, guest_failure"},
      {"--find toy.value=0..1001", "'1001' is not allowed; allowed: 0 .. 1000"},
      {"--find toy.clock=100..200", "a number alone lacks its unit"},
      {"--find toy.value=9..9", "the first end must be below the second one"},
      {"--find toy.value=0..9:10", "the step is larger than the range"},
      {"--find toy.value=0..9:0", "a step above 0 is needed"},
      {"--find toy.angle=0deg..9deg:1", "the step needs the unit 'deg'"},
      {"--over toy.value", "allowed: KEY=VALUE,VALUE..."},
      {"--over toy.value=1 --over toy.value=2", "the key is given twice"},
      {"--over toy.valve=1", "toy.valve"},
      {"--require x", "METRIC<=NUMBER"},
      {"--relax dcache", "it needs --binds"},
      {"--binds frame.remap_time.mean --relax dcach", "--relax 'dcach': allowed here: "},
      {"--binds frame.remap", "a run has no figure of this name"},
      {"--binds camera.9", "no figure of this name"},
      {"--binds frame.nothing", "no figure other than 0"},
      {"--binds frame.dropped", "no figure other than 0"},
      {"--ports nowhere", "allowed: all, or some of load, other"},
      {"--priorities 8", "allowed: 0 to 7"},
      {"--load-step 0", "a step above 0"},
      {"--load-bytes 12", "--load-bytes '12': allowed: 4, 8, 16, 32 or 64"},
      {"-j 0", "--jobs"},
      {"-s toy.limits=3", "did you mean 'toy.limit'?"},
  };
  std::size_t number = 0;
  for (const auto& [arguments, text] : cases) {
    const std::string folder = fmt::format("wrong{}", number++);
    const Done d = limits(arguments, folder);
    EXPECT_EQ(d.status, 2) << arguments;
    EXPECT_THAT(d.err + d.out, HasSubstr(text)) << arguments;
    // Which figures there are shows in a run only; the rest is said before a folder is made.
    EXPECT_EQ(std::filesystem::exists(dir_ / folder),
              std::string_view(text).find("no figure") != std::string_view::npos)
        << arguments;
  }
  dir_.write("other/file.txt", "mine");
  const Done d = limits("--over toy.value=1", "other");
  EXPECT_EQ(d.status, 2);
  EXPECT_THAT(d.err, HasSubstr("it holds something else than points of Fovea"));
  EXPECT_EQ(read_text(dir_ / "other/file.txt"), "mine");
}

TEST_F(LimitsTest, CtrlCStopsItsChildrenAndKeepsWhatIsFinished) {
  // The first value ends at once, the others only when they are told to.
  points::Child child(command("--over toy.value=0,1,2 -s toy.mode=slow -j 2"), dir_ / "out.txt", dir_ / "err.txt");
  while (runs() < 3) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  {
    const Done other = [&] {
      points::Child second(command("--over toy.value=0"), dir_ / "out2.txt", dir_ / "err2.txt");
      while (!second.ended()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      return Done{second.ended()->status, "", read_text(dir_ / "err2.txt")};
    }();
    EXPECT_EQ(other.status, 2);
    EXPECT_THAT(other.err, HasSubstr("another program is running points in it now"));
  }
  child.ask_to_end();
  const Done d = wait(child);
  EXPECT_EQ(d.status, 143);
  EXPECT_THAT(d.err, HasSubstr("stopped; 1 point is finished, and the same command goes on"));
  std::size_t folders = 0;
  for (const auto& p : std::filesystem::directory_iterator(dir_ / "L" / "points")) {
    EXPECT_NE(p.path().extension(), ".tmp");
    ++folders;
  }
  EXPECT_EQ(folders, 1u);
  // The same question again, with a board that does not wait.
  const std::size_t before = runs();
  const Done again = limits("--over toy.value=0 -s toy.mode=slow");
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(runs(), before);
}

}  // namespace
}  // namespace fovea::limits
