// sw/fovea/explain: each rule on figures made by hand.
#include "sw/fovea/explain/explain.h"

#include "sw/fovea/explain/words.h"
#include "tb/report/folder.h"

namespace fovea::explain {
namespace {

using video::FrameTimes;
using app::StallRow;
using app::StatRow;
using ::testing::HasSubstr;
using ::testing::Not;

class ExplainTest : public ::testing::Test {
 protected:
  std::vector<StatRow> stats_ = test::two_frames().stats;
  std::vector<StallRow> stalls_;
  std::vector<FrameTimes> frames_;
  std::vector<FunctionClocks> functions_;
  std::map<std::string, std::string> parameters_;

  Inputs inputs() {
    return {.stats = stats_,
            .stalls = stalls_,
            .frames = frames_,
            .functions = functions_,
            .parameter = [this](std::string_view key) {
              const auto found = parameters_.find(std::string(key));
              return found == parameters_.end() ? std::string() : found->second;
            }};
  }
  void set(const std::string& name, StatBase::Value value) {
    for (auto& row : stats_)
      if (row.name == name) {
        row.value = value;
        return;
      }
    stats_.push_back({name, value, "", ""});
  }
  void remove(const std::string& name) {
    std::erase_if(stats_, [&](const StatRow& row) { return row.name == name; });
  }
  /// The text of a rule's finding; empty if it found nothing.
  std::string text(const std::string& rule) {
    for (const auto& f : explain(inputs()))
      if (f.rule == rule) return f.text;
    return "";
  }
};

TEST_F(ExplainTest, RateThatIsMet) {
  EXPECT_EQ(
      text("rate"),
      "The board keeps up with the camera: each of the 2 displayed frames shows a new picture.");
}

TEST_F(ExplainTest, RateThatIsMissed) {
  set("frame.repeated", std::uint64_t{1});
  EXPECT_EQ(text("rate"),
            "The board does not keep up with the camera: 1 of the 2 displayed frames shows an "
            "earlier picture again, and 0 captured frames were never shown.");
}

TEST_F(ExplainTest, DroppedFramesAloneMissTheRate) {
  set("frame.dropped", std::uint64_t{3});
  EXPECT_THAT(text("rate"), HasSubstr("does not keep up"));
  EXPECT_THAT(text("rate"), HasSubstr("3 captured frames were never shown"));
}

TEST_F(ExplainTest, OverflowsAndUnderflowsAreNamedOnlyIfThereAreAny) {
  set("capture.overflows", std::uint64_t{0});
  EXPECT_EQ(text("overflow"), "");
  set("capture.overflows", std::uint64_t{1});
  set("display.underflows", std::uint64_t{2});
  EXPECT_EQ(text("overflow"),
            "1 burst of captured data was lost, because the memory did not take it in time.");
  EXPECT_EQ(text("underflow"), "2 bursts of picture data came too late for the display.");
}

TEST_F(ExplainTest, BudgetIsTheRemapAgainstThePeriod) {
  EXPECT_EQ(text("budget"),
            "A remap takes 10.0 ms, and a frame comes every 40.0 ms: 25 % of the time is used "
            "and 30.0 ms are left.");
  set("frame.remap_time.mean", 0.050);
  EXPECT_EQ(text("budget"),
            "A remap takes 50.0 ms, and a frame comes every 40.0 ms: it is 10.0 ms too long for "
            "every frame.");
}

TEST_F(ExplainTest, ARemapOfAWholePeriodIsNotTooLong) {
  set("frame.remap_time.mean", 0.040);
  EXPECT_THAT(text("budget"), testing::EndsWith("100 % of the time is used and 0.0 us are left."));
}

TEST_F(ExplainTest, RemapsInARowHaveNoBudget) {
  set("frame.remapped", std::uint64_t{3});  // 3 for 2 new frames
  EXPECT_EQ(text("budget"), "");
}

TEST_F(ExplainTest, LatencyIsTheSumOfItsParts) {
  FrameTimes f;
  f.capture_start = 0;
  f.capture_end = 38 * kPsPerMs;
  f.remap_start = 39 * kPsPerMs;
  f.remap_end = 50 * kPsPerMs;
  f.display_start = 80 * kPsPerMs;
  frames_ = {f, f};
  frames_[1].repeated = true;  // does not count
  EXPECT_EQ(text("latency"),
            "From a frame's first captured sample to its first displayed one 80.0 ms pass on "
            "average: 38.0 ms of capture, 1.00 ms until the remap begins, 11.0 ms of remap, and "
            "30.0 ms until the display begins with it.");
  frames_[0].remap_start = 37 * kPsPerMs;  // overlaps the capture: no parts that add up
  EXPECT_EQ(text("latency"), "");
}

TEST_F(ExplainTest, WhoMovesThePixelsWhileTheCoreSleeps) {
  EXPECT_EQ(text("mover"), "");
  set("cpu.remap.cycles", std::uint64_t{1000});
  set("cpu.remap.idle", std::uint64_t{49});
  set("cpu.remap.idle.engine", std::uint64_t{20});
  EXPECT_EQ(text("mover"), "");
  set("cpu.remap.idle", std::uint64_t{50});  // others' interrupts ended 30 of these
  EXPECT_EQ(text("mover"), "In 5.0 % of the clocks of its remaps the core sleeps until the remap engine is done.");
  set("ddr.remap_engine.wait.read.own", 0.50);
  set("ddr.remap_engine.wait.write.own", 0.14);
  set("ddr.remap_engine.wait.read.bridge", 0.20);
  set("ddr.remap_engine.wait.read.arm_d", 0.05);
  set("ddr.remap_engine.wait.read.vpbe", 0.11);
  set("ddr.remap_engine.wait.read.row_miss", std::nan(""));
  set("ddr.arm_d.wait.read.own", 9.0);
  EXPECT_THAT(text("mover"),
              testing::EndsWith("The time of all requests that the remap engine made to the SDRAM in the whole window: "
                                "64 % behind other requests of its own, 20 % in its bridge to the crossbar and 11 % "
                                "while the display is served."));
  // A load at its port waits there too.
  parameters_ = {{"load.outstanding", "0"},
                 {"load.port", "remap_engine"},
                 {"load.1.outstanding", "2"},
                 {"load.1.port", "edma_tc0"}};
  EXPECT_THAT(text("mover"), HasSubstr("whole window"));
  parameters_["load.1.port"] = "remap_engine";
  EXPECT_EQ(text("mover"), "In 5.0 % of the clocks of its remaps the core sleeps until the remap engine is done.");
  // Sleeps that neither of them ended are no wait for them.
  remove("cpu.remap.idle.engine");
  EXPECT_EQ(text("mover"), "");
}

// What the ports of the EDMA wait for one another is its own.
TEST_F(ExplainTest, ThePortsOfTheEdmaAreOne) {
  set("cpu.remap.cycles", std::uint64_t{100});
  set("cpu.remap.idle", std::uint64_t{90});
  set("cpu.remap.idle.dma", std::uint64_t{1});
  set("ddr.edma_tc0.wait.read.edma_tc1", 0.4);
  set("ddr.edma_tc1.wait.write.own", 0.3);
  set("ddr.edma_tc2.wait.write.arm_d", 0.3);
  EXPECT_EQ(text("mover"),
            "In 90 % of the clocks of its remaps the core sleeps until the EDMA is done. The time of all requests "
            "that the EDMA made to the SDRAM in the whole window: 70 % behind other requests of its own and 30 % while "
            "the core is served.");
}

TEST_F(ExplainTest, TwoMoversAreBothNamed) {
  set("cpu.remap.cycles", std::uint64_t{100});
  set("cpu.remap.idle", std::uint64_t{90});
  set("cpu.remap.idle.dma", std::uint64_t{10});
  set("cpu.remap.idle.engine", std::uint64_t{80});
  EXPECT_EQ(text("mover"),
            "In 90 % of the clocks of its remaps the core sleeps until the EDMA or the remap engine is done.");
}

TEST_F(ExplainTest, ACoreThatSleepsIsSaidToSleep) {
  stalls_ = {{"dcache", "frame_in", "service", 500}};
  set("cpu.cycles", std::uint64_t{10'000});
  set("cpu.idle", std::uint64_t{9'000});
  EXPECT_THAT(text("largest_wait"), testing::StartsWith("Largest wait: in 50 %"));
  set("cpu.idle", std::uint64_t{9'001});
  EXPECT_THAT(text("largest_wait"),
              testing::StartsWith("The core is awake in only 10 % of its clocks. Largest wait: in 50 %"));
}

TEST_F(ExplainTest, LargestWaitHasItsShareCulpritsAndRegions) {
  stalls_ = {{"dcache", "frame_in", "service", 240},
             {"dcache", "lut", "bridge", 230},
             {"dcache", "x", "core", 30},
             {"interlock", "none", "core", 200}};
  EXPECT_EQ(text("largest_wait"),
            "Largest wait: in 50 % of the clocks in which it is awake, the core waits for D-cache "
            "line fills "
            "(48 % of that on its own way through crossbar and SDRAM controller and 40 % "
            "in the bridge "
            "between core and crossbar). By what is accessed: frame_in (48 %) and lut (46 %). It "
            "issues instructions "
            "in 30 %.");
}

// 240, 200 and 60 of 500: two culprits say where it goes.
TEST_F(ExplainTest, TheThirdCulpritIsLeftOut) {
  set("cpu.stall.dcache.by.vpbe", std::uint64_t{60});
  EXPECT_THAT(text("largest_wait"),
              AllOf(HasSubstr("40 % in the bridge between core and crossbar)"), Not(HasSubstr("display"))));
}

TEST_F(ExplainTest, AnotherLargestWaitIsFound) {
  set("cpu.stall.interlock", std::uint64_t{501});
  EXPECT_THAT(text("largest_wait"),
              HasSubstr("waits for results of earlier instructions (interlocks). It issues"));
}

TEST_F(ExplainTest, NamesTheFunctionAndItsWait) {
  functions_ = {{"remap", 1350, {{"issue", 250}, {"dcache", 500}, {"wait.dma", 600}}},
                {"main", 750, {{"idle.capture", 400}, {"wait.dma", 100}, {"issue", 250}}}};
  EXPECT_EQ(text("function"),
            "The function remap takes 75 % of the core's awake clocks, and waits in 67 % of these "
            "for D-cache line fills.");
}

TEST_F(ExplainTest, AFunctionsWaitIsNamedFromOnePercentOn) {
  functions_ = {{"f", 1000, {{"issue", 990}, {"dcache", 10}}}};
  EXPECT_EQ(text("function"),
            "The function f takes 100 % of the core's awake clocks, and waits in 1.0 % of these for D-cache "
            "line fills.");
  functions_ = {{"f", 1000, {{"issue", 991}, {"dcache", 9}}}};
  EXPECT_EQ(text("function"), "The function f takes 100 % of the core's awake clocks.");
}

TEST_F(ExplainTest, OtherMastersAreSummedOverTheirPorts) {
  set("cpu.stall.dcache.by.edma_tc0_read", std::uint64_t{15});
  set("cpu.stall.dcache.by.edma_tc1_write", std::uint64_t{30});
  set("cpu.stall.dcache.by.arm_d", std::uint64_t{100});
  EXPECT_EQ(text("other_masters"),
            "Waiting while other masters are served adds 8.5 % to the core's awake clocks: the "
            "EDMA 4.5 % and the "
            "display 4.0 %.");
}

TEST_F(ExplainTest, RowsHaveSharesThatAddUp) {
  EXPECT_EQ(
      text("rows"),
      "80 % of the requests to the SDRAM find their row open, 5.0 % find another row open, 15 % a "
      "closed bank. Waiting until rows are opened takes 2.0 % of the core's awake clocks.");
}

// What a change would save, only a run with the change shows.
TEST_F(ExplainTest, NothingIsSaidAboutRunsThatWereNotMade) {
  parameters_ = {{"bus.arm_d.request_latency", "3 cycles"},
                 {"bus.arm_d.response_latency", "5 cycles"},
                 {"clocks.preset", "297/243"}};
  stalls_ = {{"dcache", "lut", "service", 500}};
  ASSERT_FALSE(explain(inputs()).empty());
  for (const auto& f : explain(inputs()))
    EXPECT_THAT(f.text, AllOf(Not(HasSubstr("would save")), Not(HasSubstr("would take")), Not(HasSubstr("Estimate"))));
}

TEST_F(ExplainTest, UseAloneNeverSaysWhatBinds) {
  set("ddr.utilisation", 0.999);
  for (const auto& f : explain(inputs())) {
    EXPECT_THAT(f.text, Not(HasSubstr("bind"))) << f.rule;
    EXPECT_THAT(f.text, Not(HasSubstr("bottleneck"))) << f.rule;
    EXPECT_FALSE(f.evidence.empty()) << f.rule;
  }
}

TEST_F(ExplainTest, NothingIsSaidAboutNothing) {
  stats_.clear();
  EXPECT_TRUE(explain(inputs()).empty());
}

TEST_F(ExplainTest, DifferenceNamesRemapAndLargestCause) {
  const std::vector<StatRow> before = stats_;
  set("frame.remap_time.mean", 0.008);
  set("cpu.stall.dcache", std::uint64_t{20'500});
  const Inputs a{.stats = before, .stalls = {}, .frames = {}};
  const auto found = explain_difference(a, "A", inputs(), "B");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].text, "The remap of B takes 8.00 ms instead of the 10.0 ms of A: 20 % less.");
  EXPECT_EQ(found[1].text,
            "The largest difference in the core's clocks for each corrected frame: B spends 10 "
            "thousand clocks more on waiting for D-cache line fills.");
}

TEST_F(ExplainTest, EqualTimesOfInstructionsAreNoDifferenceHoweverLong) {
  set("cpu.issue", std::uint64_t{1'000'000'000});
  const std::vector<StatRow> before = stats_;
  set("frame.remap_time.mean", 0.008);
  set("cpu.stall.dcache", std::uint64_t{20'500});
  const auto found = explain_difference({.stats = before, .stalls = {}, .frames = {}}, "A", inputs(), "B");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NE(found[1].text.find("waiting for D-cache line fills"), std::string::npos) << found[1].text;
}

// From a thousandth of the remap on, and from a thousand clocks of a frame on.
TEST_F(ExplainTest, SmallDifferencesAreNotMentioned) {
  const std::vector<StatRow> before = stats_;
  const auto found = [&] {
    return explain_difference({.stats = before, .stalls = {}, .frames = {}}, "A", inputs(), "B");
  };
  set("frame.remap_time.mean", 0.010009);
  EXPECT_THAT(found()[0].text, HasSubstr("takes as long as"));
  set("frame.remap_time.mean", 0.010011);
  EXPECT_EQ(found()[0].text, "The remap of B takes 10.0 ms instead of the 10.0 ms of A: 0.1 % more.");
  set("cpu.stall.dcache", std::uint64_t{2'498});
  EXPECT_EQ(found().size(), 1u);
  set("cpu.stall.dcache", std::uint64_t{2'500});
  ASSERT_EQ(found().size(), 2u);
  EXPECT_THAT(found()[1].text, HasSubstr("B spends 1 thousand clocks more on waiting for D-cache line fills."));
}

TEST_F(ExplainTest, EqualRunsDoNotDiffer) {
  const auto found = explain_difference(inputs(), "A", inputs(), "B");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].text, "The remap of B takes as long as that of A: 10.0 ms.");
}

TEST(WordsTest, SleepsSayForWhom) {
  EXPECT_EQ(waits_or_sleeps_for("dcache"), "D-cache line fills");
  EXPECT_EQ(waits_or_sleeps_for("idle.display"), "the display's interrupt, asleep");
  EXPECT_EQ(waits_or_sleeps_for("idle"), "an interrupt, asleep");
  EXPECT_EQ(waits_or_sleeps_for("idle.dma"), "the EDMA");
  EXPECT_EQ(waits_or_sleeps_for("wait.engine"), "the remap engine");
  EXPECT_EQ(waits_or_sleeps_for("wait.display"), "the EDMA or the remap engine");
  EXPECT_EQ(waits_or_sleeps_for("wait.dma_or_engine"), "the EDMA or the remap engine");
}

TEST(WordsTest, PercentAndTimesKeepThreeDigits) {
  EXPECT_EQ(percent(0), "0.0 %");
  EXPECT_EQ(percent(0.0009), "less than 0.1 %");
  EXPECT_EQ(percent(0.001), "0.1 %");
  EXPECT_EQ(percent(0.0994), "9.9 %");
  EXPECT_EQ(percent(0.0995), "10 %");
  EXPECT_EQ(percent(7.12), "712 %");
  EXPECT_EQ(milliseconds(0.0287), "28.7 ms");
  EXPECT_EQ(milliseconds(0.00322), "3.22 ms");
  EXPECT_EQ(milliseconds(0.0000685), "68.5 us");
}

}  // namespace
}  // namespace fovea::explain
