// First baselines: what is in them, what they allow, results of every command, and names of every kind.
#include "sw/fovea/regression/first_baseline.h"

#include "sw/fovea/regression/check.h"
#include "tb/regression/command_fixture.h"

namespace fovea::regression {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::user_error;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class FirstBaselineTest : public RegressionCommandTest {
 protected:
  /// Begins base.yaml with `first`, and checks `second` against it.
  int judged(const RunMaker& first, const RunMaker& second, std::vector<std::string> options = {}) {
    fs::remove(base);
    std::vector<std::string> words = {"bless", first.write(dir, "one").string(), "--against", base, "--why", "x"};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(cli(words), 0) << err.str();
    return cli({"check", second.write(dir, "two").string(), "--against", base});
  }
  static RunMaker with(const std::string& name, const std::string& value, const std::string& unit) {
    return profiled().figure(name, value, unit);
  }
};

TEST_F(FirstBaselineTest, OnePerCentOfACostPassesAndMoreFails) {
  const auto start = [](const char* value) { return with("startup.first_frame", value, "s"); };
  EXPECT_EQ(judged(start("0.5"), start("0.505")), 0) << out.str();
  EXPECT_EQ(judged(start("0.5"), start("0.505001")), 1);
  EXPECT_THAT(out.str(), HasSubstr("FAILED  startup.first_frame    505 ms, baseline 500 ms (+5.001 ms, +1.0 %)"));
  EXPECT_EQ(judged(start("0.5"), start("0.4")), 0) << "faster is not worse";
  // Clocks that are left: one per cent of the 700 busy ones.
  EXPECT_EQ(judged(profiled(), with("cpu.spare", "293", "cycles")), 0) << out.str();
  EXPECT_EQ(judged(profiled(), with("cpu.spare", "292", "cycles")), 1);
  EXPECT_EQ(judged(start("0.5"), start("0.5001"), {"--tolerance", "0"}), 1);
  EXPECT_EQ(judged(start("0.5"), start("0.51"), {"--tolerance", "2%"}), 0) << out.str();
  EXPECT_EQ(judged(start("0.5"), start("0.511"), {"--tolerance", "2%"}), 1);
}

TEST_F(FirstBaselineTest, ALossHasNoTolerance) {
  for (const char* loss : {"frame.dropped", "frame.repeated", "capture.overflows", "display.underflows"}) {
    EXPECT_EQ(judged(with(loss, "1000", "1"), with(loss, "1000", "1")), 0) << loss << out.str();
    EXPECT_EQ(judged(with(loss, "1000", "1"), with(loss, "1001", "1")), 1) << loss;
  }
}

// A program that waits by polling executes more instructions when it is faster; conflicts cost time, which is there.
TEST_F(FirstBaselineTest, WhatIsNoCostIsNotInIt) {
  const auto busy = [](const char* n) {
    return with("cpu.instructions", n, "1").figure("ddr.row_conflicts", n).figure("cpu.cycles", n, "cycles");
  };
  RunMaker more = busy("1500");
  more.stalls.clear();
  more.profile.clear();
  EXPECT_EQ(judged(busy("1000"), more), 0) << out.str();
  for (const char* name : {"cpu.instructions", "ddr.row_conflicts", "cpu.cycles"})
    EXPECT_THAT(read_text(base), Not(HasSubstr(name)));
}

// Without frames, the clocks from power-up to the end are the cost.
TEST_F(FirstBaselineTest, ClocksAreACostWhereThereAreNoFrames) {
  RunMaker whole = profiled(), longer = profiled();
  for (RunMaker* r : {&whole, &longer}) r->figures.erase("frame.remap_time.mean");
  longer.figure("cpu.cycles", "1011", "cycles");
  longer.stalls.clear();
  longer.profile.clear();
  EXPECT_EQ(judged(whole, longer), 1);
  EXPECT_THAT(out.str(), HasSubstr("FAILED  cpu.cycles"));
}

TEST_F(FirstBaselineTest, LayoutsGiveTwiceTheirLargestDeviation) {
  RunMaker first = with("startup.first_frame", "0.5", "s");
  const auto layout = [&](const char* name, const char* start, const char* hash) {
    RunMaker r = with("startup.first_frame", start, "s");
    r.elf = hash;
    return r.write(dir, name).string();
  };
  const std::string up = layout("up", "0.5012", "22"), down = layout("down", "0.4985", "33");
  // 0.3 % in the largest deviation: 0.6 % are allowed.
  const std::vector<std::string> both = {"--layout", up, "--layout", down};
  EXPECT_EQ(judged(first, with("startup.first_frame", "0.503", "s"), both), 0) << out.str();
  EXPECT_THAT(read_text(base), AllOf(HasSubstr("tolerance: 0.6%"), HasSubstr("of 2 other layouts of the program")));
  EXPECT_EQ(judged(first, with("startup.first_frame", "0.5031", "s"), both), 1);
  // The remap's time is the same in all of them.
  EXPECT_EQ(judged(first, with("frame.remap_time.mean", "0.0040001", "s"), both), 1);
  fs::remove(base);
  const auto refused = [&](const std::string& folder, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"bless", (dir / "one").string(), "--against", base, "--why", "x", "--layout",
                                      folder};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(cli(words), 2) << folder;
    EXPECT_FALSE(fs::exists(base));
    return err.str();
  };
  EXPECT_THAT(refused(layout("same", "0.5", "11")), HasSubstr("is the same program as"));
  RunMaker other = first;
  other.elf = "44";
  other.parameters["ddr.clock"] = "216MHz";
  EXPECT_THAT(refused(other.write(dir, "other").string()), HasSubstr("has other settings or inputs"));
  other.experiment = "small";
  EXPECT_THAT(refused(other.write(dir, "other").string()), HasSubstr("is of experiment 'small'"));
  EXPECT_THAT(refused(up, {"--tolerance", "1%"}), HasSubstr("exclude each other"));
}

TEST_F(FirstBaselineTest, TolerancesOfABaselineThatIsThereAreChangedByHand) {
  ASSERT_EQ(cli({"bless", a, "--against", base, "--why", "x"}), 0);
  const std::string before = read_text(base);
  EXPECT_EQ(cli({"bless", b, "--against", base, "--why", "x", "--tolerance", "2%"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("changed by hand"));
  EXPECT_EQ(read_text(base), before);
}

RunMaker executed(const std::string& cycles) {
  RunMaker r = profiled();
  r.figures = {};
  r.experiment = "";
  r.command = "exec";
  r.input = "app.elf";
  r.words = R"("arguments": ["10", "-v"], "options": ["--board"],)";
  r.figure("cpu.cycles", cycles, "cycles").figure("cpu.instructions", "300").figure("exec.status", "0");
  r.profile.clear();
  r.stalls.clear();
  return r;
}

TEST_F(FirstBaselineTest, AProgramOfExecHasAGate) {
  EXPECT_EQ(judged(executed("1000"), executed("1010")), 0) << out.str();
  EXPECT_THAT(read_text(base),
              AllOf(HasSubstr("program: app.elf\narguments: [\"10\", \"-v\"]\noptions: [\"--board\"]\n"),
                    Not(HasSubstr("experiment")), Not(HasSubstr("run.frames"))));
  EXPECT_EQ(judged(executed("1000"), executed("1011")), 1);
  EXPECT_THAT(out.str(), HasSubstr("FAILED: app.elf 10 -v --board against"));
  RunMaker other = executed("1000");
  other.words = R"("arguments": ["11", "-v"], "options": ["--board"],)";
  EXPECT_EQ(cli({"check", other.write(dir, "other").string(), "--against", base}), 2);
  EXPECT_THAT(err.str(), HasSubstr("other' is of program 'app.elf 11 -v' with --board"));
  EXPECT_THAT(err.str(), HasSubstr("base.yaml is for program 'app.elf 10 -v' with --board"));
  EXPECT_EQ(cli({"check", a, "--against", base}), 2);
  EXPECT_THAT(err.str(), HasSubstr("is of experiment 'tiny'"));
  EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "x"}), 2);
  // A result of a version that did not name its program.
  other.command = other.input = "";
  other.words = "";
  other.write(dir, "old");
  std::string config = read_text(dir / "old/config.json");
  config.replace(config.find("firmware.elf"), 12, "program");
  dir.write("old/config.json", config);
  EXPECT_EQ(cli({"bless", (dir / "old").string(), "--against", (dir / "n.yaml").string(), "--why", "x"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("does not name its program"));
}

TEST_F(FirstBaselineTest, AReplayHasAGate) {
  const auto replayed = [](const char* time) {
    RunMaker r = executed("0");
    r.command = "replay";
    r.input = "pal.trace";
    r.words = R"("arguments": [], "options": ["--wrap"],)";
    r.figures = {};
    return r.figure("replay.time", time, "s").figure("frame.remap_time.mean", "0.02", "s");
  };
  EXPECT_EQ(judged(replayed("0.08"), replayed("0.0808")), 0) << out.str();
  EXPECT_THAT(read_text(base), HasSubstr("trace: pal.trace\noptions: [\"--wrap\"]\n"));
  EXPECT_EQ(judged(replayed("0.08"), replayed("0.0809")), 1);
  EXPECT_EQ(cli({"check", executed("1").write(dir, "exec").string(), "--against", base}), 2);
}

TEST_F(FirstBaselineTest, SubjectsThatDoNotGoTogetherAreRefused) {
  const auto error = [&](const std::string& subject) {
    const auto file =
        dir.write("s.yaml", "format: fovea baseline 1\n" + subject +
                                "simulator: {version: 1, commit: c}\nmetrics:\n  a: {value: 1, unit: s}\n");
    return user_error([&] { read_baseline(file); });
  };
  EXPECT_THAT(error("experiment: e\nprogram: p\n"), HasSubstr("s.yaml:3: one of 'experiment', 'program' and 'trace'"));
  EXPECT_THAT(error("experiment: e\narguments: [x]\n"), HasSubstr("'arguments' does not go with 'experiment'"));
  EXPECT_THAT(error("trace: e\narguments: [x]\n"), HasSubstr("'arguments' does not go with 'trace'"));
  EXPECT_THAT(error("experiment: e\noptions: [x]\n"), HasSubstr("'options' does not go with 'experiment'"));
  EXPECT_THAT(error("program: e\noptions: x\n"), HasSubstr("'options' is not a list of words"));
  EXPECT_THAT(error("program: e\noptions: [[x]]\n"), HasSubstr("'options' is not a list of words"));
  EXPECT_THAT(error(""), HasSubstr("'experiment' is missing"));
  const Baseline good = read_baseline(dir.write("s.yaml",
                                                "format: fovea baseline 1\nprogram: e\noptions: [x]\n"
                                                "arguments: [y, 1]\nsimulator: {version: 1, commit: c}\n"
                                                "metrics:\n  a: {value: 1, unit: s}\n"));
  EXPECT_EQ(good.subject, (Subject{ResultKind::kExec, "e", {"y", "1"}, {"x"}}));
}

// What YAML could take for something else is written so that it is read back as it was.
TEST_F(FirstBaselineTest, NamesOfEveryKindAreReadBack) {
  for (const char* name : {"pal #2", "'q'", "a: b", "[x]", "*s", "&s", "@x", "%x",  "null", "~",   "1",  "true",
                           "- a",    "a,b", "{x}",  "!t",  "|",  ">",  "#",  "`x`", "é",    "a'b", "x:", "? y"}) {
    RunMaker r = profiled();
    r.experiment = name;
    EXPECT_EQ(judged(r, r), 0) << name << ": " << err.str();
    RunMaker program = executed("10");
    program.input = name;
    program.words = fmt::format(R"("arguments": ["{}", ""], "options": [],)", name);
    EXPECT_EQ(judged(program, program), 0) << name << ": " << err.str();
  }
  for (const char* name : {"p #2", "a: b", "*s"}) {
    base = (dir / (std::string(name) + ".yaml")).string();
    EXPECT_EQ(judged(profiled(), profiled()), 0) << name << ": " << err.str();
    EXPECT_TRUE(fs::exists(dir / (std::string(name) + "/figures.csv")));
  }
}

// As people write it: with brackets, without anything, with other indents.
TEST_F(FirstBaselineTest, AHistoryOfAnyFormIsContinued) {
  const std::string head =
      "format: fovea baseline 1\nexperiment: tiny\nsimulator: {version: 0.1.0, commit: aaaaaaaaaaaa}\n"
      "metrics:\n  cpu.idle: {value: 299, unit: cycles}\n";
  const std::string entry = "- commit: aaaaaaaaaaaa\n";
  const auto blessed = [&](const std::string& history) {
    dir.write("base.yaml", head + history);
    EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "x"}), 0) << history << err.str();
    EXPECT_EQ(cli({"bless", b, "--against", base, "--why", "y"}), 0) << history << err.str();
    return read_text(base).substr(head.size());
  };
  const std::string two =
      "  - commit: aaaaaaaaaaaa\n    why: \"x\"\n    changes: |\n      cpu.idle: 299 -> 300\n"
      "  - commit: aaaaaaaaaaaa\n    why: \"y\"\n    changes: |\n      cpu.idle: 300 -> 280\n";
  EXPECT_EQ(blessed(""), "history:\n" + two);
  EXPECT_EQ(blessed("history: []\n"), "history: \n" + two);
  EXPECT_EQ(blessed("history: []   # none\n"), "history:    # none\n" + two);
  EXPECT_EQ(blessed("history: [ ]"), "history: \n" + two);
  EXPECT_EQ(blessed("history:\n"), "history:\n" + two);
  EXPECT_EQ(blessed("history: null\n"), "history: \n" + two);
  EXPECT_EQ(blessed("history: ~  # none\n"), "history:   # none\n" + two);
  const std::string old = "history:\n- commit: c\n  why: w\n";
  EXPECT_EQ(blessed(old).substr(0, old.size() + entry.size()), old + entry);
  const std::string wide = "history:\n      - commit: c\n        why: w\n";
  EXPECT_EQ(blessed(wide).substr(0, wide.size() + 6 + entry.size()), wide + "      " + entry);
  const std::string brackets = head + "history: [{commit: c, why: w}]\n";
  dir.write("base.yaml", brackets);
  EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "x"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("base.yaml:6: 'history' has entries in brackets"));
  EXPECT_EQ(read_text(base), brackets);
}

// The largest failure stands first, what passes last.
TEST_F(FirstBaselineTest, FailuresAreSortedBySize) {
  RunMaker one = profiled(), two = profiled();
  const auto set = [&](const char* name, const char* before, const char* after, const char* unit) {
    one.figure(name, before, unit);
    two.figure(name, after, unit);
  };
  set("frame.rate", "25", "24", "1/s");                 // -4 %
  set("frame.latency.mean", "0.08", "0.1", "s");        // +25 %
  set("frame.dropped", "0", "3", "1");                  // from nothing
  set("startup.first_frame", "0.5", "0.4", "s");        // better
  set("startup.lut_time", "0.1", "0.1", "s");           // the same
  set("frame.remap_time.max", "0.004", "0.0041", "s");  // +2.5 %
  EXPECT_EQ(judged(one, two), 1);
  std::vector<std::string> order;
  std::istringstream lines(out.str());
  for (std::string word, name, line; std::getline(lines, line);)
    if (std::istringstream words(line); words >> word >> name && (word == "FAILED" || word == "better"))
      order.push_back(name);
  EXPECT_THAT(order, testing::ElementsAre("frame.dropped", "frame.latency.mean", "frame.rate", "frame.remap_time.max",
                                          "startup.first_frame"));
}

TEST_F(FirstBaselineTest, FiveLinesForAMergeRequest) {
  ASSERT_EQ(cli({"bless", a, "--against", base, "--why", "x"}), 0);
  const std::string file = (dir / "mr.md").string();
  EXPECT_EQ(cli({"check", b, "--against", base, "--markdown", file}), 1);
  EXPECT_EQ(read_text(file),
            "- **figure**: `frame.remap_time.mean` of `tiny` is worse\n- **before**: 4 ms\n"
            "- **after**: 4.2 ms (+5.0 %; allowed: 1.0 % higher)\n- **who**: `remap (remap.c:21)`\n"
            "- **why**: waits with the same instructions: +20 clocks (100 % of the change), of which +20 clocks by "
            "dcache, region lut, culprit vpbe\n");
  EXPECT_EQ(cli({"check", b, "--against", base, "--markdown", "-"}), 1);
  EXPECT_EQ(out.str(), read_text(file)) << "in the place of the report";
  EXPECT_EQ(cli({"check", a, "--against", base, "--markdown", file}), 0);
  EXPECT_EQ(read_text(file),
            "- **figure**: all 2 of `tiny` pass; the largest deviation has `frame.remap_time.mean`\n"
            "- **before**: 4 ms\n- **after**: 4 ms (allowed: 1.0 % higher)\n- **who**: nobody\n"
            "- **why**: no figure is worse than its tolerance allows\n");
  dir.write("notes.md", "my notes\n");
  EXPECT_EQ(cli({"check", a, "--against", base, "--markdown", (dir / "notes.md").string()}), 2);
  // Names are shown as they are, and lines stay lines.
  RunMaker odd = slow;
  odd.profile.replace(odd.profile.find("lut,vpbe"), 3, "l*<b>|");
  cli({"check", odd.write(dir, "odd").string(), "--against", base, "--markdown", "-"});
  EXPECT_THAT(out.str(), HasSubstr(R"(region l\*\<b\>\|)"));
  const std::string lines = out.str();
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 5) << lines;
}

TEST_F(FirstBaselineTest, WordsOfCheckThatDoNotGoTogether) {
  const std::string e = (dir / "e.yaml").string();
  for (const auto& words : std::vector<std::vector<std::string>>{{a},
                                                                 {e, a},
                                                                 {e, a, b, "--against", base},
                                                                 {e, a, b, "--across-versions"},
                                                                 {a, "--against", base, "-s", "x=1"},
                                                                 {a, "--against", base, "-o", "x"},
                                                                 {a, "--against", base, "--tolerance", "1%"},
                                                                 {e, a, b, "--tolerance", "x"}}) {
    std::vector<std::string> args = {"check"};
    args.insert(args.end(), words.begin(), words.end());
    EXPECT_EQ(cli(args), 2) << testing::PrintToString(words);
    EXPECT_EQ(out.str(), "");
  }
}

}  // namespace
}  // namespace fovea::regression
