// The data of a report's charts: frames, bandwidth, stacks.
#include "sw/fovea/report/chart_data.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "model/common/masters.h"
#include "model/cpu/core/stalls.h"
#include "tb/report/folder.h"

namespace fovea::report {
namespace {

using nlohmann::json;
using test::HandMade;
using test::TempDir;
using test::two_frames;
using ::testing::ElementsAre;

// Which culprit is shown in which group is said here once more, by hand.
TEST(WordsTest, EachCauseCulpritAndMasterHasItsWordsAndItsColour) {
  const json words = words_json();
  for (const cpu::CauseInfo& cause : cpu::kCauseTable) EXPECT_TRUE(words["causes"].contains(cause.name)) << cause.name;
  EXPECT_EQ(words["causes"].size(), cpu::kCauseTable.size() + 2);  // and of `issue` and `idle`
  std::map<std::string, std::set<std::string>> members;
  for (const auto& [culprit, group] : words["group_of"].items()) {
    EXPECT_TRUE(words["groups"].contains(std::string(group))) << culprit;
    members[group].insert(culprit);
  }
  using Names = std::set<std::string>;
  EXPECT_EQ(members["way"], Names{"service"});
  EXPECT_EQ(members["bridge"], Names{"bridge"});
  EXPECT_EQ(members["rows"], (Names{"power_down", "refresh", "row_conflict", "row_miss", "turnaround"}));
  EXPECT_EQ(members["video"], (Names{"vpbe", "vpfe"}));
  EXPECT_EQ(members["itself"], (Names{"arm_d", "arm_i", "core", "own"}));
  EXPECT_EQ(members["other"], (Names{"load", "not_known"}));
  EXPECT_TRUE(members["copying"].contains("remap_engine") && members["copying"].contains("edma_tc3"));
  std::map<unsigned, std::string> by_colour;
  for (const MasterInfo& m : kMasters.rows) {
    const unsigned colour = words["colours"].at(std::string(m.statistics));
    const auto [at, first] = by_colour.emplace(colour, m.statistics);
    EXPECT_TRUE(first || at->second == m.statistics) << m.statistics << " looks like " << at->second;
  }
}

TEST(FramesTest, AreThoseOfTheFileUpToTwoThousand) {
  const TempDir dir;
  const HandMade run = two_frames();
  const auto frames = [&](std::size_t rows) {
    std::string text =
        "frame,camera,captured_frame,capture_start_ns,capture_end_ns,remap_start_ns,remap_end_ns,"
        "display_start_ns,display_end_ns,dropped,repeated\n"
        "7,1,9,1000000.000,2000000.000,3000000.000,4000000.000,5000000.000,6500000.000,2,1\n";
    for (std::size_t n = 1; n < rows; ++n) text += "8,,,,,,,7000000.000,8500000.000,0,0\n";
    run.write(dir);
    dir.write("run/frames.csv", text);
    return json(chart_data(load_results(dir / "run", {}), "")["frames"]);
  };
  EXPECT_EQ(frames(2), json::parse(R"([
      {"frame": 7, "camera": 1, "captured": 9, "capture": [1.0, 2.0], "remap": [3.0, 4.0], "display": [5.0, 6.5],
       "dropped": 2, "repeated": true},
      {"frame": 8, "camera": null, "captured": null, "capture": [null, null], "remap": [null, null],
       "display": [7.0, 8.5], "dropped": 0, "repeated": false}])"));
  EXPECT_EQ(frames(2000).size(), 2000u);
  EXPECT_EQ(frames(2001).size(), 2000u);
}

// The detailed view begins with the first capture, remap or display of the first frames and ends with their last.
TEST(FramesTest, TheDetailedViewIsOfTheFirstFrames) {
  const TempDir dir;
  two_frames().write(dir);
  std::string frames =
      "frame,camera,captured_frame,capture_start_ns,capture_end_ns,remap_start_ns,remap_end_ns,"
      "display_start_ns,display_end_ns,dropped,repeated\n"
      "0,0,0,2000000.000,3000000.000,3000000.000,4000000.000,4000000.000,5000000.000,0,0\n"
      "1,0,,,,,,6000000.000,7000000.000,0,1\n",
              timeline = "start_ns,end_ns,vpfe.read_bytes,vpfe.write_bytes\n";
  for (int ms = 0; ms < 10; ++ms) timeline += fmt::format("{0}000000.000,{1}000000.000,0,{0}\n", ms, ms + 1);
  dir.write("run/frames.csv", frames);
  dir.write("run/timeline.csv", timeline);
  const auto data = chart_data(load_results(dir / "run", {}), "")["timeline"];
  // Of whole frames: their displays begin at 4 and 6 ms.
  EXPECT_EQ(json(data["whole"]["edges_ms"]), json::parse("[0.0, 2.0, 4.0, 6.0, 8.0, 10.0]"));
  EXPECT_EQ(json(data["detail"]["edges_ms"]), json::parse("[2.0, 3.0, 4.0, 5.0, 6.0, 7.0]"));
}

Timeline timeline(std::size_t rows) {
  Timeline t{{"a", "idle"}, {}};
  for (std::size_t i = 0; i < rows; ++i)
    t.rows.push_back({i * kPsPerMs, (i + 1) * kPsPerMs, {10 * (i + 1), 0}, {1, 0}});
  return t;
}

TEST(BandwidthTest, JoinsRowsOnlyIfThereAreTooMany) {
  const auto four = bandwidth(timeline(4), 0, 4 * kPsPerMs, 4);
  EXPECT_THAT(four.edges, ElementsAre(0, kPsPerMs, 2 * kPsPerMs, 3 * kPsPerMs, 4 * kPsPerMs));
  EXPECT_THAT(four.rates[0], ElementsAre(11e3, 21e3, 31e3, 41e3));
  const auto five = bandwidth(timeline(5), 0, 5 * kPsPerMs, 4);
  EXPECT_THAT(five.edges, ElementsAre(0, 2 * kPsPerMs, 4 * kPsPerMs, 5 * kPsPerMs));
  EXPECT_THAT(five.rates[0], ElementsAre(16e3, 36e3, 51e3));
}

TEST(BandwidthTest, KeepsBytesAndLeavesSilentMastersOut) {
  for (std::size_t most = 1; most < 30; ++most) {
    const auto b = bandwidth(timeline(23), 0, 23 * kPsPerMs, most);
    ASSERT_LE(b.edges.size(), most + 1);
    EXPECT_THAT(b.masters, ElementsAre("a"));
    double bytes = 0;
    for (std::size_t i = 0; i < b.rates[0].size(); ++i)
      bytes += b.rates[0][i] * 1e-12 * static_cast<double>(b.edges[i + 1] - b.edges[i]);
    EXPECT_NEAR(bytes, 10.0 * 23 * 24 / 2 + 23, 1e-6) << most;
  }
}

TEST(BandwidthTest, TakesRowsThatOverlapTheSpan) {
  const auto b = bandwidth(timeline(10), 2 * kPsPerMs, 4 * kPsPerMs, 100);
  EXPECT_THAT(b.edges, ElementsAre(2 * kPsPerMs, 3 * kPsPerMs, 4 * kPsPerMs));
  EXPECT_TRUE(bandwidth(timeline(10), 20 * kPsPerMs, 30 * kPsPerMs, 100).edges.empty());
}

/// Pulses of 3 ms that begin 5 ms into each frame of `period` us, 1000 bytes a ms, in rows of 1 ms.
Timeline pulses(std::uint64_t period_us, std::uint64_t rows) {
  Timeline t{{"a"}, {}};
  for (std::uint64_t ms = 0; ms < rows; ++ms) {
    std::uint64_t bytes = 0;
    for (std::uint64_t us = 0; us < 1000; ++us) bytes += (ms * 1000 + us + period_us - 5000) % period_us < 3000;
    t.rows.push_back({ms * kPsPerMs, (ms + 1) * kPsPerMs, {bytes}, {0}});
  }
  return t;
}

// 3000 bytes in each frame, whose periods are no whole number of rows: what one row more or less holds is a
// thirtieth. Intervals of 4 rows differ by all and nothing.
TEST(BandwidthTest, EqualFramesLookEqual) {
  constexpr std::uint64_t kFrame = 33'367;
  const Timeline t = pulses(kFrame, 1000);
  const Periods p = periods(0, 1000 * kPsPerMs, {kFrame * kPsPerUs, kFrame * kPsPerUs}, 360);
  EXPECT_EQ(p.frames_each, 1u);
  const Bandwidth b = mean_bandwidth(t, p);
  ASSERT_EQ(b.rates[0].size(), 29u);
  const double mean = 3000 / (kFrame * 1e-6);
  for (const double rate : b.rates[0]) EXPECT_NEAR(rate, mean, mean / 30);
  const Bandwidth rows = bandwidth(t, 0, 1000 * kPsPerMs, 250);
  EXPECT_EQ(*std::min_element(rows.rates[0].begin(), rows.rates[0].end()), 0.0);
  EXPECT_GT(*std::max_element(rows.rates[0].begin(), rows.rates[0].end()), 5 * mean);
}

TEST(BandwidthTest, ManyFramesAreJoinedToWholeOnes) {
  for (const auto& [most, each] : {std::pair{360u, 1u}, {26u, 1u}, {25u, 2u}, {13u, 2u}, {12u, 3u}}) {
    const Periods p = periods(3, 1000, {123, 40}, most);  // 24 periods fit, 26 may be touched
    EXPECT_EQ(p.frames_each, each) << most;
    ASSERT_GT(p.edges.size(), 1u);
    EXPECT_LE(p.edges.size() - 1, most);
    EXPECT_GE(p.edges.front(), 3u);
    EXPECT_LE(p.edges.back(), 1000u);
    for (std::size_t i = 0; i < p.edges.size(); ++i) {
      EXPECT_EQ((p.edges[i] + 40 * each - 123 % (40 * each)) % (40 * each), 0u);
      if (i == 0) continue;
      EXPECT_EQ(p.edges[i] - p.edges[i - 1], 40 * each);
    }
  }
  EXPECT_EQ(periods(200, 1000, {123, 40}, 100).edges.front(), 203u);
  EXPECT_TRUE(periods(10, 10, {123, 40}, 100).edges.empty());
}

TEST(BandwidthTest, ARowInTwoIntervalsIsShared) {
  Timeline t{{"a"}, {{0, 10, {100}, {0}}, {10, 20, {0}, {50}}}};
  const Bandwidth b = mean_bandwidth(t, {.edges = {0, 4, 16, 20}});
  EXPECT_THAT(b.rates[0], ElementsAre(40 / 4e-12, 90 / 12e-12, 20 / 4e-12));
}

TEST(FramePeriodTest, IsTheMeanFromTheFirstToTheLastDisplay) {
  EXPECT_FALSE(frame_period({}));
  std::vector<video::FrameTimes> frames(3);
  EXPECT_FALSE(frame_period(frames));
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i].index = 10 + 2 * i;
  for (video::FrameTimes& f : frames) f.display_start = 1000;
  EXPECT_FALSE(frame_period(frames));
  EXPECT_FALSE(frame_period({frames.front()}));
  frames[2].display_start = 1402;
  const auto p = frame_period(frames);
  ASSERT_TRUE(p);
  EXPECT_EQ(p->anchor, 1000u);
  EXPECT_EQ(p->length, 100u);
}

TEST(StackTreeTest, SumsChildrenAndJoinsTheSmallest) {
  const json tree = stack_tree({{"main", 4000}, {"main;remap", 5998}, {"tick", 1}, {"tock", 1}});
  EXPECT_EQ(tree["clocks"], 10000);
  EXPECT_EQ(tree["children"][0]["name"], "main");
  EXPECT_EQ(tree["children"][0]["clocks"], 9998);
  EXPECT_EQ(tree["children"][0]["children"][0]["clocks"], 5998);
  EXPECT_EQ(tree["children"][1]["name"], "(smaller ones)");
  EXPECT_EQ(tree["children"][1]["clocks"], 2);
  EXPECT_EQ(stack_tree({{"a", 9998}, {"b", 2}})["children"].size(), 2u);  // exactly 1/5000
}

}  // namespace
}  // namespace fovea::report
