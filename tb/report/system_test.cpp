// What the page says of the system that ran, of several runs of one name, and of the slowest requests.
#include <fmt/format.h>

#include "sw/fovea/explain/command.h"
#include "sw/fovea/report/page.h"
#include "sw/fovea/report/sections.h"
#include "tb/report/folder.h"

namespace fovea::report {
namespace {

using test::HandMade;
using test::TempDir;
using test::two_frames;
using ::testing::HasSubstr;
using ::testing::Not;

std::string parameter(const std::string& key, const std::string& value, const std::string& origin = "default") {
  return "\"" + key + "\": {\"value\": \"" + value + "\", \"unit\": \"\", \"origin\": \"" + origin +
         "\", \"default\": \"\", \"allowed\": \"\", \"tag\": \"choice\", \"source\": \"\", \"belief\": null, "
         "\"description\": \"\"}";
}

std::string joined(const std::vector<std::string>& parameters) {
  std::string out;
  for (const auto& p : parameters) out += (out.empty() ? "" : ", ") + p;
  return out;
}

std::vector<std::string> board() {
  return {parameter("clocks.preset", "297/243"),
          parameter("clocks.arm", "0Hz"),
          parameter("clocks.ddr", "0Hz"),
          parameter("ddr.part", "mt47h64m16"),
          parameter("video.standard", "pal"),
          parameter("camera.kind", "sphere"),
          parameter("camera.lens", "kannala_brandt"),
          parameter("firmware.kernel", "fastest")};
}

TEST(SystemTest, SaysWhatRan) {
  const TempDir dir;
  HandMade run = two_frames();
  run.parameters = joined(board());
  run.write(dir);
  const auto text = [&] { return system_text(load_results(dir / "run", {})); };
  EXPECT_EQ(
      text(),
      "A simulated TI DM365 board runs its firmware: core ARM926EJ-S at 297 MHz, SDRAM mt47h64m16 at 243 MHz; video "
      "pal, camera sphere through a lens kannala_brandt. A remap is the correction of one captured frame: a look-up "
      "table says, for the pixels of the display, which pixels of the camera's picture to take.");
  run.words.kernel = "staged";
  run.write(dir);
  test::add_other_files(dir, "run");
  EXPECT_THAT(text(), HasSubstr("; video 720x576 in 625/50, camera sphere"));
  EXPECT_THAT(text(), HasSubstr(" Its loop is the kernel staged (firmware.kernel: fastest)."));
  auto other = board();
  other[2] = parameter("clocks.ddr", "162MHz", "command line");
  other[7] = parameter("firmware.kernel", "staged");
  run.parameters = joined(other);
  run.write(dir);
  EXPECT_THAT(text(), HasSubstr("ARM926EJ-S at 297 MHz, SDRAM mt47h64m16 at 162MHz;"));
  EXPECT_THAT(text(), HasSubstr(" Its loop is the kernel staged. A remap"));
  const std::string page = report_page({load_results(dir / "run", {})});
  EXPECT_LT(page.find("A simulated TI DM365 board"), page.find("<nav"));
}

TEST(SystemTest, RunsOfOneNameAreCalledByWhatDiffers) {
  const TempDir dir;
  std::vector<Results> runs;
  for (int n = 0; n < 3; ++n) {
    HandMade run = two_frames();
    auto parameters = board();
    parameters[2] = parameter("clocks.ddr", std::to_string(100 + n) + "MHz", "command line");
    if (n == 2) parameters[7] = parameter("firmware.kernel", "/home/me/k", "/home/me/x.yaml:3");
    run.parameters = joined(parameters);
    run.write(dir, std::to_string(n) + "/run");
    runs.push_back(load_results(dir / (std::to_string(n) + "/run"), {}));
  }
  name_apart(runs);
  EXPECT_EQ(title_of(runs, 0), "A: clocks.ddr=100MHz, firmware.kernel=fastest");
  EXPECT_EQ(title_of(runs, 2), "C: clocks.ddr=102MHz, firmware.kernel=k");
  // Nothing differs: the folders around them do.
  std::vector<Results> same{load_results(dir / "0/run", {}), load_results(dir / "0/run", {})};
  name_apart(same);
  EXPECT_EQ(title_of(same, 1), "B: 0/run");
  // Names that differ stay.
  HandMade(two_frames()).write(dir, "other");
  std::vector<Results> named{load_results(dir / "0/run", {}), load_results(dir / "other", {})};
  name_apart(named);
  EXPECT_EQ(title_of(named, 1), "B: other");
}

TEST(SystemTest, NoFolderOfTheAuthorIsOnThePage) {
  const TempDir dir;
  HandMade run = two_frames();
  auto parameters = board();
  parameters.push_back(parameter("camera.file", "/home/author/films/road.mp4", "/home/author/e/hand-made.yaml:4"));
  parameters.push_back(parameter("firmware.elf", "/home/author/fw.elf", "command line"));
  run.parameters = joined(parameters);
  run.command =
      R"(["run", "/home/author/e/hand-made.yaml", "-s", "firmware.elf=/home/author/fw.elf", "-o", "/home/author/out"])";
  const auto results = load_results(run.write(dir), {});
  const std::string page = report_page({results}), text = report_text({results});
  EXPECT_THAT(page, Not(HasSubstr("/home")));
  EXPECT_THAT(text, Not(HasSubstr("/home")));
  EXPECT_THAT(page, HasSubstr("fovea run hand-made.yaml -s firmware.elf=fw.elf -o out"));
  EXPECT_THAT(page, HasSubstr("fovea limits hand-made.yaml -s firmware.elf=fw.elf --binds frame.remap_time.mean"));
  EXPECT_THAT(page, HasSubstr("<td>road.mp4</td><td>hand-made.yaml:4</td>"));
}

TEST(SystemTest, TheSlowestRequestsHaveTheirStepsAndACommand) {
  const TempDir dir;
  HandMade run = two_frames();
  run.parameters = joined({parameter("ddr.tRP", "20ns", "command line"), parameter("a", "b", "x.yaml:1")});
  run.command = R"(["run", "e/hand-made.yaml", "-s", "ddr.tRP=20ns"])";
  run.write(dir);
  test::add_other_files(dir, "run");
  const auto results = load_results(dir / "run", {});
  const std::string page = report_page({results}), text = report_text({results});
  EXPECT_THAT(
      text,
      HasSubstr(
          "Slowest read of arm_d (the core's data): 1.250 us at 80.153412 ms: 1.000 us while vpbe (the display) is "
          "served, 0.225 us on its own way through crossbar and SDRAM controller, 0.025 us in "
          "its bridge to the crossbar.\n"));
  EXPECT_THAT(text, HasSubstr("Slowest write of vpbe (the display): 0.008 us at 0.001000 ms"));
  EXPECT_THAT(page, HasSubstr("port bridge 24.7, controller vpbe 1000.0, return service 225.3"));
  EXPECT_THAT(page, HasSubstr("fovea run e/hand-made.yaml -s ddr.tRP=20ns --around 80.153412345ms"));
  // Neighbours of one kind are one; what is longer than a line or two has its sums.
  std::string rows =
      "master,direction,port,issued_ns,latency_ns,address,bytes,bank,row,row_state,step,place,culprit,begin_ns,time_"
      "ns\n";
  const auto step = [&](int n, const char* culprit) {
    rows += fmt::format("vpfe,write,vpfe,0.000,99.000,0x80000000,8,0,0,,{},crossbar,{},{}.000,2.500\n", n, culprit, n);
  };
  for (int n = 1; n <= 3; ++n) step(n, n == 2 ? "vpbe" : "arm_d");
  step(4, "arm_d");
  dir.write("run/slowest.csv", rows);
  EXPECT_THAT(report_page({load_results(dir / "run", {})}),
              HasSubstr("<td>crossbar arm_d 2.5, crossbar vpbe 2.5, crossbar arm_d 5.0 (2 times)</td>"));
  for (int n = 5; n <= 14; ++n) step(n, n % 2 ? "vpbe" : "arm_d");
  dir.write("run/slowest.csv", rows);
  EXPECT_THAT(report_page({load_results(dir / "run", {})}),
              HasSubstr("<td>arm_d 20.0, vpbe 15.0; 14 steps in slowest.csv</td>"));
  dir.write("run/slowest.csv",
            "master,direction,port,issued_ns,latency_ns,address,bytes,bank,row,row_state,step,place,culprit,"
            "begin_ns,time_ns\na,read,a,1.000,1.000,12,8,0,0,,1,port,bridge,1.000,1.000\n");
  EXPECT_THAT(test::user_error([&] { load_results(dir / "run", {}); }),
              HasSubstr("slowest.csv:2: '12' is not a hexadecimal"));
}

TEST(CommandTest, WordsAreWhatAShellTakes) {
  EXPECT_EQ(explain::shell_word("a.yaml"), "a.yaml");
  EXPECT_EQ(explain::shell_word("a b"), "'a b'");
  EXPECT_EQ(explain::shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(explain::shell_word(""), "''");
  EXPECT_EQ(explain::binds_command("e.yaml", std::vector<std::string>{"lens.kb=[1, 2]"}),
            "fovea limits e.yaml -s 'lens.kb=[1, 2]' --binds frame.remap_time.mean");
}

TEST(CommandTest, AbsolutePathsLoseTheirFolders) {
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{{"/a/b.yaml", "b.yaml"},
                                                                                 {"/a/b.yaml:7", "b.yaml:7"},
                                                                                 {"k=/a/b", "k=b"},
                                                                                 {"/a/b,/c/d", "b,d"},
                                                                                 {"a/b.yaml", "a/b.yaml"},
                                                                                 {"297/243", "297/243"},
                                                                                 {"/", "/"},
                                                                                 {"/a/b/", "b"},
                                                                                 {"", ""},
                                                                                 {"../x", "../x"},
                                                                                 {"as /a/b", "as b"},
                                                                                 {"1/2 and 3/4", "1/2 and 3/4"}})
    EXPECT_EQ(explain::without_folders(from), to) << from;
}

}  // namespace
}  // namespace fovea::report
