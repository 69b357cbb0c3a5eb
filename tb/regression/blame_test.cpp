// The difference of two profiles: sums, blame. Expected amounts are counted by hand from the rows of run_maker.h.
#include "sw/fovea/compare/blame.h"

#include "sw/fovea/compare/compare.h"
#include "tb/regression/blame_bench.h"

namespace fovea::regression {
namespace {

using test::TempDir;
using test::user_error;
using testing::HasSubstr;

class BlameTest : public BlameBench {};

TEST_F(BlameTest, EqualRunsDifferInNothing) {
  const Difference d = difference();
  EXPECT_TRUE(d.none());
  EXPECT_EQ(d.busy.before, 700);
  EXPECT_EQ(d.idle.before, 300);
  EXPECT_EQ(blame_of(d, true).function, nullptr);
}

// An extra load in line 21: 100 instructions more, 40 clocks of misses; the camera's pace takes them
// from the idle clocks.
TEST_F(BlameTest, AnExtraLoadIsBlamedOnItsLineThoughTheClocksAreTheSame) {
  replace(after.profile, "21,issue,,,100,100", "21,issue,,,200,200");
  replace(after.profile, "dcache,lut,bridge,150", "dcache,lut,bridge,190");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,160");
  const Difference d = difference();
  EXPECT_EQ(d.total.change(), 0);
  EXPECT_EQ(d.busy.change(), 140);
  EXPECT_EQ(d.idle.change(), -140);
  EXPECT_EQ(d.unexplained, 0);
  ASSERT_EQ(d.functions.size(), 1u);
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kExecutes);
  const Blame blame = blame_of(d, true);
  ASSERT_TRUE(blame.function && blame.cause && blame.line);
  EXPECT_EQ(blame.function->function, "remap");
  EXPECT_EQ(blame.line->after, 21u);
  EXPECT_EQ(blame.line->share.change(), 140);
  EXPECT_EQ(blame.cause->cause, "issue");
  EXPECT_EQ(blame_text(d, blame),
            "remap (remap.c:21) executes more: +140 clocks (100 % of the change), of which +100 clocks by issue");
}

// remap executes nothing else and waits 40 clocks more for what irq, with 12 of its own, does to it. With
// less than a quarter of the change irq would be a by-product.
TEST_F(BlameTest, TheFunctionThatExecutesMoreIsTheOriginOfWaits) {
  replace(after.profile, "dcache,lut,vpbe,50", "dcache,lut,vpbe,86");
  replace(after.profile, "irq.c,7,issue,,,50,50", "irq.c,7,issue,,,62,62");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,252");
  after.elf = "22";
  const auto blamed = [&] {
    const Difference d = difference();
    const Blame blame = blame_of(d, true);
    return blame.function ? blame.function->function : "";
  };
  EXPECT_EQ(blamed(), "irq");  // 12 of 48
  replace(after.profile, "irq.c,7,issue,,,62,62", "irq.c,7,issue,,,61,61");
  EXPECT_EQ(blamed(), "remap");  // 11 of 47
  replace(after.profile, "irq.c,7,issue,,,61,61", "irq.c,7,issue,,,62,62");
  after.parameters["ddr.clock"] = "216MHz";
  EXPECT_EQ(blamed(), "remap") << "another setting may be the origin";
}

// The cause with most clocks in all, not the largest row: 30 of dcache in two rows beside 20 of interlock.
TEST_F(BlameTest, TheCauseWithMostClocksIsBlamed) {
  replace(after.profile, "dcache,lut,bridge,150", "dcache,lut,bridge,164");
  replace(after.profile, "dcache,lut,vpbe,50", "dcache,lut,vpbe,66");
  replace(after.profile, "interlock,none,core,100", "interlock,none,core,120");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,250");
  const Difference d = difference();
  EXPECT_THAT(
      blame_text(d, blame_of(d, true)),
      HasSubstr("+50 clocks (100 % of the change), of which +30 clocks by dcache, mostly region lut, culprit vpbe"));
}

// A load whose clocks were waits for the write buffer before.
TEST_F(BlameTest, InstructionsWithoutClocksAreNamed) {
  replace(after.profile, "22,issue,,,50,50", "22,issue,,,80,80");
  replace(after.profile, "interlock,none,core,100", "interlock,none,core,70");
  const Difference d = difference();
  EXPECT_EQ(d.busy.change(), 0);
  EXPECT_EQ(blame_text(d, blame_of(d, true)),
            "remap (remap.c) executes 30 instructions more, which take no more clocks in all");
}

// The same load on a new line: those below it are compared with themselves.
TEST_F(BlameTest, LinesThatAnInsertionMovedAreNotBlamed) {
  replace(after.profile, "remap.c,22,issue", "remap.c,23,issue");
  replace(after.profile, "remap.c,22,interlock", "remap.c,23,interlock");
  replace(after.profile, "frames,remap,/src/remap.c,23,issue",
          "frames,remap,/src/remap.c,22,issue,,,60,60\nframes,remap,/src/remap.c,23,issue");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,240");
  const Difference d = difference();
  ASSERT_EQ(d.functions.size(), 1u);
  ASSERT_EQ(d.functions[0].lines.size(), 1u);
  EXPECT_EQ(d.functions[0].lines[0].before, std::nullopt);
  EXPECT_EQ(d.functions[0].lines[0].after, 22u);
  EXPECT_EQ(d.functions[0].lines[0].share.change(), 60);
}

// 20 is taken out: 21 and 22, which have moved up, are as they were.
TEST_F(BlameTest, LinesThatADeletionMovedAreNotBlamed) {
  before.profile = "frames,f,f.c,20,issue,,,495,1\nframes,f,f.c,21,issue,,,500,1\nframes,f,f.c,22,issue,,,5,1\n";
  after.profile = "frames,f,f.c,20,issue,,,500,1\nframes,f,f.c,21,issue,,,5,1\nframes,z,,,idle,,,495,0\n";
  const Difference d = difference();
  ASSERT_EQ(d.functions.size(), 1u);
  ASSERT_EQ(d.functions[0].lines.size(), 1u);
  EXPECT_EQ(d.functions[0].lines[0].before, 20u);
  EXPECT_EQ(d.functions[0].lines[0].after, std::nullopt);
  EXPECT_EQ(d.functions[0].lines[0].share.change(), -495);
}

TEST_F(BlameTest, ALongerWaitIsBlamedOnItsCulprit) {
  replace(after.profile, "dcache,lut,vpbe,50", "dcache,lut,vpbe,90");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,260");
  after.parameters["ddr.clock"] = "216MHz";
  const Difference d = difference();
  const Blame blame = blame_of(d, true);
  ASSERT_TRUE(blame.function && blame.cause);
  EXPECT_EQ(blame.function->kind, ChangeKind::kWaits);
  EXPECT_EQ(blame_text(d, blame),
            "remap (remap.c:21) waits with the same instructions: +40 clocks (100 % of the change), of "
            "which +40 clocks by dcache, region lut, culprit vpbe");
  // Towards the faster side, nothing is to blame.
  EXPECT_EQ(blame_of(d, false).function, nullptr);
}

// The line that is named is the one at which the named cause grew, not another that grew more by two causes.
TEST_F(BlameTest, LineAndCauseBelongTogether) {
  replace(after.profile, "22,interlock,none,core,100", "22,interlock,none,core,150");
  replace(after.profile, "21,dcache,lut,bridge,150", "21,dcache,lut,bridge,180");
  replace(after.profile, "frames,remap,/src/remap.c,22,issue",
          "frames,remap,/src/remap.c,21,write_buffer,lut,bridge,25,0\n"
          "frames,remap,/src/remap.c,22,issue");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,195");
  const Difference d = difference();
  const Blame blame = blame_of(d, true);
  ASSERT_TRUE(blame.function && blame.cause && blame.line);
  EXPECT_EQ(d.functions[0].lines[0].after, 21u);
  EXPECT_EQ(d.functions[0].lines[0].causes,
            (std::map<std::string, double>{{"dcache", 30}, {"issue", 0}, {"write_buffer", 25}}));
  EXPECT_EQ(blame.line->after, 22u);
  EXPECT_THAT(blame_text(d, blame), HasSubstr("remap (remap.c:22) waits with the same instructions: +105 clocks"));
  EXPECT_THAT(blame_text(d, blame), HasSubstr("+50 clocks by interlock"));
}

// Equal numbers of instructions prove nothing: the same figures as above, with the code in its place.
// A loop over a cache takes another step because of other addresses: its code is the same.
// An inlined function lies in each function that holds it.
TEST_F(BlameTest, NewAndVanishedFunctionsAreNamedSo) {
  replace(after.profile, "frames,irq,irq.c,7,issue", "frames,poll,poll.c,9,issue");
  replace(after.profile, "frames,irq,irq.c,7,icache", "frames,poll,poll.c,9,icache");
  const Difference d = difference();
  ASSERT_EQ(d.functions.size(), 2u);
  for (const auto& f : d.functions)
    EXPECT_EQ(f.kind, f.function == "poll" ? ChangeKind::kAdded : ChangeKind::kRemoved);
}

// 1,000 clocks in 4 us against 1,000 clocks in 5 us: a slower core. As clocks nothing would differ.
TEST_F(BlameTest, CoresOfDifferentClocksAreComparedInSeconds) {
  before.figure("frame.window", "0.000004", "s");
  after.figure("frame.window", "0.000005", "s");
  const Difference d = difference();
  EXPECT_TRUE(d.in_seconds);
  EXPECT_NEAR(d.total.change(), 1e-6, 1e-15);
  EXPECT_NEAR(d.busy.change(), 0.7e-6, 1e-15);
  const Blame blame = blame_of(d, true);
  ASSERT_TRUE(blame.function);
  EXPECT_EQ(blame.function->function, "remap");
  EXPECT_NEAR(blame.function->share.change(), 0.55e-6, 1e-15);
  EXPECT_LT(d.unexplained_share(), 1e-6);
}

// 0.1 % and two clocks of each window of 1,000: 0.5 % in all are the same clock.
TEST_F(BlameTest, TheEdgesOfAWindowMakeNoOtherClock) {
  before.figure("frame.window", "0.000004", "s");
  after.figure("frame.window", "0.00000401999", "s");
  EXPECT_FALSE(difference().in_seconds);
  after.figure("frame.window", "0.00000402001", "s");
  EXPECT_TRUE(difference().in_seconds);
}

TEST_F(BlameTest, WithoutProfilesTheStallsAreCompared) {
  after.figure("cpu.idle", "240", "cycles");
  replace(after.stalls, "dcache,lut,vpbe,50", "dcache,lut,vpbe,110");
  const Difference d = difference(false);
  EXPECT_FALSE(d.by_function);
  EXPECT_EQ(d.busy.change(), 60);
  EXPECT_EQ(d.idle.change(), -60);
  EXPECT_EQ(d.unexplained, 0);
  EXPECT_THAT(blame_text(d, blame_of(d, true)), HasSubstr("+60 clocks by dcache, region lut, culprit vpbe"));
}

TEST_F(BlameTest, OneProfileAloneIsNotUsed) {
  after.profile.clear();
  a = read_run(before.write(dir, "a"));
  b = read_run(after.write(dir, "b"));
  const Comparison c = compare_runs(a, b, {}, "");
  ASSERT_TRUE(c.difference);
  EXPECT_FALSE(c.difference->by_function);
}

TEST_F(BlameTest, IdleClocksByEventAreKeptApartFromTheRest) {
  after.figure("cpu.idle.capture", "200", "cycles").figure("cpu.idle.other", "40", "cycles");
  b = read_run(after.write(dir, "b"));
  const Attribution at = attribution_of(b, false);
  double idle = 0;
  std::map<std::string, std::uint64_t> causes;
  for (const auto& r : at.rows)
    if (r.idle()) idle += static_cast<double>(r.clocks), causes[r.cause] = r.clocks;
  EXPECT_EQ(idle, 300);
  EXPECT_EQ(causes, (std::map<std::string, std::uint64_t>{{"idle", 60}, {"idle.capture", 200}, {"idle.other", 40}}));
}

// A core that sleeps until the EDMA or the engine is done waits for its own work: that is to blame.
TEST_F(BlameTest, ASleepUntilTheEdmaIsDoneIsNotIdle) {
  for (const char* event : {"idle.dma", "idle.engine"}) {
    RunMaker a_run = before, b_run = after;
    replace(a_run.profile, "idle.capture,,,300",
            std::string("idle.capture,,,260,0\nframes,sleep,cp15.c,3,") + event + ",,,40");
    replace(b_run.profile, "idle.capture,,,300",
            std::string("idle.capture,,,210,0\nframes,sleep,cp15.c,3,") + event + ",,,90");
    a = read_run(a_run.write(dir, "a"));
    b = read_run(b_run.write(dir, "b"));
    const Difference d = difference_of(attribution_of(a, true), attribution_of(b, true), circumstances_of(a, b));
    EXPECT_EQ(d.busy.change(), 50);
    EXPECT_EQ(d.idle.change(), -50);
    EXPECT_EQ(
        blame_text(d, blame_of(d, true)),
        std::string("sleep (cp15.c:3) waits with the same instructions: +50 clocks (100 % of the change), of which "
                    "+50 clocks by ") +
            event);
  }
}

// The display's interrupt ends the first half of a wait for the EDMA: all of it is the wait. 20 clocks of 300.
TEST_F(BlameTest, ASleepWithinARemapWaitsForTheEdmaWhateverEndsIt) {
  const auto with = [](RunMaker run, int dma, int display) {
    replace(run.profile, "idle.capture,,,300",
            fmt::format(
                "idle.capture,,,{},0\nframes,sleep,cp15.c,3,wait.display,,,{},0\nframes,sleep,cp15.c,3,wait.dma,,,{}",
                300 - dma - display, display, dma));
    return run;
  };
  a = read_run(with(before, 20, 0).write(dir, "a"));
  b = read_run(with(after, 20, 30).write(dir, "b"));
  const Difference d = difference_of(attribution_of(a, true), attribution_of(b, true), circumstances_of(a, b));
  EXPECT_EQ(d.busy.change(), 30);
  EXPECT_EQ(d.idle.change(), -30);
  EXPECT_EQ(
      blame_text(d, blame_of(d, true)),
      "sleep (cp15.c:3) waits with the same instructions: +30 clocks (100 % of the change), of which +30 clocks by "
      "wait.dma");
  // Without a profile the figures tell the same.
  for (RunMaker* run : {&before, &after}) run->profile.clear();
  before.figure("cpu.idle.dma", "20", "cycles")
      .figure("cpu.idle.display", "280", "cycles")
      .figure("cpu.remap.idle.dma", "20", "cycles");
  after.figure("cpu.idle.dma", "25", "cycles").figure("cpu.idle.display", "275", "cycles");
  after.figure("cpu.remap.idle.dma", "20", "cycles").figure("cpu.remap.idle.display", "30", "cycles");
  a = read_run(before.write(dir, "c"));
  b = read_run(after.write(dir, "d"));
  std::map<std::string, std::uint64_t> causes;
  for (const auto& r : attribution_of(b, false).rows)
    if (app::is_sleep(r.cause)) causes[r.cause] += r.clocks;
  EXPECT_EQ(causes, (std::map<std::string, std::uint64_t>{{"idle.display", 245}, {"idle.dma", 5}, {"wait.dma", 50}}));
  const Difference figures = difference_of(attribution_of(a, false), attribution_of(b, false), {});
  EXPECT_EQ(figures.busy.change(), 35);
  EXPECT_EQ(figures.idle.change(), -35);
}

// Waits for both are one cause, and so are those for neither by name.
TEST_F(BlameTest, WaitsForTwoAreNotDivided) {
  for (const char* other : {"wait.engine", "wait.timer"}) {
    RunMaker run = after;
    const bool both = std::string(other) == "wait.engine";
    replace(run.profile, "idle.capture,,,300",
            fmt::format("{},,,100,0\nframes,sleep,cp15.c,3,{},,,200", both ? "wait.dma" : "wait.other", other));
    std::uint64_t sum = 0;
    for (const auto& r : attribution_of(read_run(run.write(dir, "e")), true).rows)
      if (r.cause == (both ? "wait.dma_or_engine" : "wait")) sum += r.clocks;
    EXPECT_EQ(sum, 300u) << other;
  }
}

// Up to 1 % may be missing, as unexplained; a file of another run is refused.
TEST_F(BlameTest, RowsThatDoNotAddUpAreUnexplainedOrRefused) {
  after.figure("cpu.cycles", "1010", "cycles");  // rows: 1,000
  Difference d = difference();
  EXPECT_EQ(d.total.change(), 10);
  EXPECT_EQ(d.unexplained, 10);
  EXPECT_EQ(d.unexplained_share(), 1);
  after.figure("cpu.cycles", "1011", "cycles");  // 1,000 is more than 1 % away
  EXPECT_THAT(user_error([&] { difference(); }), HasSubstr("rows have 1000 clocks, cpu.cycles is 1011"));
}

TEST_F(BlameTest, ClocksBeforeTheWindowAreNotItsClocks) {
  after.profile += "boot,main,main.c,1,issue,,,5000,5000\n";
  const Difference d = difference();
  EXPECT_TRUE(d.none());
}

TEST_F(BlameTest, DamagedTablesAreNamedWithTheirRow) {
  const std::string good = after.profile;
  after.profile += "frames,x,x.c,1,issue,,,many,0\n";
  EXPECT_THAT(user_error([&] { difference(); }), testing::AllOf(HasSubstr("profile.csv:11: "), HasSubstr("'many'")));
  after.profile = good + "frames,x\n";
  EXPECT_THAT(user_error([&] { difference(); }), testing::AllOf(HasSubstr("profile.csv:11: "), HasSubstr("2 fields")));
  after.profile = "\"a\"\"b,c\n";
  EXPECT_THAT(user_error([&] { difference(); }), HasSubstr("profile.csv:2: a quote without its end"));
}

// The table has as many rows as were asked for, the largest change of either sign first; the rest is added up.
TEST_F(BlameTest, RowsThatAreNotShownAreAddedUp) {
  replace(after.profile, "dcache,lut,bridge,150", "dcache,lut,bridge,50");
  replace(after.profile, "dcache,lut,vpbe,50", "dcache,lut,vpbe,90");
  replace(after.profile, "interlock,none,core,100", "interlock,none,core,103");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,357");
  const std::string text = difference_text(difference(), 1);
  EXPECT_THAT(text, HasSubstr("-100 clocks\n"));
  EXPECT_THAT(text, HasSubstr("2 more rows"));
  EXPECT_THAT(text, HasSubstr("+43 clocks\n"));
  EXPECT_THAT(text, testing::Not(HasSubstr("vpbe")));
}

// What becomes faster by other addresses is layout too.
// With other settings only fetches of moved code that executes the same are layout, and half of a change is its reason.
// As TheFunctionThatExecutesMoreIsTheOriginOfWaits, with a function that was not there: 12 of 48 clocks.
TEST_F(BlameTest, ANewFunctionIsTheOriginOfWaits) {
  replace(after.profile, "dcache,lut,vpbe,50", "dcache,lut,vpbe,86");
  after.profile += "frames,poll,poll.c,3,issue,,,12,12\n";
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,252");
  after.elf = "22";
  const Difference d = difference();
  const Blame blame = blame_of(d, true);
  ASSERT_TRUE(blame.function);
  EXPECT_EQ(blame.function->function, "poll");
}

// Of a speed-up the line is named at which the cause shrank most, though another line became faster in all and the
// same cause grew at a third: 60 clocks of dcache less at 20, 5 more at 21, and 40 of interlock less at 22.
TEST_F(BlameTest, ASpeedUpHasTheLineOfItsCause) {
  before.profile = "frames,f,f.c,20,dcache,lut,bridge,400,0\nframes,f,f.c,20,issue,,,100,1\n"
                   "frames,f,f.c,21,dcache,lut,bridge,100,0\nframes,f,f.c,22,interlock,none,core,400,0\n";
  after.profile = "frames,f,f.c,20,dcache,lut,bridge,340,0\nframes,f,f.c,20,issue,,,150,1\n"
                  "frames,f,f.c,21,dcache,lut,bridge,105,0\nframes,f,f.c,22,interlock,none,core,360,0\n"
                  "frames,sleep,cp15.c,3,idle.capture,,,45,0\n";
  const Difference d = difference();
  const Blame blame = blame_of(d, false);
  ASSERT_TRUE(blame.function && blame.cause && blame.line);
  EXPECT_EQ(blame.cause->cause, "dcache");
  EXPECT_EQ(blame.line->after, 20u);
}

// A cause grows by 10 clocks, though its largest row shrinks by 20: the row that is named grew.
TEST_F(BlameTest, TheRowThatIsNamedGrew) {
  replace(after.profile, "dcache,lut,bridge,150,0\n",
          "dcache,lut,bridge,130,0\nframes,remap,/src/remap.c,21,dcache,lut,service,15,0\n");
  replace(after.profile, "dcache,lut,vpbe,50", "dcache,lut,vpbe,65");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,290");
  const Difference d = difference();
  const Blame blame = blame_of(d, true);
  ASSERT_TRUE(blame.cause);
  EXPECT_EQ(d.functions[0].causes[0].culprit, "bridge");
  EXPECT_NE(blame.cause->culprit, "bridge");
  EXPECT_EQ(blame.cause->share.change(), 15);
  EXPECT_EQ(blame.by_cause, 10);
}

// irq waits 30 clocks more, all others 50 less: 30 are no share of -20.
TEST_F(BlameTest, AgainstTheWholeChangeThereIsNoShareOfIt) {
  replace(after.profile, "icache,.text,bridge,100", "icache,.text,bridge,130");
  replace(after.profile, "dcache,lut,bridge,150", "dcache,lut,bridge,100");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,320");
  const Difference d = difference();
  EXPECT_EQ(blame_text(d, blame_of(d, true)),
            "irq (irq.c:7) waits with the same instructions: +30 clocks, of which +30 clocks by icache, region .text, "
            "culprit bridge");
}

// 1,000 clocks as before, in rows that have 5 more, or 140 more of which the idle ones explain 135.
TEST_F(BlameTest, WhatNoRowExplainsIsAShareOfTheLargerChange) {
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,305");
  EXPECT_EQ(difference().unexplained, -5);
  EXPECT_EQ(difference().unexplained_share(), 1) << "of no change at all";
  replace(after.profile, "22,issue,,,50,50", "22,issue,,,190,50");
  replace(after.profile, "idle.capture,,,305", "idle.capture,,,165");
  EXPECT_EQ(difference().unexplained, -5);
  EXPECT_DOUBLE_EQ(difference().unexplained_share(), 5.0 / 140);
}

TEST_F(BlameTest, OtherInstructionsInAsManyClocksAreADifference) {
  replace(after.profile, "22,issue,,,50,50", "22,issue,,,50,40");
  Difference d = difference();
  ASSERT_EQ(d.functions.size(), 1u);
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kExecutes);
  EXPECT_EQ(blame_text(d, blame_of(d, true)), "") << "fewer are no reason";
  replace(after.profile, "22,issue,,,50,40", "22,issue,,,50,51");
  d = difference();
  EXPECT_EQ(blame_text(d, blame_of(d, true)),
            "remap (remap.c) executes 1 instructions more, which take no more clocks in all");
}

// A profile by other phases that misses cpu.cycles by less than its rows of `frames` alone.
TEST_F(BlameTest, ThePhaseOfFramesIsTheWindowOnlyIfItsClocksAre) {
  after.profile = "frames,f,f.c,1,issue,,,500,500\nrun,f,f.c,1,issue,,,505,505\n";
  EXPECT_EQ(attribution_of(read_run(after.write(dir, "b")), true).sum(), 1005);
}

TEST(CircumstancesTest, ProgramsAndSettingsAreToldApart) {
  RunFigures a, b;
  a.hashes["program"] = "1";
  b.hashes["program"] = "2";
  EXPECT_TRUE(circumstances_of(a, b).program_differs);
  EXPECT_FALSE(circumstances_of(a, b).settings_differ);
  a.hashes = b.hashes = {};
  a.hashes["camera.file"] = "1";
  EXPECT_FALSE(circumstances_of(a, b).program_differs);
  EXPECT_TRUE(circumstances_of(a, b).settings_differ);
  // The names of files differ between hosts, and one of two versions may not know that a key names a file.
  a.hashes = {};
  a.parameters["x"].value = "/a";
  b.parameters["x"].value = "/b";
  EXPECT_TRUE(circumstances_of(a, b).settings_differ);
  b.parameters["x"].path = true;
  EXPECT_FALSE(circumstances_of(a, b).settings_differ);
  EXPECT_FALSE(circumstances_of(b, a).settings_differ);
}

TEST(ComparisonTest, WithoutRowsOfEitherRunNoClocksAreCompared) {
  const TempDir dir;
  RunMaker bare = profiled();
  bare.stalls.clear();
  bare.profile.clear();
  const RunFigures with = read_run(profiled().write(dir, "with")), without = read_run(bare.write(dir, "without"));
  EXPECT_TRUE(compare_runs(with, with, {}, "").difference);
  EXPECT_FALSE(compare_runs(with, without, {}, "").difference);
  EXPECT_FALSE(compare_runs(without, with, {}, "").difference);
}

// A larger share comes first; what only one run has is no change, and comes last. As many clocks in all, in another
// function: a slow-down of it.
TEST(ComparisonTest, TheLargestChangesComeFirst) {
  const TempDir dir;
  RunMaker before = profiled(), after = profiled();
  before.figure("x.a", "100").figure("x.b", "100");
  after.figure("x.a", "149").figure("x.b", "150").figure("x.c", "1");
  replace(after.profile, "icache,.text,bridge,100", "icache,.text,bridge,130");
  replace(after.profile, "dcache,lut,bridge,150", "dcache,lut,bridge,120");
  const RunFigures a = read_run(before.write(dir, "a")), b = read_run(after.write(dir, "b"));
  const std::string text = comparison_text(compare_runs(a, b, {}, ""), {}, false);
  EXPECT_LT(text.find("x.b"), text.find("x.a"));
  EXPECT_LT(text.find("x.a"), text.find("x.c"));
  EXPECT_THAT(text, HasSubstr("largest slow-down: irq (irq.c:7)"));
}

}  // namespace
}  // namespace fovea::regression
