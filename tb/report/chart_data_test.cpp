// The data of a report's charts: frames, bandwidth, stacks.
#include "sw/fovea/report/chart_data.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tb/report/folder.h"

namespace fovea::report {
namespace {

using nlohmann::json;
using test::HandMade;
using test::TempDir;
using test::two_frames;
using ::testing::ElementsAre;

TEST(FramesTest, AreThoseOfTheFileUpToTwoThousand) {
  const TempDir dir;
  const HandMade run = two_frames();
  const auto frames = [&](std::size_t rows) {
    std::string text =
        "frame,camera,captured_frame,capture_start_ns,capture_end_ns,remap_start_ns,remap_end_ns,"
        "display_start_ns,display_end_ns,dropped,repeated\n"
        "7,1,9,1000000.000,2000000.000,3000000.000,4000000.000,5000000.000,6500000.000,2,1\n";
    for (std::size_t n = 1; n < rows; ++n) text += "8,0,,,,,,,,0,0\n";
    run.write(dir);
    dir.write("run/frames.csv", text);
    return json(chart_data(load_results(dir / "run", {}), "")["frames"]);
  };
  EXPECT_EQ(frames(2), json::parse(R"([
      {"frame": 7, "camera": 1, "captured": 9, "capture": [1.0, 2.0], "remap": [3.0, 4.0], "display": [5.0, 6.5],
       "dropped": 2, "repeated": true},
      {"frame": 8, "camera": 0, "captured": null, "capture": [null, null], "remap": [null, null],
       "display": [null, null], "dropped": 0, "repeated": false}])"));
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
  EXPECT_EQ(data["whole"]["edges_ms"].size(), 11u);
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
