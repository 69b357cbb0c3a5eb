// `fovea trend`: lines, what is refused, jumps, and the picture.
#include "sw/fovea/regression/trend.h"

#include <sqlite3.h>

#include <cstdlib>

#include "tb/regression/command_fixture.h"

namespace fovea::regression {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::TempDir;
using test::user_error;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using TrendCommandTest = RegressionCommandTest;

TEST_F(TrendCommandTest, TrendKeepsOneLineForEachCommit) {
  const std::string db = (dir / "t.db").string(), svg = (dir / "t.svg").string();
  EXPECT_EQ(cli({"trend", "--database", db, "--plot", svg}), 2);
  EXPECT_EQ(cli({"trend", "--database", db}), 2);
  ASSERT_EQ(cli({"trend", a, "--database", db, "--commit", "one", "--host-instructions", "90.5"}), 0) << err.str();
  EXPECT_THAT(out.str(), Not(HasSubstr("host instructions")));
  ASSERT_EQ(cli({"trend", a, "--database", db, "--commit", "two"}), 0) << err.str();
  EXPECT_THAT(out.str(), HasSubstr("two, without the simulator's host instructions: the host did not count them"));
  ASSERT_EQ(cli({"trend", b, "--database", db, "--commit", "three"}), 0);
  // A commit that was measured again keeps its place.
  ASSERT_EQ(cli({"trend", b, "--database", db, "--commit", "one", "--host-instructions", "91", "--plot", svg}), 0);
  // Where the host counts, the run itself says it; the option has precedence.
  dir.write("b/host.json", "{\"host_instructions\": {\"value\": 77.25, \"unit\": \"1\"}}\n");
  ASSERT_EQ(cli({"trend", b, "--database", db, "--commit", "three"}), 0);
  const auto lines = TrendFile(db).lines("");
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[2].host_instructions, 77.25);
  EXPECT_EQ(lines[0].commit, "one");
  EXPECT_EQ(lines[0].host_instructions, 91);
  EXPECT_EQ(lines[0].figures.at("frame.remap_time.mean").value, 0.0042);
  EXPECT_EQ(lines[1].commit, "two");
  EXPECT_EQ(lines[1].host_instructions, std::nullopt);
  EXPECT_EQ(lines[1].figures.at("cpu.cycles").value, 1000);
  EXPECT_TRUE(lines[1].figures.at("cpu.cycles").whole);
  EXPECT_EQ(lines[1].figures.at("cpu.cycles").unit, "cycles");
  EXPECT_EQ(TrendFile(db).lines("other").size(), 0u);
  EXPECT_THAT(read_text(svg), AllOf(HasSubstr("<svg"), HasSubstr("frame.remap_time.mean"),
                                    HasSubstr("host instructions"), HasSubstr("three tiny: 4.2 ms")));
  EXPECT_EQ(cli({"trend", "--database", db, "--plot", svg, "--figure", "no.such"}), 2);
}

// Two builds of one commit, and two firmwares under one name: the line of the first one is not lost.
TEST_F(TrendCommandTest, ALineOfAnotherProgramIsNotReplaced) {
  const std::string db = (dir / "t.db").string();
  const std::vector<std::string> words = {"--database", db, "--commit", "one"};
  const auto add = [&](const std::string& folder, std::vector<std::string> more = {}) {
    std::vector<std::string> args = {"trend", folder};
    args.insert(args.end(), words.begin(), words.end());
    args.insert(args.end(), more.begin(), more.end());
    return cli(args);
  };
  ASSERT_EQ(add(a), 0) << err.str();
  ASSERT_EQ(add(b), 0) << "the same program, run again";
  slow.elf = "22";
  const std::string c = slow.write(dir, "c").string();
  EXPECT_EQ(add(c), 2);
  EXPECT_THAT(err.str(),
              AllOf(HasSubstr("a line of commit one and tiny with another program (SHA-256 11; this one: SHA-256 22)"),
                    HasSubstr("--commit NAME"), HasSubstr("--replace")));
  EXPECT_EQ(TrendFile(db).lines("").at(0).program, "11");
  ASSERT_EQ(add(c, {"--replace"}), 0) << err.str();
  EXPECT_EQ(TrendFile(db).lines("").at(0).program, "22");
  ASSERT_EQ(cli({"trend", a, "--database", db, "--commit", "two"}), 0);
  // A program whose hash is not known cannot be said to be the same.
  slow.elf = "";
  const std::string unknown = slow.write(dir, "unknown").string();
  EXPECT_EQ(add(unknown), 2);
  EXPECT_THAT(err.str(), HasSubstr("this one: not known"));
  EXPECT_EQ(TrendFile(db).lines("").size(), 2u);
}

TEST_F(TrendCommandTest, AFileOfAnEarlierVersionIsContinued) {
  const std::string db = (dir / "t.db").string();
  sqlite3* file = nullptr;
  ASSERT_EQ(sqlite3_open(db.c_str(), &file), SQLITE_OK);
  for (const char* sql :
       {"PRAGMA application_id = 1179604564",
        "CREATE TABLE runs (number INTEGER PRIMARY KEY, commit_name TEXT NOT NULL, experiment TEXT NOT NULL, simulator "
        "TEXT "
        "NOT NULL, host_instructions REAL, figures TEXT NOT NULL, units TEXT NOT NULL, UNIQUE (commit_name, "
        "experiment))",
        "INSERT INTO runs VALUES (1, 'one', 'tiny', 's', NULL, '{\"cpu.cycles\": 7}', '{\"cpu.cycles\": \"cycles\"}')"})
    ASSERT_EQ(sqlite3_exec(file, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sql;
  sqlite3_close(file);
  EXPECT_EQ(cli({"trend", a, "--database", db, "--commit", "one"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("with another program (not known"));
  ASSERT_EQ(cli({"trend", a, "--database", db, "--commit", "two"}), 0) << err.str();
  const auto lines = TrendFile(db).lines("");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].figures.at("cpu.cycles").value, 7);
  EXPECT_EQ(lines[1].program, "11");
  // What another program has written there.
  ASSERT_EQ(sqlite3_open(db.c_str(), &file), SQLITE_OK);
  const std::string deep = "UPDATE runs SET figures = '" + std::string(100'000, '[') + "'";
  ASSERT_EQ(sqlite3_exec(file, deep.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(file);
  EXPECT_THAT(user_error([&] { TrendFile(db).lines(""); }), HasSubstr("cannot be read"));
}

// SQLite has names that are no files; here they are.
TEST_F(TrendCommandTest, APathIsAPath) {
  EXPECT_EQ(cli({"trend", a, "--database", "", "--commit", "one"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("--database '': a file name is needed"));
  const fs::path before = fs::current_path();
  fs::create_directory(dir / "here");
  fs::current_path(dir / "here");
  for (const char* name : {":memory:", "file:x?mode=memory", "file::memory:?cache=shared", "plain.db", "file:y"}) {
    EXPECT_EQ(cli({"trend", a, "--database", name, "--commit", "one"}), 0) << name << err.str();
    EXPECT_TRUE(fs::exists(dir / "here" / name)) << name;
    EXPECT_EQ(TrendFile(name).lines("").size(), 1u) << name;
  }
  fs::current_path(before);
}

// The state of the program is that of its repository, which is the current folder's, not Fovea's.
TEST_F(TrendCommandTest, TheCommitIsThatOfTheCurrentFolder) {
  const std::string db = (dir / "t.db").string();
  const fs::path before = fs::current_path();
  fs::create_directory(dir / "repository");
  fs::current_path(dir / "repository");
  ::setenv("GIT_CEILING_DIRECTORIES", fs::canonical(dir / "repository").parent_path().c_str(), 1);
  EXPECT_EQ(cli({"trend", a, "--database", db}), 2);
  EXPECT_THAT(err.str(), HasSubstr("--commit is missing: the current folder is in no git repository"));
  dir.write("repository/f.c", "int x;\n");
  ASSERT_EQ(std::system("git init -q . && git add f.c && git -c user.name=n -c user.email=e commit -q -m c && "
                        "git rev-parse --short=12 HEAD >../head"),
            0);
  std::string head = read_text(dir / "head");
  head.pop_back();
  EXPECT_EQ(cli({"trend", a, "--database", db}), 0) << err.str();
  EXPECT_THAT(out.str(), HasSubstr("tiny of commit " + head + ", the current folder's"));
  EXPECT_EQ(TrendFile(db).lines("").at(0).commit, head);
  dir.write("repository/f.c", "int y;\n");
  EXPECT_EQ(cli({"trend", a, "--database", db}), 0) << err.str();
  EXPECT_EQ(TrendFile(db).lines("").at(1).commit, head + "-modified");
  ::unsetenv("GIT_CEILING_DIRECTORIES");
  fs::current_path(before);
}

TEST_F(TrendCommandTest, AJumpIsMarkedAndBlamed) {
  const std::string db = (dir / "t.db").string(), svg = (dir / "t.svg").string();
  RunMaker near = profiled();
  near.figure("frame.remap_time.mean", "0.00404", "s");  // 1 %: no jump
  ASSERT_EQ(cli({"trend", a, "--database", db, "--commit", "one"}), 0);
  ASSERT_EQ(cli({"trend", near.write(dir, "near").string(), "--database", db, "--commit", "two"}), 0);
  EXPECT_THAT(out.str(), Not(HasSubstr("jumps")));
  ASSERT_EQ(cli({"trend", b, "--database", db, "--commit", "three", "--plot", svg}), 0) << err.str();
  EXPECT_THAT(out.str(),
              AllOf(HasSubstr("  frame.remap_time.mean jumps from 4.04 ms of commit two to 4.2 ms (+4.0 %)\n"),
                    HasSubstr("  blamed: remap (remap.c:21) waits with the same instructions: +20 clocks")));
  EXPECT_THAT(read_text(svg), AllOf(HasSubstr("class=\"jump\""), HasSubstr(">+4.0 %</text>")));
  ASSERT_EQ(cli({"trend", b, "--database", db, "--commit", "three", "--tolerance", "5%", "--plot", svg}), 0);
  EXPECT_THAT(out.str(), Not(HasSubstr("jumps")));
  EXPECT_THAT(read_text(svg), Not(HasSubstr("class=\"jump\"")));
  // Another experiment has its own neighbours.
  RunMaker other = slow;
  other.experiment = "other";
  other.figure("frame.remap_time.mean", "0.1", "s");
  ASSERT_EQ(cli({"trend", other.write(dir, "other").string(), "--database", db, "--commit", "three"}), 0);
  EXPECT_THAT(out.str(), Not(HasSubstr("jumps")));
  // The results of the line before are gone, or have no profile.
  RunMaker slower = slow;
  slower.figure("frame.remap_time.mean", "0.005", "s");
  const std::string c = slower.write(dir, "c").string();
  fs::remove(dir / "b/profile.csv");
  ASSERT_EQ(cli({"trend", c, "--database", db, "--commit", "four"}), 0);
  EXPECT_THAT(out.str(), AllOf(HasSubstr("jumps from 4.2 ms"), HasSubstr("blamed: not known, because '"),
                               HasSubstr("b' has no profile")));
  profiled().write(dir, "b");
  ASSERT_EQ(cli({"trend", c, "--database", db, "--commit", "four"}), 0);
  EXPECT_THAT(out.str(), HasSubstr("b' no longer has the results of commit three"));
}

// The picture places values in proportion: 1, 2 and 3 lie on a straight line.
std::size_t occurrences(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != text.npos; at = text.find(what, at + what.size())) ++n;
  return n;
}

TEST(TrendPlotTest, CurvesAreInProportion) {
  std::vector<TrendLine> lines;
  for (const int i : {1, 2, 3})
    lines.push_back({"c" + std::to_string(i), "<e>", "s", {}, {{"x", {static_cast<double>(i), "1", true}}}});
  const std::string svg = trend_svg(lines, {"x", "y"}, {});
  // 720 wide from 96 on; 110 high from 64 on; 10 % are left free at the ends.
  EXPECT_THAT(svg, HasSubstr("<path d=\"M96.0 169.0L456.0 119.0L816.0 69.0\""));
  EXPECT_THAT(svg, AllOf(HasSubstr("&lt;e&gt;"), Not(HasSubstr("<e>")), Not(HasSubstr(">y<"))));
  EXPECT_THAT(svg, Not(HasSubstr("change since"))) << "one experiment: values";
  // The middle, 2, stands at half of 110; letters stand on a line 4 below.
  EXPECT_THAT(svg, AllOf(HasSubstr("y1=\"119.0\" y2=\"119.0\""),
                         HasSubstr("<text x=\"88\" y=\"123.0\" text-anchor=\"end\" fill=\"#404040\">2</text>")));
}

// Several experiments: as changes. 10 -> 11 and 1,000 -> 900 are +10 % and -10 % of the same panel.
TEST(TrendPlotTest, CurvesOfSeveralExperimentsAreChanges) {
  std::vector<TrendLine> lines;
  for (const auto& [commit, experiment, value] :
       {std::tuple("c1", "a", 10.0), {"c1", "b", 1000.0}, {"c2", "a", 11.0}, {"c2", "b", 900.0}})
    lines.push_back({commit, experiment, "s", {}, {{"x", {value, "1", true}}}});
  const std::string svg = trend_svg(lines, {"x"}, {});
  EXPECT_THAT(svg, AllOf(HasSubstr("change since the first commit"), HasSubstr("M96.0 119.0L816.0 69.0"),
                         HasSubstr("M96.0 119.0L816.0 169.0"), HasSubstr("c2 b: 900")));
  // The legend: each experiment once, 30 and 7.5 for each letter apart.
  EXPECT_THAT(svg,
              AllOf(HasSubstr("<text x=\"106\" y=\"22\">a</text>"), HasSubstr("<text x=\"144\" y=\"22\">b</text>")));
  EXPECT_EQ(occurrences(svg, "y=\"22\""), 2u);
}

// What hardly changes is drawn in the middle: the panel then has half a per cent to each side, of which 90 % are named.
TEST(TrendPlotTest, CurvesThatDoNotChangeAreDrawnInTheMiddle) {
  std::vector<TrendLine> lines;
  for (const char* commit : {"c1", "c2"})
    for (const char* experiment : {"a", "b"}) lines.push_back({commit, experiment, "s", {}, {{"x", {7.0, "1", true}}}});
  const std::string svg = trend_svg(lines, {"x"}, {});
  EXPECT_THAT(svg, AllOf(HasSubstr("M96.0 119.0L816.0 119.0"), HasSubstr(">+0.45 %<"), HasSubstr(">-0.45 %<")));
}

// Hashes are cut as git does; of other names 14 letters fit.
TEST(TrendPlotTest, LongNamesOfCommitsAreCut) {
  const auto label = [](const std::string& commit) {
    const std::string svg = trend_svg({{commit, "e", "s", {}, {{"x", {5.0, "1", true}}}}}, {"x"}, {});
    const auto end = svg.rfind("</text>"), begin = svg.rfind('>', end - 1) + 1;
    return svg.substr(begin, end - begin);
  };
  EXPECT_EQ(label("0123456789abcdef"), "012345678");
  EXPECT_EQ(label("abcdef012"), "abcdef012");
  EXPECT_EQ(label("fourteen-chars"), "fourteen-chars");
  EXPECT_EQ(label("fifteen-letters"), "fifteen-lette…");
}

TEST(TrendPlotTest, ASingleCommitStandsInTheMiddle) {
  const std::string svg = trend_svg({{"c1", "e", "s", {}, {{"x", {5.0, "1", true}}}}}, {"x"}, {});
  EXPECT_THAT(svg, HasSubstr("<circle cx=\"456.0\""));  // 96 and half of 720
}

}  // namespace
}  // namespace fovea::regression
