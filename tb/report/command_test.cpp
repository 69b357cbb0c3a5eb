// `fovea report` and `fovea run --report` as they are typed.
#include "sw/fovea/cli.h"
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
  const CliContext context{.out = out, .err = err, .make_simulation = [] {
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
