// sw/fovea/report: what stands on the page, read back from it.
#include <fmt/format.h>

#include <ctime>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <set>

#include "sw/fovea/report/html.h"
#include "sw/fovea/report/page.h"
#include "sw/fovea/report/pictures.h"
#include "sw/fovea/results/csv.h"
#include "tb/report/folder.h"
#include "tb/unit/png_file.h"

namespace fovea::report {
namespace {

namespace fs = std::filesystem;
using app::RgbImage;
using nlohmann::json;
using test::HandMade;
using test::TempDir;
using test::two_frames;
using test::user_error;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

json data_of(const std::string& page) {
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const auto from = page.find(begin) + begin.size();
  return json::parse(page.substr(from, page.find("</script>", from) - from));
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++n;
  return n;
}

std::string one_page(const fs::path& folder) { return report_page({load_results(folder, {})}); }

// Reading.

// Values are copied and written by recursion, so how deep they are is counted before.
TEST(LoadTest, DeepJsonIsRefusedBeforeItIsRead) {
  const TempDir dir;
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  HandMade run = two_frames();
  run.experiment = "x\", \"more\": " + deep + ", \"y\": \"";
  EXPECT_THAT(user_error([&] { load_results(run.write(dir), {}); }), HasSubstr("is not a folder of results"));
  two_frames().write(dir);
  dir.write("run/stats.json", "{\"frame.rate\": {\"value\": 1, \"unit\": " + deep + "}}");
  EXPECT_THAT(user_error([&] { load_results(dir / "run", {}); }), HasSubstr("not a file of JSON; it is damaged"));
  // Brackets in a text are none.
  run.experiment = std::string(1000, '[') + "\\\"[";
  EXPECT_EQ(load_results(run.write(dir), {}).experiment, std::string(1000, '[') + "\"[");
}

// The page looks for names one by one, and a stack is a nested value.
TEST(PageTest, AHundredThousandFiguresAndFunctionsOnOneStack) {
  const TempDir dir;
  HandMade run = two_frames();
  const fs::path folder = run.write(dir);
  std::string figures = "{\"complete\": true";
  for (int n = 0; n < 100'000; ++n) figures += ", \"zz." + std::to_string(n) + "\": {\"value\": 1, \"unit\": \"1\"}";
  dir.write("run/stats.json", figures + "}");
  EXPECT_THAT(user_error([&] { load_results(folder, {}); }), HasSubstr("figures or parameters; allowed: up to 5000"));
  for (int n = 0; n < 1000; ++n) run.stats.push_back({"zz." + std::to_string(n), std::uint64_t{1}, "1", "d"});
  run.write(dir);
  std::string stack;
  for (int n = 0; n < 100'000; ++n) stack += "a;";
  dir.write("run/profile.folded", stack + "last 1000\n");
  const std::clock_t begun = std::clock();
  const json data = data_of(one_page(folder));
  EXPECT_LT(std::clock() - begun, 20 * CLOCKS_PER_SEC);
  EXPECT_TRUE(data["runs"][0]["stats"].contains("zz.999"));
  std::vector<std::string> names;
  const json* node = &data["runs"][0]["stacks"];
  for (; node->contains("children"); node = &(*node)["children"][0]) names.push_back((*node)["name"]);
  EXPECT_EQ((*node)["name"], "last");
  ASSERT_EQ(names.size(), 202u);
  EXPECT_EQ(names.back(), "...");
}

TEST(LoadTest, ARowOfCommasIsRefusedBeforeItIsKept) {
  const TempDir dir;
  const fs::path folder = two_frames().write(dir);
  dir.write("run/profile.csv", std::string(1'000'000, ','));
  EXPECT_THAT(user_error([&] { load_results(folder, {}); }), HasSubstr("profile.csv:1: a row of more than 512 fields"));
  dir.write("run/profile.csv", std::string(results::kMaxTableBytes + 1, '\n'));
  EXPECT_THAT(user_error([&] { load_results(folder, {}); }), HasSubstr("is larger than"));
}

TEST(LoadTest, PartialResultsAndOtherVersionsNeedTheirOption) {
  const TempDir dir;
  HandMade run = two_frames();
  run.complete = false;
  EXPECT_THAT(user_error([&] { load_results(run.write(dir), {}); }),
              HasSubstr("allowed: complete results, or --partial"));
  EXPECT_THAT(report_page({load_results(dir / "run", {.partial = true})}),
              HasSubstr("These results are partial"));
  run.complete = true;
  run.version = "9.9.9";
  EXPECT_THAT(user_error([&] { load_results(run.write(dir), {.partial = true}); }),
              HasSubstr("it was written by version 9.9.9 of Fovea"));
  EXPECT_EQ(load_results(dir / "run", {.across_versions = true}).version, "9.9.9");
}

TEST(LoadTest, DamagedRowsAreNamedByFileAndLine) {
  const TempDir dir;
  const fs::path run = two_frames().write(dir);
  const auto error = [&] { return user_error([&] { load_results(run, {}); }); };
  dir.write("run/stalls.csv", "cause,region,culprit,cycles\ndcache,a,b,1\ndcache,a,b\n");
  EXPECT_THAT(error(), HasSubstr("stalls.csv:3: 3 fields; the header has 4"));
  dir.write("run/stalls.csv", "cause,region,clocks,culprit\n");
  EXPECT_THAT(error(), HasSubstr("stalls.csv:1: there is no column 'cycles'"));
  dir.write("run/stalls.csv", "");
  EXPECT_THAT(error(), HasSubstr("stalls.csv:1: the header is missing"));
  dir.write("run/stalls.csv", "cause,region,culprit,cycles\n");
  dir.write("run/profile.folded", "main;remap 7\nmain\n");
  EXPECT_THAT(error(), HasSubstr("profile.folded:2: no number of clocks behind the stack"));
  dir.write("run/frames.csv",
            "frame,camera,captured_frame,capture_start_ns,capture_end_ns,remap_start_ns,remap_end_ns,"
            "display_start_ns,display_end_ns,dropped,repeated\n0,,,,,,,1.000,2.000,0,0\n1,,,,,,,3.000,,0,0\n");
  EXPECT_THAT(error(), HasSubstr("frames.csv:3: a displayed frame without the times of its display"));
}

// Figures.

TEST(PageTest, EveryFigureIsThatOfStatsJson) {
  const TempDir dir;
  const fs::path folder = two_frames().write(dir);
  test::add_other_files(dir, "run");
  const std::string page = one_page(folder);
  const json stats = json::parse(test::read_text(folder / "stats.json")),
             data = data_of(page)["runs"][0]["stats"];
  EXPECT_THAT(page, HasSubstr("<span>new pictures on the display</span></div>"));
  EXPECT_THAT(page, HasSubstr("<span>remap of a frame, mean</span></div>"));
  std::size_t with_value = 0;
  for (const auto& [name, figure] : stats.items()) {
    if (!figure.is_object() || !figure.contains("value")) continue;
    if (figure["value"].is_null()) {
      EXPECT_FALSE(data.contains(name)) << name;
      EXPECT_THAT(page, Not(HasSubstr(name)));
      continue;
    }
    EXPECT_EQ(data[name][0], figure["value"]) << name;
    EXPECT_EQ(data[name][1], figure["unit"]) << name;
    ++with_value;
  }
  EXPECT_EQ(data.size(), with_value);
  const std::regex cell("<data data-figure=\"([^\"]*)\" value=\"([^\"]*)\">([^<]*)</data>");
  std::set<std::string> shown;
  for (std::sregex_iterator i(page.begin(), page.end(), cell), end; i != end; ++i) {
    const std::string name = (*i)[1];
    if (name == "wall_time") continue;  // from host.json
    ASSERT_TRUE(stats.contains(name)) << name;
    EXPECT_EQ(json::parse((*i)[2].str()), stats[name]["value"]) << name;
    const json& v = stats[name]["value"];
    const StatBase::Value value = v.is_number_unsigned() ? StatBase::Value(v.get<std::uint64_t>())
                                                         : StatBase::Value(v.get<double>());
    EXPECT_EQ((*i)[3], escaped(app::human_text(value, stats[name]["unit"].get<std::string>())))
        << name;
    shown.insert(name);
  }
  for (const auto& [name, figure] : stats.items()) {
    if (!figure.is_object() || !figure["value"].is_number() || figure["value"] == 0) continue;
    EXPECT_TRUE(shown.contains(name)) << name;
  }
}

TEST(PageTest, EqualFoldersGiveEqualBytes) {
  const TempDir dir;
  two_frames().write(dir);
  test::add_other_files(dir, "run");
  EXPECT_EQ(one_page(dir / "run"), one_page(dir / "run"));
}

TEST(PageTest, MissingFilesLeaveTheirSectionsOutWithASentence) {
  const TempDir dir;
  const std::string bare = one_page(two_frames().write(dir));
  test::add_other_files(dir, "run");
  const std::string full = one_page(dir / "run");
  const std::vector<std::pair<std::string, std::string>> expected{
      {"no frames.csv", "frames"},
      {"no rows in timeline.csv", "bandwidth-whole"},
      {"no stalls.csv", ""},
      {"no latency.csv", "latency"},
      {"There is no profile", "flame"}};
  for (const auto& [sentence, chart] : expected) {
    EXPECT_THAT(bare, HasSubstr(sentence));
    EXPECT_THAT(full, Not(HasSubstr(sentence)));
    if (chart.empty()) continue;
    EXPECT_THAT(bare, Not(HasSubstr("data-chart=\"" + chart + "\"")));
    EXPECT_THAT(full, HasSubstr("data-chart=\"" + chart + "\""));
  }
  EXPECT_THAT(full, HasSubstr("This run has no pictures"));
}

TEST(PageTest, SectionsAreInOrder) {
  const TempDir dir;
  const std::string page = one_page(two_frames().write(dir));
  std::size_t before = 0;
  for (const char* id : {"verdict", "pictures", "key", "frames", "bandwidth", "latency", "stalls", "banks", "functions",
                         "configuration", "figures", "provenance"}) {
    const auto at = page.find(std::string("<section id=\"") + id + "\"");
    ASSERT_NE(at, page.npos) << id;
    EXPECT_GT(at, before) << id;
    before = at;
  }
}

TEST(PageTest, FunctionsAreThoseOfTheFrames) {
  const TempDir dir;
  two_frames().write(dir);
  test::add_other_files(dir, "run");
  const std::string page = one_page(dir / "run");
  EXPECT_THAT(page, HasSubstr("<tr><th scope=\"row\"><code>remap</code></th><td class=\"n\"><data "
                              "value=\"750\">750</data></td>"
                              "<td class=\"n\"><data value=\"0.5\">50 %</data></td><td "
                              "class=\"n\"><data value=\"250\">250</data>"
                              "</td><td>D-cache line fills</td><td>remap.c:10</td></tr>"));
  EXPECT_THAT(page, Not(HasSubstr("<code>start</code>")));  // of the phase boot
}

/// Whether `parts` stand in the text one behind the other.
bool in_order(const std::string& text, const std::vector<std::string>& parts) {
  std::size_t at = 0;
  for (const auto& part : parts) {
    at = text.find(part, at);
    if (at == text.npos) return false;
    at += part.size();
  }
  return true;
}

TEST(PageTest, AnyFaultOfTheFramesMissesTheVerdict) {
  for (const char* fault : {"", "frame.repeated", "frame.dropped", "capture.overflows", "display.underflows"}) {
    const TempDir dir;
    HandMade run = two_frames();
    std::erase_if(run.stats, [&](const auto& s) { return s.name == fault; });
    if (*fault) run.stats.push_back({fault, std::uint64_t{1}, "1", ""});
    const std::string page = one_page(run.write(dir));
    EXPECT_EQ(count(page, "class=\"verdict missed\""), *fault ? 1u : 0u) << fault;
    EXPECT_EQ(count(page, "class=\"verdict met\""), *fault ? 0u : 1u) << fault;
  }
}

// 8 MB in 80 ms are 100 MB/s; who moved nothing is left out.
TEST(PageTest, TablesHaveTheirFiguresInTheirPlaces) {
  const TempDir dir;
  HandMade run = two_frames();
  for (auto& s : run.stats)
    if (s.name == "bus.arm_d.read_bytes") s.value = std::uint64_t{8'000'000};
  run.stats.push_back({"net", -2.0, "s", "below zero"});
  run.write(dir);
  test::add_other_files(dir, "run");
  dir.write("run/profile.csv",
            "phase,function,file,line,cause,region,culprit,clocks,instructions\n"
            "frames,small,s.c,1,issue,,,1,1\nframes,busy,b.c,1,issue,,,1200,1200\n"
            "frames,busy,b.c,2,dcache,lut,bridge,299,0\n");
  const std::string page = one_page(dir / "run");
  EXPECT_THAT(page, HasSubstr("<td class=\"n\"><data value=\"100000000.0\">100.0</data></td>"));
  EXPECT_THAT(page, Not(HasSubstr("<th scope=\"row\">edma_tc0</th>")));
  EXPECT_TRUE(in_order(page, {"<th scope=\"row\">arm_d</th><td>reads</td><td>first</td>", "latency.mean", "latency.p50",
                              "latency.p95", "latency.p99", "latency.max", "</tr>"}));
  EXPECT_THAT(page, HasSubstr("data-figure=\"net\""));
  // Largest first.
  EXPECT_TRUE(in_order(page, {"<td>frame_in</td>", "<td>bridge</td>", "<td>vpbe</td>", "<td>row_miss</td>"}));
  EXPECT_TRUE(in_order(page, {"<code>busy</code>", "D-cache line fills", "<code>small</code>"}));
  EXPECT_THAT(page, HasSubstr("<data value=\"1200\">1,200</data>"));
}

// 750 clocks become 700, and a function is new: 50 of 750.
TEST(PageTest, FunctionsOfTwoRunsHaveTheirDifference) {
  const TempDir dir;
  for (const char* name : {"one", "two"}) {
    two_frames().write(dir, name);
    dir.write(std::string(name) + "/profile.csv",
              std::string("phase,function,file,line,cause,region,culprit,clocks,instructions\n") +
                  (name == std::string("one") ? "frames,f,f.c,1,issue,,,750,750\n"
                                              : "frames,f,f.c,1,issue,,,700,700\nframes,g,g.c,1,issue,,,50,50\n"));
  }
  const std::string page = report_page({load_results(dir / "one", {}), load_results(dir / "two", {})});
  EXPECT_THAT(page, HasSubstr("<td class=\"n\"><data value=\"-50\">-50</data></td>"));
  EXPECT_TRUE(in_order(page, {"<code>g</code>", "<data value=\"0\">0</data>", "<data value=\"0.0\">0.0 %</data>",
                              "<data value=\"50\">50</data>", "6.7 %", "<data value=\"50\">+50</data>"}));
}

TEST(PageTest, ReachesNothingOutsideItself) {
  const TempDir dir;
  two_frames().write(dir);
  test::add_other_files(dir, "run");
  const std::string page = one_page(dir / "run");
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  const auto at = page.rfind("<script>") + 8;
  EXPECT_THAT(page, HasSubstr("script-src '" +
                              script_digest(page.substr(at, page.rfind("</script>") - at)) + "'"));
  // The name of SVG's elements is not fetched.
  EXPECT_EQ(count(page, "http"), 1u + count(page, "http-equiv"));
  EXPECT_THAT(page, HasSubstr("http://www.w3.org/2000/svg"));
  EXPECT_TRUE(is_report_page(page.substr(0, 4096)));
  EXPECT_FALSE(is_report_page("<!DOCTYPE html>\n<html lang=\"en\">\n<title>mine</title>"));
}

TEST(PageTest, HostileTextsDoNothing) {
  const TempDir dir;
  const std::string evil =
      "</script><script>alert(1)</script><img src=x onerror=alert(2)>'\"&\x1b[31m";
  HandMade run = two_frames();
  run.experiment = "</title><script>alert(3)</script>";
  run.warnings = {{"firmware", evil, 2}};
  run.stats.push_back({"evil.<b>", std::uint64_t{1}, "<i>", evil});
  run.parameters =
      R"x("<script>k": {"value": "</script><script>alert(4)", "unit": "", "origin": "f:1", "default": "<a>",
    "allowed": "", "tag": "<b>", "source": "\"><b>", "belief": {"low": "<", "high": ">", "reason": "<u>"},
    "description": "<p onclick=x>"})x";
  run.command = R"x(["run", "</code><script>alert(5)</script>"])x";
  const fs::path folder = run.write(dir, "<img src=x onerror=alert(6)>");
  const std::string name = folder.filename().string();
  dir.write(name + "/stalls.csv", "cause,region,culprit,cycles\n<script>,</script>,<b>,5\n");
  dir.write(name + "/profile.csv",
            "phase,function,file,line,cause,region,culprit,clocks,instructions\n"
            "frames,\"f<script>(\"\"a\"\")\",<b>,1,issue,,,5,5\n");
  dir.write(name + "/profile.folded", "a<script>;</script> 5\n");
  const std::string page = one_page(folder);
  EXPECT_EQ(count(page, "<script"), 2u);  // the data and the page's own
  EXPECT_EQ(count(page, "</script"), 2u);
  for (const char* tag : {"<img", "<b>dc", "<i>", "<p onclick", "<u>", "\x1b"})
    EXPECT_THAT(page, Not(HasSubstr(tag)));
  EXPECT_EQ(count(page, "</title>"), 1u);
  const json data = data_of(page)["runs"][0];
  EXPECT_EQ(data["name"], name);
  EXPECT_EQ(data["stalls"][0][1], "</script>");
  EXPECT_EQ(data["stacks"]["children"][0]["name"], "a<script>");
  const std::string text = report_text({load_results(folder, {})});
  EXPECT_THAT(text, Not(HasSubstr("\x1b")));
}

TEST(PageTest, NeverSaysWhatBinds) {
  const TempDir dir;
  two_frames().write(dir);
  test::add_other_files(dir, "run");
  const std::string page = one_page(dir / "run"),
                    text = report_text({load_results(dir / "run", {})});
  // But for the command that finds out.
  EXPECT_EQ(count(page, "binds"), count(page, "fovea limits hand-made.yaml --binds frame.remap_time.mean"));
  EXPECT_EQ(count(text, "binds"), 1u);
  EXPECT_THAT(text, HasSubstr("What makes its remaps faster is found by runs: fovea limits hand-made.yaml --binds "));
  EXPECT_THAT(text, HasSubstr("frame rate met: 2 of 2 frames shown"));
  EXPECT_THAT(text, HasSubstr("- Largest wait: in 50 %"));
  EXPECT_THAT(text, HasSubstr("    from cpu.stall.dcache, cpu.cycles"));
}

// Several runs.

TEST(CompareTest, ShowsEachRunAndTheDifference) {
  const TempDir dir;
  HandMade b = two_frames();
  for (auto& s : b.stats) {
    if (s.name == "frame.remap_time.mean") s.value = 0.008;
    if (s.name == "ddr.row_hits") s.value = std::uint64_t{60};
    if (s.name == "ddr.utilisation") s.value = 0.26;
    if (s.name == "frame.rate") s.value = 25.000000000000004;
  }
  b.commit = "fedcba987654";
  b.parameters =
      R"("a.key": {"value": "2", "unit": "", "origin": "command line", "default": "1", "allowed": "0 .. 2",
    "tag": "choice", "source": "", "belief": null, "description": "a number"})";
  two_frames().write(dir, "one");
  b.write(dir, "two");
  const std::string page =
      report_page({load_results(dir / "one", {}), load_results(dir / "two", {})});
  EXPECT_THAT(page, HasSubstr(">-2 ms (-20 %)</data>"));
  EXPECT_THAT(page, HasSubstr(">-20 (-25 %)</data>"));
  EXPECT_THAT(page, HasSubstr(">+1 points (+4 %)</data>"));
  EXPECT_THAT(
      page, HasSubstr("<th scope=\"row\"><code>a.key</code></th><td>1 <small>(default)</small></td>"
                      "<td>2 <small>(command line)</small></td>"));
  EXPECT_THAT(page, HasSubstr("The runs come from different states of the simulator"));
  EXPECT_THAT(page,
              HasSubstr("The remap of B takes 8.00&nbsp;ms instead of the 10.0&nbsp;ms of A: 20&nbsp;% less."));
  EXPECT_THAT(page, HasSubstr("B: two"));
  // Rounding of a sum is no difference.
  EXPECT_THAT(page, Not(HasSubstr("e-1")));
  EXPECT_EQ(data_of(page)["runs"].size(), 2u);
}

TEST(CompareTest, EqualParametersAreNotListed) {
  const TempDir dir;
  two_frames().write(dir, "one");
  two_frames().write(dir, "two");
  const std::string page =
      report_page({load_results(dir / "one", {}), load_results(dir / "two", {})});
  EXPECT_THAT(page, HasSubstr("The runs have the same parameters."));
  EXPECT_THAT(page, Not(HasSubstr("different states")));
}

// Pictures.

RgbImage picture(unsigned width, unsigned height, std::uint8_t value) {
  return {.width = width,
          .height = height,
          .rgb = std::vector<std::uint8_t>(std::size_t{3} * width * height, value)};
}

TEST(PictureTest, ShrinkingTakesTheMean) {
  RgbImage p = picture(5, 3, 10);  // the last column and row have no partner
  p.rgb[0] = 13;                   // red of the first four pixels: 13 10 10 10
  const RgbImage half = shrink(p, 2);
  EXPECT_EQ(half.width, 2u);
  EXPECT_EQ(half.height, 1u);
  EXPECT_THAT(half.rgb, ElementsAre(11, 10, 10, 10, 10, 10));
}

TEST(PictureTest, DifferenceCountsPixelsAndErrors) {
  const RgbImage a = picture(4, 2, 100);
  RgbImage b = a;
  EXPECT_EQ(difference(a, b)->pixels, 0u);
  EXPECT_TRUE(std::isinf(difference(a, b)->psnr));
  b.rgb[0] = 110;
  b.rgb[1] = 90;
  b.rgb[23] = 101;
  const auto d = difference(a, b);
  EXPECT_EQ(d->pixels, 2u);
  EXPECT_EQ(d->all, 8u);
  EXPECT_NEAR(d->psnr, 10 * std::log10(255.0 * 255.0 / (201.0 / 24)), 1e-9);
  EXPECT_FALSE(difference(a, picture(2, 4, 100)));
}

TEST(PictureTest, BeforeAndAfterHaveTheSameNumber) {
  const TempDir dir;
  two_frames().write(dir);
  fs::create_directories(dir / "run/frames");
  fs::create_directories(dir / "run/camera");
  test::write_png(dir / "run/frames/frame_000000.png", picture(8, 4, 1));
  test::write_png(dir / "run/frames/frame_000003.png", picture(8, 4, 2));
  test::write_png(dir / "run/camera/frame_000003.png", picture(16, 8, 3));
  const auto chosen = choose_pictures({load_results(dir / "run", {})}, 1'000'000);
  EXPECT_EQ(chosen[0].frame, 3u);
  EXPECT_EQ(chosen[0].before->width, 16u);
  EXPECT_EQ(chosen[0].after->width, 8u);
  const std::string page = one_page(dir / "run");
  EXPECT_THAT(
      page, HasSubstr("Frame 3: what the camera sent, and the corrected picture on the display."));
  EXPECT_THAT(page, HasSubstr("class=\"compare\""));
  fs::remove_all(dir / "run/camera");
  EXPECT_THAT(one_page(dir / "run"), HasSubstr("Frame 0: the corrected picture on the display."));
}

// The last frame of a composed view, with what each camera sent last.
TEST(PictureTest, AComposedViewIsShownWithAllItsCameras) {
  const TempDir dir;
  HandMade run = two_frames();
  fs::create_directories(dir / "run/frames");
  fs::create_directories(dir / "run/camera");
  const auto with_view = [&](const std::string& view) {
    run.parameters =
        R"("firmware.view": {"value": ")" + view + R"(", "unit": "", "origin": "default", "default": "single",
      "allowed": "", "tag": "choice", "source": "", "belief": null, "description": "a view"})";
    run.write(dir);
    return choose_pictures({load_results(dir / "run", {})}, 1'000'000)[0];
  };
  std::string rows =
      "frame,camera,captured_frame,capture_start_ns,capture_end_ns,remap_start_ns,remap_end_ns,"
      "display_start_ns,display_end_ns,dropped,repeated\n";
  for (int n = 0; n < 5; ++n) {
    rows += fmt::format("{},{},{},,,,,{}.000,{}.000,0,0\n", n, n % 2, n, n, n + 1);
    const auto name = fmt::format("frame_{:06}.png", n);
    test::write_png(dir / "run/frames" / name, picture(8, 4, static_cast<std::uint8_t>(n)));
    if (n < 4) test::write_png(dir / "run/camera" / name, picture(16, 8, static_cast<std::uint8_t>(10 + n)));
  }
  dir.write("run/frames.csv", rows);
  const RunPictures chosen = with_view("birds_eye");
  EXPECT_EQ(chosen.frame, 4u);
  EXPECT_FALSE(chosen.before);
  ASSERT_EQ(chosen.cameras.size(), 2u);
  EXPECT_EQ(chosen.cameras[0].camera, 0u);
  EXPECT_EQ(chosen.cameras[0].frame, 2u);
  EXPECT_EQ(chosen.cameras[1].camera, 1u);
  EXPECT_EQ(chosen.cameras[1].frame, 3u);
  EXPECT_NE(chosen.cameras[0].picture.uri, chosen.cameras[1].picture.uri);
  const std::string page = one_page(dir / "run");
  EXPECT_THAT(page,
              HasSubstr("Frame 4: the composed view on the display. Below it, what was sent last for each camera."));
  EXPECT_THAT(page, HasSubstr("Camera 1, for frame 3."));
  EXPECT_EQ(with_view("single").frame, 0u);
}

TEST(PictureTest, RunsAreComparedPixelByPixel) {
  const TempDir dir;
  for (const auto& [name, value] :
       {std::pair("one", 7), std::pair("two", 7), std::pair("three", 9)}) {
    two_frames().write(dir, name);
    fs::create_directories(dir / name / "frames");
    test::write_png(dir / name / "frames/frame_000000.png",
                   picture(8, 4, static_cast<std::uint8_t>(value)));
  }
  const std::string page =
      report_page({load_results(dir / "one", {}), load_results(dir / "two", {}),
                   load_results(dir / "three", {})});
  EXPECT_THAT(page,
              HasSubstr("The displayed frames 0 of A: one and B: two are equal, pixel for pixel."));
  EXPECT_THAT(
      page,
      HasSubstr("Frame 0 of A: one and C: three: 32 of 32 pixels differ (100 %), PSNR 42.1 dB."));
}

TEST(PictureTest, TheShareOfPixelsIsOfAll) {
  const TempDir dir;
  RgbImage second = picture(8, 4, 7);
  for (int i = 0; i < 8; ++i) second.rgb[static_cast<std::size_t>(3 * i)] = 9;
  for (const auto& [name, shown] : {std::pair("one", picture(8, 4, 7)), std::pair("two", second)}) {
    two_frames().write(dir, name);
    fs::create_directories(dir / name / "frames");
    test::write_png(dir / name / "frames/frame_000000.png", shown);
  }
  EXPECT_THAT(report_page({load_results(dir / "one", {}), load_results(dir / "two", {})}),
              HasSubstr("8 of 32 pixels differ (25 %)"));
}

TEST(PictureTest, EightRunsOfNoiseStayBelowThreeMegabytes) {
  const TempDir dir;
  RgbImage noise = picture(720, 576, 0);
  std::mt19937 random(1);
  for (auto& v : noise.rgb) v = static_cast<std::uint8_t>(random());
  std::vector<Results> runs;
  for (std::size_t i = 0; i < kMaxRuns; ++i) {
    const std::string name = run_label(i);
    two_frames().write(dir, name);
    test::add_other_files(dir, name);
    for (const char* folder : {"/frames", "/camera"}) {
      fs::create_directories(dir / (name + folder));
      if (i == 0)
        test::write_png(dir / (name + folder + "/frame_000000.png"), noise);
      else
        fs::copy_file(dir / (std::string("A") + folder + "/frame_000000.png"),
                      dir / (name + folder + "/frame_000000.png"));
    }
    runs.push_back(load_results(dir / name, {}));
  }
  const std::string page = report_page(runs);
  EXPECT_LT(page.size(), 3'000'000u);
  EXPECT_THAT(page, HasSubstr("Shown at 1/4 of its 720 x 576 pixels."));
  runs.resize(1);
  const std::string alone = report_page(runs);
  EXPECT_LT(alone.size(), 3'000'000u);
  EXPECT_GT(alone.size(), 600'000u);  // no smaller than it must be
}

// With no room at all a picture is shrunk until its shorter side has fewer than four pixels.
TEST(PictureTest, ShrinkingEndsAtAFewPixels) {
  for (const auto& [width, height, shrunk] :
       {std::tuple{32u, 64u, 16u}, {64u, 32u, 16u}, {64u, 64u, 32u}, {63u, 64u, 16u}}) {
    const TempDir dir;
    two_frames().write(dir);
    fs::create_directories(dir / "run/frames");
    test::write_png(dir / "run/frames/frame_000000.png", picture(width, height, 1));
    const auto chosen = choose_pictures({load_results(dir / "run", {})}, 1);
    ASSERT_TRUE(chosen[0].after);
    EXPECT_EQ(chosen[0].after->shrunk, shrunk) << width << " x " << height;
    EXPECT_EQ(chosen[0].after->width, width);
    EXPECT_EQ(chosen[0].after->height, height);
  }
}

TEST(HtmlTest, Base64AndDigest) {
  const auto encoded = [](const std::string& s) {
    return base64(std::vector<std::uint8_t>(s.begin(), s.end()));
  };
  EXPECT_EQ(encoded("") + encoded("f") + encoded("fo") + encoded("foo") + encoded("foob"),
            "Zg==Zm8=Zm9vZm9vYg==");  // RFC 4648
  EXPECT_EQ(script_digest("abc"), "sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=");
}

}  // namespace
}  // namespace fovea::report
