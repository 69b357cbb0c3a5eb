// `fovea report` and `fovea run --report` as they are typed.
#include "sw/fovea/cli/cli.h"
#include "tb/report/folder.h"
#include "tb/unit/fake_board.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using test::HandMade;
using test::TempDir;
using test::two_frames;
using ::testing::HasSubstr;

struct Outcome {
  int status = 0;
  std::string out, err;
};

Outcome fovea(const std::vector<std::string>& args) {
  std::ostringstream out, err;
  const CliContext context{.out = out, .err = err, .make_machine = [](MachineKind) {
                             return std::make_unique<test::FakeBoard>();
                           }};
  const int status = run_cli(args, context);
  return {status, out.str(), err.str()};
}

TEST(ReportCommandTest, WritesIntoTheRunsFolderAndReplacesItsOwnPage) {
  const TempDir dir;
  const std::string folder = two_frames().write(dir).string();
  for (int i = 0; i < 2; ++i) {
    const auto done = fovea({"report", folder});
    EXPECT_EQ(done.status, kExitDone) << done.err;
    EXPECT_EQ(done.out, "report in " + folder + "/report.html\n");
  }
  EXPECT_THAT(test::read_text(folder + "/report.html"),
              HasSubstr("<title>run - Fovea report</title>"));
}

TEST(ReportCommandTest, RefusesToReplaceAnythingElse) {
  const TempDir dir;
  const std::string folder = two_frames().write(dir).string();
  const std::string mine = dir.write("mine.html", "<html>").string();
  const auto refused = fovea({"report", folder, "-o", mine});
  EXPECT_EQ(refused.status, kExitWrongInput);
  EXPECT_THAT(refused.err, HasSubstr("it exists and is not a report of Fovea"));
  EXPECT_EQ(test::read_text(mine), "<html>");
}

constexpr const char* kBinds =
    "firmware.kernel,at,resource,binds,gain,metric,plain,reference,relaxed,unit,by,settings,remark,"
    "origin,gain_low,gain_high\n"
    "plain,,bridge_arm_d,yes,0.125,frame.remap_time.mean,0.01,0.01,0.00875,s,run,bus.arm_d.request_latency=0 cycles,,"
    "assumed,0.0812,0.31\n"
    "plain,,refresh,no,0.02,frame.remap_time.mean,0.01,0.0101,0.0099,s,replay,--without vpbe,,choice,,\n"
    "plain,,edma_depth,,,frame.remap_time.mean,0.01,,,s,run,edma.tc.outstanding=16,no traffic,family,,\n"
    "staged,,dcache,yes,0.5,frame.remap_time.mean,0.002,0.002,0.001,s,run,x=1,,choice,,\n";

TEST(ReportCommandTest, SaysWhatBindsFromTheAnswersAboutTheSameRun) {
  const TempDir dir;
  const std::string folder = two_frames().write(dir).string(), limits = (dir / "limits").string();
  dir.write("limits/binds.csv", kBinds);
  const auto text = fovea({"report", folder, "--text", "--limits", limits});
  EXPECT_EQ(text.status, kExitDone) << text.err;
  EXPECT_THAT(text.out,
              HasSubstr("What binds frame.remap_time.mean, as runs show in which it alone is relaxed: "
                        "bridge_arm_d (12 % better; assumed: 8.1 % to 31 %); 1 of the "
                        "2 resources that were relaxed change it by less.\n"
                        "    from binds.csv"));
  EXPECT_EQ(fovea({"report", folder, "--limits", limits}).status, kExitDone);
  const std::string page = test::read_text(folder + "/report.html");
  EXPECT_THAT(page, HasSubstr("<section id=\"binds\""));
  EXPECT_THAT(page, HasSubstr("<data value=\"0.00875\">8.75 ms</data>"));
  EXPECT_THAT(page, HasSubstr("no traffic"));
  EXPECT_THAT(page, HasSubstr("assumed: 8.1 % to 31 %"));
  EXPECT_THAT(page, ::testing::Not(HasSubstr("x=1"))) << "of another run";
  EXPECT_EQ(fovea({"report", folder}).status, kExitDone);
  EXPECT_THAT(test::read_text(folder + "/report.html"), ::testing::Not(HasSubstr("id=\"binds\"")));
}

TEST(ReportCommandTest, AnswersAboutOtherRunsAndDamagedOnesAreRefused) {
  const TempDir dir;
  const std::string folder = two_frames().write(dir).string();
  const std::string all = kBinds, head = all.substr(0, all.find('\n') + 1);
  const std::pair<std::string, const char*> cases[] = {
      {head + all.substr(all.find("staged")), "it is about runs with frame.remap_time.mean = 0.002"},
      {head + "plain,,x\n", "binds.csv:2: 3 fields; the header has 16"},
      {head + "plain,,x,yes,much,frame.remap_time.mean,0.01,0.01,0.01,s,run,,,,,\n",
       "binds.csv:2: 'much' is not a number"},
      {"resource,binds\n", "binds.csv:1: there is no column 'metric'"},
      {"", "the header is missing"}};
  for (const auto& [contents, message] : cases) {
    dir.write("limits/binds.csv", contents);
    const auto refused = fovea({"report", folder, "--text", "--limits", (dir / "limits").string()});
    EXPECT_EQ(refused.status, kExitWrongInput) << message;
    EXPECT_THAT(refused.err, HasSubstr(message));
  }
  EXPECT_THAT(fovea({"report", folder, "--limits", folder}).err, HasSubstr("it has no binds.csv"));
}

TEST(ReportCommandTest, BadFoldersAreStatusTwoAndOneLine) {
  const TempDir dir;
  HandMade partial = two_frames(), other = two_frames();
  partial.complete = false;
  other.version = "7";
  fs::create_directory(dir / "empty");
  for (const auto& folder :
       {dir / "empty", partial.write(dir, "partial"), other.write(dir, "other"), dir / "none"}) {
    const auto refused = fovea({"report", folder.string()});
    EXPECT_EQ(refused.status, kExitWrongInput) << folder;
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
    EXPECT_FALSE(fs::exists(folder / "report.html"));
  }
  EXPECT_EQ(fovea({"report", (dir / "partial").string(), "--partial"}).status, kExitDone);
  EXPECT_EQ(fovea({"report", (dir / "other").string(), "--across-versions"}).status, kExitDone);
}

TEST(ReportCommandTest, EightRunsAndNoMore) {
  const TempDir dir;
  std::vector<std::string> args{"report", "-o", (dir / "all.html").string()};
  for (int i = 0; i < 8; ++i)
    args.push_back(two_frames().write(dir, "run" + std::to_string(i)).string());
  EXPECT_EQ(fovea(args).status, kExitDone);
  args.push_back(args.back());
  const auto refused = fovea(args);
  EXPECT_EQ(refused.status, kExitWrongInput);
  EXPECT_THAT(refused.err, HasSubstr("report: 9 folders; allowed: 1 to 8"));
}

TEST(ReportCommandTest, TextGoesToTheOutput) {
  const TempDir dir;
  const std::string folder = two_frames().write(dir).string();
  const auto done = fovea({"report", "--text", folder});
  EXPECT_EQ(done.status, kExitDone);
  EXPECT_THAT(done.out, HasSubstr("run\nframe rate met"));
  EXPECT_FALSE(fs::exists(folder + "/report.html"));
  EXPECT_EQ(fovea({"report", "--text", folder, "-o", "x"}).status, kExitWrongInput);
}

TEST(ReportCommandTest, RunMakesAPageThatTheNextRunReplaces) {
  const TempDir dir;
  const std::string experiment = dir.write("e.yaml", "run:\n  frames: 2\n").string(),
                    out = (dir / "out").string();
  const auto first = fovea({"run", experiment, "-o", out, "--report"});
  EXPECT_EQ(first.status, kExitDone) << first.err;
  EXPECT_THAT(first.out, HasSubstr("report in " + out + "/report.html\n"));
  const std::string page = test::read_text(out + "/report.html");
  EXPECT_THAT(page, HasSubstr("<title>out - Fovea report</title>"));
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,"));
  EXPECT_EQ(fovea({"run", experiment, "-o", out}).status, kExitDone);
  EXPECT_FALSE(fs::exists(out + "/report.html"));
}

TEST(ReportCommandTest, AFailedRunHasAPageThatSaysSo) {
  const TempDir dir;
  const std::string experiment = dir.write("e.yaml", "run:\n  mode: late_failure\n").string(),
                    out = (dir / "out").string();
  EXPECT_EQ(fovea({"run", experiment, "-o", out, "--report"}).status, kExitGuestFailed);
  EXPECT_THAT(test::read_text(out + "/report.html"), HasSubstr("These results are partial"));
}

}  // namespace
}  // namespace fovea::app
