// sw/fovea/results/outputs.h: contents of the text files of a run, byte by byte where tools depend on them.
#include "sw/fovea/explain/last_words.h"
#include "sw/fovea/results/outputs.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "sw/fovea/machine/progress.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(NumberTextTest, IsShortestAndReadsBackAsTheSameDouble) {
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(25.0), "25.0");
  EXPECT_EQ(number_text(30000.0 / 1001.0), "29.97002997002997");
  EXPECT_EQ(number_text(5e-324), "5e-324");
  EXPECT_EQ(number_text(-0.0), "0.0");
  for (const double v : {1.0 / 3, 1e22, 123456789.123456789, -2.5e-9})
    EXPECT_EQ(json::parse(number_text(v)).get<double>(), v);
}

TEST(NumberTextTest, CountsStayIntegersUpToTheLargest) {
  EXPECT_EQ(number_text(StatBase::Value{~std::uint64_t{0}}), "18446744073709551615");
}

TEST(NumberTextTest, NotANumberBecomesNull) {
  EXPECT_EQ(number_text(std::nan("")), "null");
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "null");
}

TEST(NsTextTest, KeepsEveryPicosecond) {
  EXPECT_EQ(ns_text(0), "0.000");
  EXPECT_EQ(ns_text(1), "0.001");
  EXPECT_EQ(ns_text(40'000'000'123'456), "40000000123.456");
}

std::vector<StatRow> some_rows() {
  return {{"frame.rate", 25.0, "1/s", "new frames"},
          {"cpu.cycles", std::uint64_t{297}, "cycles", "a \"quoted\" \xff sentence"}};
}

TEST(StatsJsonTest, HoldsValueUnitAndSentenceUnderTheName) {
  const auto j = json::parse(stats_json(some_rows(), true));
  EXPECT_EQ(j["complete"], true);
  EXPECT_EQ(j["band"], "not run");
  EXPECT_EQ(j["frame.rate"]["value"], 25.0);
  EXPECT_TRUE(j["frame.rate"]["value"].is_number_float());
  EXPECT_TRUE(j["cpu.cycles"]["value"].is_number_unsigned());
  EXPECT_EQ(j["frame.rate"]["unit"], "1/s");
  EXPECT_EQ(j["frame.rate"]["description"], "new frames");
}

TEST(StatsJsonTest, OrderOfRowsDoesNotShow) {
  auto rows = some_rows();
  const std::string a = stats_json(rows, true);
  std::swap(rows[0], rows[1]);
  EXPECT_EQ(stats_json(rows, true), a);
  EXPECT_LT(a.find("cpu.cycles"), a.find("frame.rate"));
}

TEST(StatsJsonTest, AMeanOfNothingIsNullAndStillJson) {
  const auto j = json::parse(stats_json({{"x", std::nan(""), "s", ""}}, false));
  EXPECT_TRUE(j["x"]["value"].is_null());
  EXPECT_EQ(j["complete"], false);
}

TEST(StatsJsonTest, ListsWarningsWithTheirKindsAndCounts) {
  Diagnostics d;
  d.guest("odd write");
  d.guest("odd write");
  d.not_modelled("field X");
  d.configuration("key without effect");
  const auto j = json::parse(stats_json({}, true, collect_warnings(d)));
  const auto replay = json::parse(stats_json({}, true, collect_warnings(d, true)));
  d.clear();
  ASSERT_EQ(j["warnings"].size(), 3u);
  EXPECT_EQ(j["warnings"][0]["kind"], "firmware");
  EXPECT_EQ(replay["warnings"][0]["kind"], "configuration") << "no program runs in a replay";
  EXPECT_EQ(j["warnings"][2]["kind"], "configuration");
  EXPECT_EQ(j["warnings"][0]["what"], "odd write");
  EXPECT_EQ(j["warnings"][0]["count"], 2);
  EXPECT_EQ(j["warnings"][1]["kind"], "model");
}

TEST(StatsJsonTest, HasOneLineForEachStatisticAndEachWarning) {
  EXPECT_EQ(stats_json(some_rows(), true, {{"model", "a [{b}]\n", 2}},
                       {.ended_by = "frames", .kernel = "staged"}),
            "{\n"
            "  \"complete\": true,\n"
            "  \"band\": \"not run\",\n"
            "  \"ended_by\": \"frames\",\n"
            "  \"kernel\": \"staged\",\n"
            "  \"warnings\": [\n"
            "    {\"kind\": \"model\", \"what\": \"a [{b}]\\n\", \"count\": 2}\n"
            "  ],\n"
            "  \"cpu.cycles\": {\"value\": 297, \"unit\": \"cycles\", "
            "\"description\": \"a \\\"quoted\\\" \uFFFD sentence\"},\n"
            "  \"frame.rate\": {\"value\": 25.0, \"unit\": \"1/s\", "
            "\"description\": \"new frames\"}\n"
            "}\n");
}

TEST(StatsJsonDeathTest, OneNameTwiceIsADefect) {
  EXPECT_EXIT(stats_json({{"x", 1.0, "", ""}, {"x", 2.0, "", ""}}, true),
              testing::ExitedWithCode(4), "called x");
}

TEST(CollectTest, TakesNamesAndValuesFromTheGroup) {
  struct Group : StatGroup {
    Group() : StatGroup("g") {}
    Counter n{*this, "n", "count", "things"};
  } group;
  group.n += 5;
  std::vector<StatRow> rows;
  collect(group, rows);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].name, "g.n");
  EXPECT_EQ(rows[0].value, StatBase::Value{std::uint64_t{5}});
  EXPECT_EQ(find(rows, "g.m"), nullptr);
}

TEST(ConfigJsonTest, ShowsValueOriginAndTag) {
  struct Group : ParamGroup {
    Group() : ParamGroup("ddr") {}
    IntParam tRCD{*this,  "tRCD",      IntParam::Unit::kTime, 15'000,       5'000,
                  60'000, "ACT to RD", Origin::kSourced,      "[DDR2] p. 1"};
    IntParam depth{*this, "depth",   IntParam::Unit::kCount, 4,  1,
                   16,    "entries", Origin::kAssumed,       "", {"3", "8", "as others"}};
  } group;
  ParamSet params;
  params.add(group);
  Experiment experiment(params);
  test::TempDir dir;
  const auto file = dir.write("e.yaml", "ddr.depth: 8\n");
  experiment.load(file);
  const auto j = json::parse(config_json(params, experiment, {.version = "1.2.3"}));
  EXPECT_EQ(j["version"], "1.2.3");
  EXPECT_EQ(j["experiment"], "e");
  EXPECT_EQ(j["params"]["ddr.tRCD"]["value"], "15ns");
  EXPECT_EQ(j["params"]["ddr.tRCD"]["origin"], "default");
  EXPECT_EQ(j["params"]["ddr.tRCD"]["tag"], "sourced");
  EXPECT_EQ(j["params"]["ddr.tRCD"]["source"], "[DDR2] p. 1");
  EXPECT_EQ(j["params"]["ddr.depth"]["value"], "8");
  EXPECT_EQ(j["params"]["ddr.depth"]["default"], "4");
  EXPECT_EQ(j["params"]["ddr.depth"]["origin"], file.string() + ":1");
  EXPECT_EQ(j["params"]["ddr.depth"]["allowed"], "1 .. 16");
  EXPECT_EQ(j["params"]["ddr.depth"]["tag"], "assumed");
  EXPECT_EQ(j["params"]["ddr.depth"]["belief"],
            json::parse(R"({"low": "3", "high": "8", "reason": "as others"})"));
  EXPECT_TRUE(j["params"]["ddr.tRCD"]["belief"].is_null());
  EXPECT_FALSE(j.contains("command")) << "the experiment says what ran";
  const auto program = json::parse(config_json(
      params, experiment, {.command = "exec", .input = "a.elf", .arguments = {"1"}, .options = {"--board"}}));
  EXPECT_EQ(program["command"], "exec");
  EXPECT_EQ(program["input"], "a.elf");
  EXPECT_EQ(program["arguments"], json::parse(R"(["1"])"));
  EXPECT_EQ(program["options"], json::parse(R"(["--board"])"));
}

TEST(FramesCsvTest, UnknownTimesAreEmptyCells) {
  video::FrameTimes a;
  a.index = 3;
  a.camera = 1;
  a.captured = 7;
  a.capture_start = 1'500;
  a.display_start = 40'000'000;
  a.display_end = 78'400'000;
  a.dropped = 2;
  a.repeated = true;
  const std::vector<video::FrameTimes> rows{a};
  const std::string csv = frames_csv(rows);
  EXPECT_EQ(csv.substr(csv.find('\n') + 1), "3,1,7,1.500,,,,40000.000,78400.000,2,1,,\n") << "shown again";
  const std::string header = csv.substr(0, csv.find('\n'));
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), 12);
}

TEST(FramesCsvTest, DurationsAreThoseOfTheFigures) {
  video::FrameTimes row;
  row.captured = 7;
  row.capture_start = 1'500;
  row.remap_start = 20'000;
  row.remap_end = 30'001;
  row.display_start = 40'000;
  EXPECT_THAT(frames_csv_line(row), testing::EndsWith(",0,0,10.001,38.500\n"));
  row.capture_start.reset();
  EXPECT_THAT(frames_csv_line(row), testing::EndsWith(",0,0,10.001,\n"));
}

TEST(TimelineCsvTest, HasAPairOfColumnsPerMaster) {
  const std::vector<std::string> masters{"arm_d", "vpfe"};
  const std::vector<TimelineRow> rows{{0, kPsPerMs, {1, 0}, {2, 64}}};
  EXPECT_EQ(timeline_csv(masters, rows),
            "start_ns,end_ns,arm_d.read_bytes,arm_d.write_bytes,vpfe.read_bytes,vpfe.write_bytes\n"
            "0.000,1000000.000,1,2,0,64\n");
}

TEST(TimelineCsvDeathTest, RowOfAnotherWidthIsADefect) {
  const std::vector<std::string> masters{"arm_d"};
  const std::vector<TimelineRow> rows{{0, 1, {1, 2}, {1, 2}}};
  EXPECT_EXIT(timeline_csv(masters, rows), testing::ExitedWithCode(4), "timeline");
}

TEST(StallsCsvTest, NamesAreQuotedWhereTheyMustBe) {
  const std::vector<StallRow> rows{{"dcache", "a,b", "vpbe", 3}};
  EXPECT_EQ(stalls_csv(rows), "cause,region,culprit,cycles\ndcache,\"a,b\",vpbe,3\n");
}

TEST(LatencyCsvTest, HasALineForEachBin) {
  const std::vector<LatencyRow> rows{{"arm_d", "read", "first", 144'000, 152'000, 7},
                                     {"a,b", "write", "last", 1, 2, 1}};
  EXPECT_EQ(latency_csv(rows),
            "master,direction,beat,low_ns,high_ns,count\narm_d,read,first,144.000,152.000,7\n"
            "\"a,b\",write,last,0.001,0.002,1\n");
}

TEST(HumanTextTest, PicksAFittingPrefix) {
  EXPECT_EQ(human_text(0.0402, "s"), "40.2 ms");
  EXPECT_EQ(human_text(1.5, "s"), "1.5 s");
  EXPECT_EQ(human_text(123.0, "s"), "123 s") << "no kiloseconds";
  EXPECT_EQ(human_text(std::uint64_t{165'888'000}, "bytes"), "165.9 MB");
  EXPECT_EQ(human_text(std::uint64_t{0}, "bytes"), "0 bytes");
  EXPECT_EQ(human_text(std::uint64_t{999}, "bytes"), "999 B");
  EXPECT_EQ(human_text(std::uint64_t{1000}, "bytes"), "1 kB");
  EXPECT_EQ(human_text(0.001, "s"), "1 ms");
  EXPECT_EQ(human_text(0.000999, "s"), "999 us");
  EXPECT_EQ(human_text(0.337, "ratio"), "33.7 %");
  EXPECT_EQ(human_text(0.934, "x"), "0.93x real time");
  EXPECT_EQ(human_text(std::uint64_t{25}, "1"), "25");
  EXPECT_EQ(human_text(25.0, "1/s"), "25 a second");
  EXPECT_EQ(human_text(std::uint64_t{26}, "count"), "26");
  EXPECT_EQ(human_text(std::nan(""), "s"), "-");
}

std::vector<StatRow> frames_of(double rate, std::uint64_t displayed, std::uint64_t repeated,
                               std::uint64_t dropped, std::uint64_t overflows = 0,
                               std::uint64_t underflows = 0) {
  return {{"frame.rate", rate, "1/s", ""},           {"frame.displayed", displayed, "1", ""},
          {"frame.repeated", repeated, "1", ""},     {"frame.dropped", dropped, "1", ""},
          {"capture.overflows", overflows, "1", ""}, {"display.underflows", underflows, "1", ""}};
}

TEST(VerdictTest, OfSeveralCamerasARepeatedFrameIsNoFault) {
  auto stats = frames_of(12.5, 16, 8, 1);
  stats.push_back({"camera.0.frame.rate", 6.25, "1/s", ""});
  stats.push_back({"camera.1.frame.rate", 6.25, "1/s", ""});
  stats.push_back({"camera.1.frame.displayed", std::uint64_t{4}, "1", ""});
  EXPECT_EQ(verdict(stats),
            "several cameras in turn: 8 new frames in 16 displayed ones (12.5 a second), 1 dropped\n");
  stats.push_back({"camera.1.frame.superseded", std::uint64_t{2}, "1", ""});
  auto silent = stats;
  silent.push_back({"camera.2.frame.rate", 0.0, "1/s", ""});
  EXPECT_THAT(run_words(silent, {}), HasSubstr("superseded; camera 2 no frame\n"));
  EXPECT_THAT(
      run_words(stats, {}),
      HasSubstr("cameras camera 0 6.25 frames a second; camera 1 6.25 frames a second, 2\n        superseded\n"));
}

TEST(FramesCsvTest, AFrameOfNoCameraHasAnEmptyCell) {
  video::FrameTimes row;
  row.index = 3;
  row.camera = 2;
  EXPECT_TRUE(frames_csv_line(row).starts_with("3,2,,"));
  row.camera = video::kNoCamera;
  EXPECT_TRUE(frames_csv_line(row).starts_with("3,,,"));
}

TEST(VerdictTest, SaysWhetherTheRateWasMet) {
  EXPECT_EQ(verdict(frames_of(25, 25, 0, 0)),
            "frame rate met: 25 of 25 frames shown (25 a second), none dropped, none repeated\n");
  EXPECT_EQ(
      verdict(frames_of(30000.0 / 1001, 25, 0, 0)),
      "frame rate met: 25 of 25 frames shown (29.97 a second), none dropped, none repeated\n");
  EXPECT_EQ(verdict(frames_of(12.5, 16, 8, 0)),
            "frame rate missed: 8 of 16 frames shown (12.5 a second), none dropped, 8 repeated\n");
  EXPECT_EQ(verdict(frames_of(24, 25, 0, 1)),
            "frame rate missed: 25 of 25 frames shown (24 a second), 1 dropped, none repeated\n");
  EXPECT_EQ(verdict(frames_of(25, 25, 1, 0)),
            "frame rate missed: 24 of 25 frames shown (25 a second), none dropped, 1 repeated\n");
  EXPECT_EQ(verdict(frames_of(25, 25, 0, 0, 1, 2)),
            "frame rate met: 25 of 25 frames shown (25 a second), none dropped, none repeated, 1 "
            "capture overflow, 2 display underflows\n");
}

/// 4 of 6 displayed frames are new.
std::vector<StatRow> remaps_of(std::uint64_t remapped, double rate) {
  std::vector<StatRow> rows = frames_of(25, 6, 2, 0);
  rows.push_back({"frame.remapped", remapped, "1", ""});
  rows.push_back({"frame.remap_rate", rate, "1/s", ""});
  return rows;
}

// A loop that waits for the camera remaps about as many frames as are shown; three for each two new ones
// and more are remaps in a row, whose rate is the figure.
TEST(VerdictTest, BeginsWithTheRateOfRemapsInARow) {
  const std::string shown =
      "frame rate missed: 4 of 6 frames shown (25 a second), none dropped, 2 repeated\n";
  EXPECT_EQ(verdict(remaps_of(5, 26.5)), shown);
  EXPECT_EQ(verdict(remaps_of(6, 37.25)), "remaps in a row: 37.25 a second; " + shown);
  std::vector<StatRow> without = remaps_of(60, 0);
  without.pop_back();
  EXPECT_EQ(verdict(without), shown);
}

TEST(VerdictTest, SaysNothingWithoutFrames) {
  EXPECT_EQ(verdict({}), "");
  EXPECT_EQ(verdict(frames_of(25, 0, 0, 0)), "");
}

/// A wall clock that the test moves.
struct FakeClock {
  ProgressMeter::Clock::time_point now{};
  ProgressMeter::Now reader() {
    return [this] { return now; };
  }
};

TEST(ProgressMeterTest, PrintsALineAboutEveryTenSecondsWithoutATerminal) {
  FakeClock clock;
  std::ostringstream out;
  ProgressMeter meter(out, false, clock.reader());
  for (int i = 1; i <= 50; ++i) {
    clock.now += std::chrono::milliseconds(500);
    // Half real time; the first frame after 5 s of wall time.
    meter.update({i * kPsPerSecond / 4, i > 10 ? static_cast<std::uint64_t>(i - 10) : 0, 80, 0});
  }
  meter.finish();
  // 25 s: lines at 10 s and 20 s.
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
  EXPECT_THAT(text, HasSubstr("simulated 5.000 s, frame 10/80, 0.50x real time"));
  // At 20 s 50 frames remain at 0.5 s each.
  EXPECT_THAT(text, HasSubstr("frame 30/80, 0.50x real time, ETA 25 s"));
}

TEST(ProgressMeterTest, NamesThePhaseUntilTheFirstFrame) {
  FakeClock clock;
  std::ostringstream out;
  ProgressMeter meter(out, false, clock.reader());
  for (const auto& [phase, shown] : {std::pair("boot", 0u), std::pair("waiting for lock", 0u), std::pair("frames", 0u),
                                     std::pair("frames", 1u), std::pair("", 2u)}) {
    clock.now += std::chrono::seconds(11);
    meter.update({kPsPerSecond, shown, 80, 0, phase});
  }
  EXPECT_EQ(out.str(),
            "simulated 1.000 s, boot, 0.09x real time\n"
            "simulated 1.000 s, waiting for lock\n"
            "simulated 1.000 s, frame 0/80\n"
            "simulated 1.000 s, frame 1/80\n"
            "simulated 1.000 s, frame 2/80, ETA 14:18\n");
}

TEST(ProgressMeterTest, RewritesOneLineOnATerminal) {
  FakeClock clock;
  std::ostringstream out;
  ProgressMeter meter(out, true, clock.reader());
  for (int i = 1; i <= 4; ++i) {
    clock.now += std::chrono::milliseconds(250);
    meter.update({static_cast<Picoseconds>(i) * kPsPerMs, 0, 0, 0});
  }
  const std::string text = out.str();
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 4);
  meter.finish();
  EXPECT_EQ(out.str().back(), '\n');
}

TEST(ProgressMeterTest, SpeedIsMeasuredFromTheFirstFrameOn) {
  FakeClock clock;
  std::ostringstream out;
  ProgressMeter meter(out, false, clock.reader());
  clock.now += std::chrono::seconds(100);  // a slow start
  meter.update({kPsPerSecond, 1, 0, 1'000'000});
  clock.now += std::chrono::seconds(4);
  meter.update({3 * kPsPerSecond, 51, 0, 401'000'000});
  std::vector<StatRow> rows{{"mips", 1.0, "", "the board's own"}};
  meter.add_host_rows(rows);
  EXPECT_EQ(std::get<double>(find(rows, "realtime_factor")->value), 0.5);
  EXPECT_EQ(std::get<double>(find(rows, "wall_time")->value), 104.0);
  EXPECT_EQ(std::get<double>(find(rows, "mips")->value), 1.0);
  EXPECT_GT(std::get<std::uint64_t>(find(rows, "peak_rss")->value), 1'000'000u);
}

}  // namespace
}  // namespace fovea::app
