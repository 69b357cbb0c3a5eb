// Baselines: what fails, what is refused, and what blessing leaves as it was.
#include "sw/fovea/regression/check.h"

#include <sys/resource.h>

#include <algorithm>

#include "sw/fovea/compare/compare.h"
#include "sw/fovea/regression/first_baseline.h"
#include "tb/regression/run_maker.h"

namespace fovea::regression {
namespace {

using test::TempDir;
using test::user_error;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kHead =
    "format: fovea baseline 1\nexperiment: tiny\nsimulator: {version: 0.1.0, commit: aaaaaaaaaaaa}\n";

class CheckTest : public testing::Test {
 protected:
  CheckTest() { run.figure("time", "100").figure("share", "0.5", "ratio").figure("none", "null", "s"); }
  Baseline baseline(const std::string& metrics, const std::string& head = kHead) {
    return read_baseline(dir.write("b.yaml", head + "metrics:\n" + metrics));
  }
  /// The verdict on `time: {value: 100, unit: 1, ...}` when the run has `value`.
  Verdict verdict(const std::string& value, const std::string& rest) {
    run.figure("time", value);
    const Baseline b = baseline("  time: {value: 100, unit: 1" + (rest.empty() ? "" : ", " + rest) + "}\n");
    return judge(b.metrics.at(0), read_run(run.write(dir, "run"))).verdict;
  }
  Finding finding(const std::string& metric) {
    kept.push_back(std::make_unique<Baseline>(baseline("  " + metric + "\n")));
    runs.push_back(std::make_unique<RunFigures>(read_run(run.write(dir, "run"))));
    return judge(kept.back()->metrics.at(0), *runs.back());
  }
  TempDir dir;
  RunMaker run;
  std::vector<std::unique_ptr<Baseline>> kept;
  std::vector<std::unique_ptr<RunFigures>> runs;
};

TEST_F(CheckTest, WithoutToleranceAnyChangeFailsInTheWrongDirection) {
  EXPECT_EQ(verdict("100", ""), Verdict::kPass);
  EXPECT_EQ(verdict("101", ""), Verdict::kFail);
  EXPECT_EQ(verdict("99", ""), Verdict::kFail);
  EXPECT_EQ(verdict("101", "worse: both"), Verdict::kFail);
  EXPECT_EQ(verdict("101", "worse: higher"), Verdict::kFail);
  EXPECT_EQ(verdict("99", "worse: higher"), Verdict::kBetter);
  EXPECT_EQ(verdict("99", "worse: lower"), Verdict::kFail);
  EXPECT_EQ(verdict("101", "worse: lower"), Verdict::kBetter);
}

TEST_F(CheckTest, TolerancesPassAtTheLimitAndFailBeyond) {
  EXPECT_EQ(verdict("103", "tolerance: 3%, worse: higher"), Verdict::kPass);
  EXPECT_EQ(verdict("104", "tolerance: 3%, worse: higher"), Verdict::kFail);
  EXPECT_EQ(verdict("97", "tolerance: 3, worse: lower"), Verdict::kPass);
  EXPECT_EQ(verdict("96", "tolerance: 3, worse: lower"), Verdict::kFail);
  EXPECT_EQ(verdict("97", "tolerance: 3"), Verdict::kPass);
  EXPECT_EQ(verdict("96", "tolerance: 3"), Verdict::kFail);
  EXPECT_EQ(verdict("96", "tolerance: 3, worse: higher"), Verdict::kBetter);
}

TEST_F(CheckTest, ABudgetIsALimitThatTheValueItselfStillMeets) {
  EXPECT_EQ(verdict("100", "kind: budget, worse: higher, reason: r"), Verdict::kPass);
  EXPECT_EQ(verdict("101", "kind: budget, worse: higher, reason: r"), Verdict::kFail);
  EXPECT_EQ(verdict("99", "kind: budget, worse: higher, reason: r"), Verdict::kPass);
  EXPECT_EQ(verdict("99", "kind: budget, worse: lower, reason: r"), Verdict::kFail);
}

TEST_F(CheckTest, WhatIsBetterIsNoFailureInJUnitXml) {
  const Baseline b = baseline("  time: {value: 100, unit: 1, worse: higher}\n");
  for (const auto& [value, failures] : {std::pair("99", 0), {"101", 1}}) {
    const RunFigures r = read_run(run.figure("time", value).write(dir, "run"));
    const std::string xml = junit_xml(check_run(r, b, false), r, b, "2026-11-23T12:00:00");
    EXPECT_THAT(xml, HasSubstr("failures=\"" + std::to_string(failures) + "\""));
    EXPECT_EQ(xml.find("<failure") != xml.npos, failures == 1) << value;
  }
}

TEST_F(CheckTest, WhatIsMissingFails) {
  const Finding f = finding("timee: {value: 100, unit: 1}");
  EXPECT_EQ(f.verdict, Verdict::kFail);
  EXPECT_EQ(f.words, "the run has no such figure; did you mean time?");
}

TEST_F(CheckTest, AnotherUnitFails) {
  const Finding f = finding("time: {value: 100, unit: s}");
  EXPECT_EQ(f.verdict, Verdict::kFail);
  EXPECT_EQ(f.words, "the unit is 1, in the baseline s");
}

TEST_F(CheckTest, AFailureSaysWhatIsAllowed) {
  EXPECT_THAT(finding("time: {value: 99, unit: 1}").words, testing::EndsWith("allowed: no deviation"));
  EXPECT_THAT(finding("time: {value: 99, unit: 1, worse: higher}").words,
              testing::EndsWith("allowed: no deviation upwards"));
  EXPECT_THAT(finding("time: {value: 101, unit: 1, worse: lower}").words,
              testing::EndsWith("allowed: no deviation downwards"));
  EXPECT_THAT(finding("time: {value: 90, unit: 1, tolerance: 5%, worse: higher}").words,
              testing::EndsWith("allowed: 5.0 % higher"));
  EXPECT_THAT(finding("time: {value: 110, unit: 1, tolerance: 1% or 2, worse: lower}").words,
              testing::EndsWith("allowed: 1.0 % or 2.0 lower"));
}

TEST_F(CheckTest, AFigureWithoutValueIsNotANumber) {
  EXPECT_EQ(finding("none: {value: null, unit: s}").verdict, Verdict::kPass);
  EXPECT_EQ(finding("none: {value: 0, unit: s}").verdict, Verdict::kFail);
  EXPECT_EQ(finding("time: {value: null, unit: 1}").words, "100, expected: no value");
  EXPECT_EQ(finding("time: {value: null, unit: 1}").verdict, Verdict::kFail);
}

TEST_F(CheckTest, CountsAndDecimalsAreComparedAsTheyAre) {
  EXPECT_EQ(finding("share: {value: 0.5, unit: ratio}").verdict, Verdict::kPass);
  EXPECT_EQ(finding("share: {value: 0.5000000000000001, unit: ratio}").verdict, Verdict::kFail);
  EXPECT_EQ(finding("time: {value: 1e2, unit: 1}").verdict, Verdict::kPass);
  EXPECT_EQ(finding("time: {value: 100.5, unit: 1}").verdict, Verdict::kFail);
  // 1 - 1.1 is -0.10000000000000009 in double precision, at a limit of 0.1: a calculated value makes no count.
  run.figure("time", "1");
  EXPECT_EQ(finding("time: {value: 1.1, unit: 1, tolerance: 0.1}").verdict, Verdict::kPass);
}

TEST_F(CheckTest, EveryFaultOfABaselineIsNamedWithItsLine) {
  const auto error = [&](const std::string& text) {
    return user_error([&] { read_baseline(dir.write("b.yaml", text)); });
  };
  const std::string head = kHead;
  EXPECT_THAT(error(""), HasSubstr("b.yaml:1"));
  EXPECT_THAT(error("format: fovea baseline 2\n"), HasSubstr("allowed: 'format: fovea baseline 1'"));
  EXPECT_THAT(error("format: [\n"), HasSubstr("b.yaml:"));
  EXPECT_THAT(error(head), HasSubstr("'metrics' is missing"));
  EXPECT_THAT(error(head + "metrics: {}\n"), HasSubstr("'metrics' is missing or empty"));
  EXPECT_THAT(error(head + "metric: {}\n"), AllOf(HasSubstr("b.yaml:4"), HasSubstr("unknown key 'metric'")));
  const auto metric = [&](const std::string& rest) { return error(head + "metrics:\n  a: {" + rest + "}\n"); };
  EXPECT_THAT(metric("unit: s"), AllOf(HasSubstr("b.yaml:5"), HasSubstr("'value' is missing")));
  EXPECT_THAT(metric("value: 1"), HasSubstr("'unit' is missing"));
  EXPECT_THAT(metric("value: .nan, unit: s"), HasSubstr("not a number"));
  EXPECT_THAT(metric("value: .inf, unit: s"), HasSubstr("not a number"));
  EXPECT_THAT(metric("value: fast, unit: s"), HasSubstr("not a number"));
  EXPECT_THAT(metric("value: , unit: s"), HasSubstr("'value' is empty"));
  EXPECT_THAT(metric("value: 1, unit: s, tolerance: -1%"), HasSubstr("not a tolerance"));
  EXPECT_THAT(metric("value: 1, unit: s, direction: up"), HasSubstr("unknown key 'direction'"));
  EXPECT_THAT(metric("value: 1, unit: s, worse: up"), HasSubstr("allowed: higher, lower, both"));
  EXPECT_THAT(metric("value: 1, unit: s, kind: guess"), HasSubstr("allowed: exact, analytic, budget"));
  EXPECT_THAT(metric("value: 1, unit: s, kind: analytic"), HasSubstr("need a reason"));
  EXPECT_THAT(metric("value: 1, unit: s, kind: budget, reason: r"), HasSubstr("a budget needs"));
  EXPECT_THAT(metric("value: 1, unit: s, unit: s"), HasSubstr("twice"));
  EXPECT_THAT(error(head + "metrics:\n  a: {value: 1, unit: s}\n  a: {value: 1, unit: s}\n"), HasSubstr("twice"));
  EXPECT_THAT(error(head + "history: []\nmetrics:\n  a: {value: 1, unit: s}\n"), HasSubstr("last part"));
  EXPECT_THAT(error("format: fovea baseline 1\nexperiment: tiny\nmetrics:\n  a: {value: 1, unit: s}\n"),
              HasSubstr("'simulator' is missing"));
  for (const char* history : {"history: []\n", "history:\n  - commit: c\n    why: w\n"})
    EXPECT_NO_THROW(read_baseline(dir.write("b.yaml", head + "metrics:\n  a: {value: 1, unit: s}\n" + history)))
        << history;
}

TEST_F(CheckTest, OtherCircumstancesAreRefused) {
  const std::string metric = "  time: {value: 100, unit: 1}\n";
  const auto error = [&](const std::string& head, bool across = false) {
    const Baseline b = baseline(metric, head);
    const RunFigures r = read_run(run.write(dir, "run"));
    return user_error([&] { check_run(r, b, across); });
  };
  const std::string plain = kHead;
  EXPECT_THAT(error("format: fovea baseline 1\nexperiment: other\nsimulator: {version: 0.1.0, commit: aaaaaaaaaaaa}\n"),
              HasSubstr("experiment 'tiny'"));
  EXPECT_THAT(error(plain + "settings: {run.frames: 25}\n"), HasSubstr("run.frames = 25"));
  EXPECT_THAT(error(plain + "settings: {run.frame: 25}\n"), HasSubstr("no parameter 'run.frame'"));
  EXPECT_THAT(error(plain + "reference: nowhere\n"), HasSubstr("nowhere"));
  for (const char* other : {"{version: 0.2.0, commit: aaaaaaaaaaaa}", "{version: 0.1.0, commit: bbbbbbbbbbbb}",
                            "{version: 0.1.0, commit: aaaaaaaaaaaa-modified}"}) {
    const std::string head = "format: fovea baseline 1\nexperiment: tiny\nsimulator: " + std::string(other) + "\n";
    EXPECT_THAT(error(head), HasSubstr("--across-versions"));
    const CheckResult passed = check_run(read_run(dir / "run"), baseline(metric, head), true);
    EXPECT_EQ(passed.failures(), 0u);
  }
}

// The whole chain: begin a baseline, a slower run, who is blamed.
class ReferenceTest : public testing::Test {
 protected:
  ReferenceTest() {
    const RunFigures first = read_run(profiled().write(dir, "first"));
    dir.write("base.yaml", new_baseline({.run = &first, .reference = "base", .why = "the first \"one\""}));
    for (const auto& [name, text] : reference_files(first)) dir.write("base/" + name, text);
  }
  TempDir dir;
};

TEST_F(ReferenceTest, ANewBaselineIsReadAndPassesItsOwnRun) {
  const Baseline b = read_baseline(dir / "base.yaml");
  EXPECT_EQ(b.settings.at("run.frames"), "2");
  EXPECT_EQ(b.metrics.size(), 2u);  // those of the headlines that the run has
  const RunFigures run = read_run(dir / "first");
  const CheckResult r = check_run(run, b, false);
  EXPECT_EQ(r.failures(), 0u);
  EXPECT_TRUE(r.settings.empty()) << r.settings.front();
  // Names of files differ between hosts; their hashes are compared.
  RunMaker elsewhere = profiled();
  elsewhere.parameters["firmware.elf"] = "/elsewhere/app.elf";
  EXPECT_TRUE(check_run(read_run(elsewhere.write(dir, "elsewhere")), b, false).settings.empty());
  elsewhere.elf = "22";
  EXPECT_THAT(check_run(read_run(elsewhere.write(dir, "elsewhere")), b, false).settings,
              testing::ElementsAre("input firmware.elf: another file (SHA-256 11 -> 22)"));
  EXPECT_THAT(check_text(r, run, b, false), testing::StartsWith("passed: tiny against"));
  EXPECT_FALSE(r.difference) << "who passed is not searched for blame";
  EXPECT_THAT(check_text(r, run, b, false), Not(HasSubstr("  ok ")));
  EXPECT_THAT(check_text(r, run, b, true), HasSubstr("  ok      frame.remap_time.mean  4 ms, baseline 4 ms\n"));
}

// One figure is worse, another better: nothing that is to be kept. The run has no clocks by cause.
TEST_F(ReferenceTest, ARunThatFailsIsNotAdvisedToBless) {
  RunMaker mixed = profiled();
  mixed.figure("frame.remap_time.mean", "0.0039", "s").figure("cpu.spare", "280", "cycles");
  mixed.stalls.clear();
  mixed.profile.clear();
  const RunFigures run = read_run(mixed.write(dir, "mixed"));
  const Baseline b = read_baseline(dir / "base.yaml");
  const std::string text = check_text(check_run(run, b, false), run, b, false);
  EXPECT_THAT(text, AllOf(HasSubstr("FAILED  cpu.spare"), HasSubstr("better  frame.remap_time.mean")));
  EXPECT_THAT(text, Not(HasSubstr("fovea bless")));
  EXPECT_THAT(text, Not(HasSubstr("has no reference"))) << "it has one";
}

TEST_F(CheckTest, WithoutAReferenceNothingIsBlamed) {
  const Baseline b = baseline("  time: {value: 99, unit: 1, worse: higher}\n");
  const RunFigures r = read_run(run.write(dir, "run"));
  EXPECT_THAT(check_text(check_run(r, b, false), r, b, false),
              HasSubstr("blamed: nothing, because the baseline has no reference\n"));
}

TEST_F(CheckTest, OnlyExactValuesAreOfTheBaseline) {
  EXPECT_THAT(finding("time: {value: 99, unit: 1}").words, HasSubstr("baseline 99"));
  EXPECT_THAT(finding("time: {value: 99, unit: 1, kind: analytic, reason: r}").words, HasSubstr("by calculation 99"));
}

// Equal figures of another simulator: its name, and no history. A comment is no history either, and the last line may
// lack its end.
TEST_F(CheckTest, BlessingTakesOverTheSimulatorAndBeginsAHistory) {
  const std::string text = std::string(kHead) + "# history: none yet\nmetrics:\n  time: {value: 100, unit: 1}";
  RunMaker now = run;
  now.commit = "bbbbbbbbbbbb";
  std::string want = text;
  want.replace(want.find("aaaaaaaaaaaa"), 12, "bbbbbbbbbbbb");
  const Baseline b = read_baseline(dir.write("b.yaml", text));
  EXPECT_EQ(blessed_text(read_run(now.write(dir, "now")), b, "why"), want);
  now.figure("time", "101");
  want.replace(want.find("value: 100"), 10, "value: 101");
  want += "\nhistory:\n  - commit: bbbbbbbbbbbb\n    why: \"why\"\n    changes: |\n      time: 100 -> 101\n";
  EXPECT_EQ(blessed_text(read_run(now.write(dir, "now")), b, "why"), want);
}

TEST_F(ReferenceTest, ASlowerRunIsBlamedOnFunctionLineAndCause) {
  RunMaker slow = profiled();
  slow.figure("frame.remap_time.mean", "0.0042", "s");
  slow.profile.replace(slow.profile.find("vpbe,50"), 7, "vpbe,70");
  slow.profile.replace(slow.profile.find("capture,,,300"), 13, "capture,,,280");
  slow.figure("cpu.idle", "280", "cycles").figure("cpu.spare", "280", "cycles");
  slow.parameters["ddr.clock"] = "216MHz";
  const RunFigures run = read_run(slow.write(dir, "slow"));
  const Baseline b = read_baseline(dir / "base.yaml");
  const CheckResult r = check_run(run, b, false);
  EXPECT_EQ(r.failures(), 2u);  // the time and the idle clocks
  EXPECT_EQ(r.blame,
            "remap (remap.c:21) waits with the same instructions: +20 clocks (100 % of the change), of "
            "which +20 clocks by dcache, region lut, culprit vpbe");
  const std::string text = check_text(r, run, b, false);
  EXPECT_THAT(text, AllOf(HasSubstr("FAILED: tiny"), HasSubstr("4.2 ms, baseline 4 ms (+200 us, +5.0 %)"),
                          HasSubstr("ddr.clock: 243MHz -> 216MHz"), HasSubstr("blamed: remap (remap.c:21)")));
  const std::string xml = junit_xml(r, run, b, "2026-11-23T12:00:00");
  EXPECT_THAT(xml, AllOf(HasSubstr("tests=\"2\" failures=\"2\""), HasSubstr("blamed: remap (remap.c:21)")));
}

// A reference with a profile and a run without one: causes, without functions.
TEST_F(ReferenceTest, WithoutAProfileOfTheRunTheCauseIsBlamed) {
  RunMaker slow = profiled();
  slow.profile.clear();
  slow.stalls.replace(slow.stalls.find("vpbe,50"), 7, "vpbe,70");
  slow.figure("cpu.idle", "280", "cycles").figure("cpu.spare", "280", "cycles");
  const CheckResult r = check_run(read_run(slow.write(dir, "slow")), read_baseline(dir / "base.yaml"), false);
  EXPECT_EQ(r.blame,
            "the program: +20 clocks (100 % of the change), of which +20 clocks by dcache, region lut, culprit vpbe");
  EXPECT_EQ(r.advice, "function and line are not known, because the run has no profile; run it again with --profile");
  // With the command that made it.
  dir.write("slow/host.json", "{\"command\": [\"run\", \"a b.yaml\", \"-s\", \"x=1\"]}\n");
  const RunFigures run = read_run(dir / "slow");
  const Baseline b = read_baseline(dir / "base.yaml");
  const CheckResult again = check_run(run, b, false);
  EXPECT_THAT(check_text(again, run, b, false), HasSubstr("--profile: fovea run 'a b.yaml' -s x=1 --profile\n"));
  EXPECT_THAT(junit_xml(again, run, b, "2026-11-23T12:00:00"), HasSubstr("--profile: fovea run"));
}

TEST_F(ReferenceTest, AcrossVersionsTheModelsChangesAreListed) {
  RunMaker other = profiled();
  other.version = "0.2.0";
  other.parameters.erase("ddr.clock");
  other.parameters["ddr.new"] = "1";
  const RunFigures run = read_run(other.write(dir, "other"));
  const Baseline b = read_baseline(dir / "base.yaml");
  const CheckResult r = check_run(run, b, true);
  EXPECT_THAT(r.settings, testing::ElementsAre("simulator: 0.1.0 (commit aaaaaaaaaaaa) -> 0.2.0 (commit aaaaaaaaaaaa)",
                                               "parameter ddr.clock is gone: 243MHz", "parameter ddr.new is new: 1"));
  EXPECT_THAT(check_text(r, run, b, false), HasSubstr("parameter ddr.new is new"));
}

TEST_F(ReferenceTest, BlessingChangesValuesSimulatorAndHistoryOnly) {
  const std::string text =
      "# head\nformat: fovea baseline 1\nexperiment: tiny   # which\n\nsimulator:\n  version: 0.1.0 # v\n"
      "  commit: aaaaaaaaaaaa\nmetrics:\n  # the pace\n  frame.remap_time.mean: {value: 0.0039, unit: s,"
      " tolerance: 1%}  # why\n  cpu.cycles:\n    unit: cycles\n    value: 1000\n  cpu.idle:\n    value: 1 # low\n"
      "    unit: cycles\n    kind: budget\n    worse: lower\n    reason: some\n";
  RunMaker now = profiled();
  now.commit = "bbbbbbbbbbbb";
  now.modified = true;
  const RunFigures run = read_run(now.write(dir, "now"));
  const std::string blessed = blessed_text(run, read_baseline(dir.write("own.yaml", text)), "a: \"reason\"");
  std::string want = text;
  const auto put = [&want](const std::string& from, const std::string& to) {
    want.replace(want.find(from), from.size(), to);
  };
  put("0.0039", "0.004");
  put("commit: aaaaaaaaaaaa", "commit: bbbbbbbbbbbb-modified");
  want += "history:\n  - commit: bbbbbbbbbbbb-modified\n    why: \"a: \\\"reason\\\"\"\n    changes: |\n"
          "      frame.remap_time.mean: 0.0039 -> 0.004\n";
  EXPECT_EQ(blessed, want);
  const Baseline again = parse_baseline(dir / "own.yaml", blessed);
  EXPECT_EQ(again.metrics.at(0).value, 0.004);
  // A second time there is nothing to do, and a third change extends the history.
  EXPECT_EQ(blessed_text(run, again, "x"), blessed);
  now.figure("cpu.cycles", "1001", "cycles");
  now.profile.clear();
  now.stalls.clear();
  const std::string third = blessed_text(read_run(now.write(dir, "third")), again, "more");
  EXPECT_THAT(third, testing::StartsWith(want.substr(0, want.find("value: 1000"))));
  EXPECT_THAT(third, testing::EndsWith("cpu.cycles: 1000 -> 1001\n"));
  EXPECT_NO_THROW(parse_baseline(dir / "own.yaml", third));
}

TEST_F(ReferenceTest, BlessingRefusesWhatItWouldHide) {
  const std::string head = kHead;
  const RunFigures run = read_run(dir / "first");
  const auto error = [&](const std::string& metric) {
    const Baseline b = read_baseline(dir.write("own.yaml", head + "metrics:\n  " + metric + "\n"));
    return user_error([&] { blessed_text(run, b, "why"); });
  };
  EXPECT_THAT(error("cpu.cycle: {value: 1, unit: cycles}"), AllOf(HasSubstr("own.yaml:5"), HasSubstr("cpu.cycles?")));
  EXPECT_THAT(error("cpu.cycles: {value: 1, unit: s}"), HasSubstr("unit"));
}

// A third of the letters may be wrong, and two of a short name; an end that was forgotten counts as one letter.
TEST(NearestMetricTest, IsTheOneWithTheFewestChanges) {
  const auto nearest = [](const std::string& name, const std::vector<std::string>& names) {
    RunFigures run;
    for (const auto& n : names) run.metrics[n] = {};
    return nearest_metric(run, name);
  };
  EXPECT_EQ(nearest("abcdef", {"abcdXY"}), "abcdXY");
  EXPECT_EQ(nearest("abcdef", {"abcXYZ"}), "");
  EXPECT_EQ(nearest("abcdefghi", {"abcdefXYZ"}), "abcdefXYZ");
  EXPECT_EQ(nearest("abcdefghi", {"abcdeVXYZ"}), "");
  EXPECT_EQ(nearest("abcdef", {"abcd"}), "abcd");
  EXPECT_EQ(nearest("abcd", {"abcdef"}), "abcdef");
  EXPECT_EQ(nearest("efgh", {"abcefgh"}), "");
  EXPECT_EQ(nearest("abcd", {"abcdefg"}), "abcdefg");
  EXPECT_EQ(nearest("abcdef", {"abXYef", "abcdeX", "abcXYf"}), "abcdeX");
}

// Each hint compares the name with all others.
TEST_F(CheckTest, HintsForUnknownFiguresHaveALimit) {
  RunFigures run;
  Baseline baseline;
  for (int n = 0; n < 5000; ++n) {
    run.metrics["known." + std::to_string(n)].value = 1;
    Expectation e;
    e.name = "knwon." + std::to_string(n);
    baseline.metrics.push_back(e);
  }
  std::size_t hints = 0;
  for (const Finding& f : check_run(run, baseline, true).findings) {
    EXPECT_EQ(f.verdict, Verdict::kFail);
    hints += f.words.find("did you mean") != std::string::npos;
  }
  EXPECT_EQ(hints, 20u);
}

// 20,000 lines whose first and last change: a table of all pairs would be 3 GB.
TEST(UnifiedDiffTest, NeedsNoMoreMemoryThanItsLines) {
  std::string before = "a\n", after = "b\n";
  for (int n = 0; n < 20'000; ++n) before += "same\n", after += "same\n";
  const rlimit all{RLIM_INFINITY, RLIM_INFINITY}, little{std::size_t{1} << 30, RLIM_INFINITY};
  ::setrlimit(RLIMIT_AS, &little);
  const std::string diff = unified_diff("f", before + "a\n", after + "b\n");
  ::setrlimit(RLIMIT_AS, &all);
  EXPECT_EQ(std::count(diff.begin(), diff.end(), '\n'), 2 + 2 * (1 + 2 + 3)) << diff;
}

TEST(UnifiedDiffTest, IsWhatDiffWouldPrint) {
  EXPECT_EQ(unified_diff("f", "a\nb\n", "a\nb\n"), "");
  EXPECT_EQ(unified_diff("f", "", "a\n"), "--- f\n+++ f\n@@ -0,0 +1,1 @@\n+a\n");
  EXPECT_EQ(unified_diff("f", "1\n2\n3\n4\n5\n6\n7\n8\n9\n", "1\n2\n3\n4\nfive\n6\n7\n8\n9\nten\n"),
            "--- f\n+++ f\n@@ -2,8 +2,9 @@\n 2\n 3\n 4\n-5\n+five\n 6\n 7\n 8\n 9\n+ten\n");
  EXPECT_EQ(unified_diff("f", "1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n", "1\nA\n3\n4\n5\n6\n7\n8\n9\nB\n"),
            "--- f\n+++ f\n@@ -1,5 +1,5 @@\n 1\n-2\n+A\n 3\n 4\n 5\n@@ -7,4 +7,4 @@\n 7\n 8\n 9\n-10\n+B\n");
}

}  // namespace
}  // namespace fovea::regression
