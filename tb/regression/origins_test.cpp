// Where a change of clocks comes from: callers, inlined functions, moved code, polling loops, other names, the parts of
// a run. Expected amounts are counted by hand from the rows.
#include "sw/fovea/compare/origins.h"

#include "sw/fovea/compare/blame.h"
#include "sw/fovea/compare/compare.h"
#include "sw/fovea/compare/matching.h"
#include "sw/fovea/regression/check_blame.h"
#include "tb/regression/run_maker.h"

namespace fovea::regression {
namespace {

using test::TempDir;
using testing::HasSubstr;

/// main calls draw and print, which both call put; put holds `out` inlined. 1,000 clocks in all.
RunMaker called() {
  RunMaker r;
  r.chains = true;
  r.figure("cpu.cycles", "1000", "cycles");
  r.profile =
      "frames,main,main.c,5,issue,,,100,100,,\n"
      "frames,draw,draw.c,10,issue,,,200,200,,\n"
      "frames,print,print.c,20,issue,,,50,50,,\n"
      "frames,put,put.c,30,issue,,,40,40,,\n"
      "frames,out,out.h,3,issue,,,60,60,put|put.c,\n"
      "frames,sleep,cp15.c,3,idle.capture,,,550,0,,\n";
  r.paths =
      "frames,main|main.c,100\nframes,main|main.c;draw|draw.c,200\nframes,main|main.c;print|print.c,50\n"
      "frames,main|main.c;draw|draw.c;put|put.c,50\nframes,main|main.c;print|print.c;put|put.c,50\n";
  r.functions =
      "main,main.c,0x00000100,64,a\ndraw,draw.c,0x00000200,64,b\nprint,print.c,0x00000300,64,c\n"
      "put,put.c,0x00000400,64,d\nout,out.h,0x00000400,64,d\n(data),,,64,e\n";
  return r;
}

class OriginsTest : public testing::Test {
 protected:
  OriginsTest() : before(called()), after(called()) { after.elf = "22"; }
  static void replace(std::string& text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    ASSERT_NE(at, text.npos) << from;
    text.replace(at, from.size(), to);
  }
  Difference difference(RunPart part = RunPart::kWindow) {
    a = read_run(before.write(dir, "a"));
    b = read_run(after.write(dir, "b"));
    return difference_of(attribution_of(a, true), attribution_of(b, true), circumstances_of(a, b), part);
  }
  std::string text(bool slower = true) {
    const Difference d = difference();
    return blame_text(d, blame_of(d, slower));
  }
  /// put is called twice as often as before, by print: 100 clocks more, and 4 in print itself.
  void print_more() {
    replace(after.profile, "put,put.c,30,issue,,,40,40", "put,put.c,30,issue,,,80,80");
    replace(after.profile, "out,out.h,3,issue,,,60,60", "out,out.h,3,issue,,,120,120");
    replace(after.profile, "print,print.c,20,issue,,,50,50", "print,print.c,20,issue,,,54,54");
    replace(after.profile, "idle.capture,,,550", "idle.capture,,,446");
    replace(after.paths, "print|print.c;put|put.c,50", "print|print.c;put|put.c,150");
    replace(after.paths, "print|print.c,50", "print|print.c,54");
    replace(after.functions, "0x00000300,64,c", "0x00000300,68,cc");
  }
  TempDir dir;
  RunMaker before, after;
  RunFigures a, b;
};

TEST_F(OriginsTest, ALeafThatIsCalledMoreOftenIsItsCallersDoing) {
  print_more();
  EXPECT_EQ(text(),
            "print (print.c:20) executes more in put > out: +104 clocks (100 % of the change), of which +104 clocks by "
            "issue");
}

// If main has other code too, print is still the nearest; if only main has, it is main's doing.
TEST_F(OriginsTest, TheNearestCallerWithOtherCodeIsNamed) {
  print_more();
  replace(after.functions, "0x00000100,64,a", "0x00000100,64,aa");
  EXPECT_THAT(text(), testing::StartsWith("print (print.c:20) executes more"));
  replace(after.functions, "68,cc", "64,c");
  EXPECT_THAT(text(), testing::StartsWith("main (main.c) executes more in print > put > out: +104 clocks"));
}

TEST_F(OriginsTest, WithoutCallPathsTheFunctionItselfIsNamed) {
  print_more();
  before.paths.clear();
  EXPECT_THAT(text(), testing::StartsWith("out (out.h:3) executes more: +60 clocks"));
}

// put has other code: the instruction is in `out`, whose line was executed more by another factor than put's own.
TEST_F(OriginsTest, AnInlinedFunctionOfOtherCodeIsNamed) {
  replace(after.profile, "out,out.h,3,issue,,,60,60,put|put.c,",
          "out,out.h,3,issue,,,60,60,put|put.c,\nframes,out,out.h,4,issue,,,30,30,put|put.c,");
  replace(after.profile, "idle.capture,,,550", "idle.capture,,,520");
  replace(after.functions, "put,put.c,0x00000400,64,d", "put,put.c,0x00000400,68,dd");
  replace(after.functions, "out,out.h,0x00000400,64,d", "out,out.h,0x00000400,68,dd");
  EXPECT_THAT(text(), testing::StartsWith("out (out.h:4) executes more: +30 clocks"));
}

// The same with all lines of `out` executed by one factor more, and put's by none: put does it more often.
TEST_F(OriginsTest, AnInlinedFunctionThatIsExecutedMoreOftenIsItsHoldersDoing) {
  for (RunMaker* r : {&before, &after})
    replace(r->profile, "frames,sleep", "frames,out,out.h,4,issue,,,20,20,put|put.c,\nframes,sleep");
  for (RunMaker* r : {&before, &after}) replace(r->profile, "idle.capture,,,550", "idle.capture,,,530");
  replace(after.profile, "out,out.h,3,issue,,,60,60", "out,out.h,3,issue,,,120,120");
  replace(after.profile, "out,out.h,4,issue,,,20,20", "out,out.h,4,issue,,,40,40");
  replace(after.profile, "idle.capture,,,530", "idle.capture,,,450");
  replace(after.functions, "put,put.c,0x00000400,64,d", "put,put.c,0x00000400,68,dd");
  EXPECT_THAT(text(), testing::StartsWith("put (put.c) executes more in out: +80 clocks"));
}

// put calls `out` twice, for which the compiler no longer inlines it: `out` has its own code now, but did not change.
// If a line of it is new, it did.
TEST_F(OriginsTest, AFunctionThatIsNoLongerInlinedIsNotChangedByThat) {
  replace(after.profile, "out,out.h,3,issue,,,60,60,put|put.c", "out,out.h,3,issue,,,120,120,");
  replace(after.profile, "idle.capture,,,550", "idle.capture,,,490");
  replace(after.functions, "put,put.c,0x00000400,64,d", "put,put.c,0x00000400,40,dd");
  replace(after.functions, "out,out.h,0x00000400,64,d", "out,out.h,0x00000500,32,o");
  after.paths =
      "frames,main|main.c,100\nframes,main|main.c;draw|draw.c,200\nframes,main|main.c;print|print.c,50\n"
      "frames,main|main.c;draw|draw.c;put|put.c,20\nframes,main|main.c;draw|draw.c;put|put.c;out|out.h,60\n"
      "frames,main|main.c;print|print.c;put|put.c,20\nframes,main|main.c;print|print.c;put|put.c;out|out.h,60\n";
  EXPECT_THAT(text(), testing::ContainsRegex("^put \\(put\\.c[^)]*\\) executes more in out: \\+60 clocks"));
  replace(after.profile, "out,out.h,3,issue,,,120,120,",
          "out,out.h,3,issue,,,60,60,,\nframes,out,out.h,4,issue,,,60,60,");
  EXPECT_THAT(text(), testing::StartsWith("out (out.h:4) executes more"));
}

// Half of draw becomes a function of its own in the same file: nothing is slower but by the call, 6 clocks.
TEST_F(OriginsTest, CodeThatMovedToAFunctionOfTheFileCountsOnce) {
  replace(after.profile, "draw,draw.c,10,issue,,,200,200", "draw,draw.c,10,issue,,,106,106");
  after.profile += "frames,pixel,draw.c,8,issue,,,100,100,,\n";
  replace(after.profile, "idle.capture,,,550", "idle.capture,,,544");
  replace(after.paths, "draw|draw.c,200", "draw|draw.c,106");
  after.paths += "frames,main|main.c;draw|draw.c;pixel|draw.c,100\n";
  replace(after.functions, "0x00000200,64,b", "0x00000200,40,bb");
  after.functions += "pixel,draw.c,0x00000500,32,f\n";
  EXPECT_THAT(text(), testing::StartsWith("draw (draw.c) executes more in pixel: +6 clocks (100 % of the change)"));
}

// Code that moved between two functions that were there before, with 10 clocks more.
TEST_F(OriginsTest, CodeThatMovedBetweenFunctionsOfOneFileIsNetted) {
  for (RunMaker* r : {&before, &after}) replace(r->profile, "print,print.c", "print,draw.c");
  for (RunMaker* r : {&before, &after}) replace(r->functions, "print,print.c", "print,draw.c");
  replace(after.profile, "draw,draw.c,10,issue,,,200,200", "draw,draw.c,10,issue,,,100,100");
  replace(after.profile, "print,draw.c,20,issue,,,50,50", "print,draw.c,20,issue,,,160,160");
  replace(after.profile, "idle.capture,,,550", "idle.capture,,,540");
  replace(after.functions, "0x00000200,64,b", "0x00000200,40,bb");
  replace(after.functions, "0x00000300,64,c", "0x00000300,90,cc");
  EXPECT_THAT(text(), HasSubstr("print (draw.c:20) executes more: +10 clocks"));
  EXPECT_THAT(text(), HasSubstr("code moved between it and draw"));
}

// A loop that waits for what draw makes later: 90 clocks of it, 40 of draw.
TEST_F(OriginsTest, ALoopThatOnlyWaitsIsBlamedLast) {
  for (RunMaker* r : {&before, &after})
    replace(r->profile, "frames,print,print.c,20,issue,,,50,50,,", "frames,print,print.c,20,issue,,,50,50,,1");
  replace(after.profile, "print,print.c,20,issue,,,50,50,,1", "print,print.c,20,issue,,,140,140,,1");
  replace(after.profile, "draw,draw.c,10,issue,,,200,200", "draw,draw.c,10,issue,,,240,240");
  replace(after.profile, "idle.capture,,,550", "idle.capture,,,420");
  replace(after.functions, "0x00000200,64,b", "0x00000200,68,bb");
  EXPECT_THAT(text(), testing::StartsWith("draw (draw.c:10) executes more: +40 clocks"));
  // If nothing else takes longer, it polls longer.
  replace(after.profile, "draw,draw.c,10,issue,,,240,240", "draw,draw.c,10,issue,,,200,200");
  replace(after.profile, "idle.capture,,,420", "idle.capture,,,460");
  EXPECT_THAT(text(), testing::StartsWith("print (print.c:20) polls longer: +90 clocks"));
}

TEST_F(OriginsTest, AFunctionOfAnotherNameIsTheSame) {
  for (std::string* text : {&after.profile, &after.functions, &after.paths})
    for (std::size_t at; (at = text->find("draw,")) != text->npos;) text->replace(at, 5, "pict,");
  for (std::size_t at; (at = after.paths.find("draw|")) != after.paths.npos;) after.paths.replace(at, 5, "pict|");
  EXPECT_TRUE(difference().none());
  replace(after.profile, "pict,draw.c,10,issue,,,200,200", "pict,draw.c,10,issue,,,240,200");
  replace(after.profile, "idle.capture,,,550", "idle.capture,,,510");
  const Difference d = difference();
  ASSERT_EQ(d.functions.size(), 1u);
  EXPECT_EQ(d.functions[0].function, "pict");
  EXPECT_EQ(d.functions[0].share.change(), 40);
}

TEST_F(OriginsTest, PiecesThatACompilerMakesOfAFunctionAreIt) {
  replace(after.profile, "draw,draw.c", "draw.constprop.0,draw.c");
  replace(after.functions, "draw,draw.c", "draw.constprop.0,draw.c");
  EXPECT_TRUE(difference().none());
}

TEST_F(OriginsTest, FunctionsOfOneNameInFilesOfOneNameStayApart) {
  for (RunMaker* r : {&before, &after}) {
    replace(r->profile, "draw,draw.c", "step,a/x.c");
    replace(r->profile, "print,print.c", "step,b/x.c");
  }
  replace(after.profile, "step,a/x.c,10,issue,,,200", "step,a/x.c,10,issue,,,150");
  replace(after.profile, "step,b/x.c,20,issue,,,50", "step,b/x.c,20,issue,,,100");
  const Difference d = difference();
  EXPECT_EQ(d.busy.change(), 0);
  ASSERT_EQ(d.functions.size(), 2u);
  EXPECT_NE(d.functions[0].file, d.functions[1].file);
}

// A table has another name, and a longer wait.
TEST_F(OriginsTest, RegionsOfAnotherNameAreMatchedByAddressAndSize) {
  before.profile += "frames,draw,draw.c,10,dcache,lut,bridge,30,0,,\n";
  after.profile += "frames,draw,draw.c,10,dcache,table,bridge,50,0,,\n";
  replace(before.profile, "idle.capture,,,550", "idle.capture,,,520");
  replace(after.profile, "idle.capture,,,550", "idle.capture,,,500");
  before.objects = "lut,0x00001000,4096\nother,0x00002000,4096\n";
  after.objects = "table,0x00001000,4096\nother,0x00002000,4096\n";
  const Difference d = difference();
  ASSERT_EQ(d.functions.size(), 1u);
  ASSERT_EQ(d.functions[0].causes.size(), 1u);
  EXPECT_EQ(d.functions[0].causes[0].region, "table");
  EXPECT_EQ(d.functions[0].causes[0].share.change(), 20);
}

TEST_F(OriginsTest, ObjectsThatMovedAreNamed) {
  before.objects = "frame_out,0x00001000,4096\nlut,0x00004000,4096\nstate,0x00006000,64\n";
  after.objects = "frame_out,0x00002000,4096\nlut,0x00004040,4096\nstate,0x00006040,64\n";
  replace(after.profile, "frames,draw,draw.c,10,issue,,,200,200,,",
          "frames,draw,draw.c,10,issue,,,200,200,,\nframes,draw,draw.c,10,dcache,lut,row_conflict,70,0,,");
  replace(after.profile, "idle.capture,,,550", "idle.capture,,,480");
  replace(after.functions, "(data),,,64,e", "(data),,,64,ee");
  EXPECT_THAT(text(),
              testing::AllOf(testing::StartsWith("draw (draw.c:10) waits with the same instructions: +70 clocks"),
                             HasSubstr("; frame_out moved by +4,096 bytes, lut and 1 more moved by +64 bytes")));
}

/// Three remaps of 100 clocks and 20 of their own handler each, in a window of 1,000; the start has two phases.
RunMaker with_phases(unsigned remaps, unsigned each) {
  RunMaker r;
  r.chains = true;
  r.figure("cpu.cycles", "1000", "cycles").figure("frame.remapped", std::to_string(remaps));
  r.profile = fmt::format(
      "boot,main,main.c,1,issue,,,500,500,,\nlut,build,lut.c,2,issue,,,300,300,,\n"
      "remap,remap,remap.c,3,issue,,,{},{},,\nframes,irq,irq.c,4,issue,,,60,60,,\n"
      "frames,sleep,cp15.c,3,idle.capture,,,{},0,,\n",
      remaps * each, remaps * each, 940 - remaps * each);
  r.functions = "main,main.c,0x100,4,a\nbuild,lut.c,0x200,4,b\nremap,remap.c,0x300,4,c\nirq,irq.c,0x400,4,d\n";
  return r;
}

TEST_F(OriginsTest, EachPartOfARunHasItsOwnClocks) {
  before = with_phases(3, 100);
  after = with_phases(3, 100);
  after.elf = "22";
  replace(after.profile, "lut,build,lut.c,2,issue,,,300,300", "lut,build,lut.c,2,issue,,,390,390");
  replace(after.profile, "boot,main,main.c,1,issue,,,500,500", "boot,main,main.c,1,issue,,,540,540");
  replace(after.functions, "0x200,4,b", "0x200,8,bb");
  replace(after.functions, "0x100,4,a", "0x100,8,aa");
  EXPECT_TRUE(difference().none());
  EXPECT_TRUE(difference(RunPart::kRemap).none());
  const Difference lut = difference(RunPart::kLut);
  EXPECT_EQ(
      blame_text(lut, blame_of(lut, true)),
      "build (lut.c:2) executes more: +90 clocks (100 % of the change), of which +90 clocks by issue, in phase lut");
  const Difference start = difference(RunPart::kStartup);
  EXPECT_EQ(start.busy.before, 800);
  EXPECT_THAT(blame_text(start, blame_of(start, true)),
              testing::AllOf(testing::StartsWith("build (lut.c:2) executes more: +90 clocks (69 % of the change)"),
                             HasSubstr("; main +40 clocks, before the first frame")));
}

// Two remaps of 120 clocks instead of three of 100: fewer clocks in the window, and 20 more a remap.
TEST_F(OriginsTest, WindowsOfOtherNumbersOfRemapsAreComparedByTheRemap) {
  before = with_phases(3, 100);
  after = with_phases(2, 120);
  after.elf = "22";
  replace(after.functions, "0x300,4,c", "0x300,8,cc");
  const Difference d = difference(RunPart::kRemap);
  EXPECT_TRUE(d.per_remap);
  EXPECT_DOUBLE_EQ(d.busy.change(), 20);
  EXPECT_EQ(blame_text(d, blame_of(d, true)),
            "remap (remap.c:3) executes more: +20 clocks a remap (100 % of the change), of which +20 clocks a remap by "
            "issue, in phase remap");
  EXPECT_EQ(d.unexplained, 0);
}

// What executes less and takes longer is not said to execute less by more clocks.
TEST_F(OriginsTest, FewerInstructionsThatTakeLongerAreSaidSo) {
  replace(after.profile, "draw,draw.c,10,issue,,,200,200,,",
          "draw,draw.c,10,issue,,,150,150,,\nframes,draw,draw.c,10,dcache,lut,bridge,120,0,,");
  replace(after.profile, "idle.capture,,,550", "idle.capture,,,480");
  replace(after.functions, "0x00000200,64,b", "0x00000200,60,bb");
  EXPECT_THAT(text(), testing::StartsWith("draw (draw.c:10) takes longer with fewer instructions: +70 clocks"));
}

/// A failed figure, in clocks of 1 us, and what is said about it.
class CheckBlameTest : public OriginsTest {
 protected:
  CheckBlameTest() {
    before = with_phases(3, 100);
    after = with_phases(3, 100);
    after.elf = "22";
    for (RunMaker* r : {&before, &after}) r->figure("frame.window", "0.001", "s");
  }
  void figure(const std::string& name, double was, double is, double tolerance = 0.01) {
    Expectation e;
    e.name = name;
    e.value = was;
    e.unit = "s";
    e.tolerance.relative = tolerance;
    e.worse = Worse::kHigher;
    expected.push_back(e);
    after.figure(name, std::to_string(is), "s");
  }
  std::string blamed() {
    a = read_run(before.write(dir, "a"));
    b = read_run(after.write(dir, "b"));
    std::vector<Finding> findings;
    for (const Expectation& e : expected) findings.push_back(judge(e, b));
    return blame_failures(findings, attribution_of(a, true), attribution_of(b, true), circumstances_of(a, b)).text;
  }
  std::vector<Expectation> expected;
};

TEST_F(CheckBlameTest, AFigureIsBlamedInItsOwnPart) {
  figure("startup.lut_time", 0.0003, 0.00039);
  replace(after.profile, "lut,build,lut.c,2,issue,,,300,300", "lut,build,lut.c,2,issue,,,390,390");
  replace(after.functions, "0x200,4,b", "0x200,8,bb");
  // Something in the window changed too, by more: it has nothing to do with the figure.
  replace(after.profile, "frames,irq,irq.c,4,issue,,,60,60", "frames,irq,irq.c,4,issue,,,160,160");
  replace(after.profile, "idle.capture,,,640", "idle.capture,,,540");
  replace(after.functions, "0x400,4,d", "0x400,8,dd");
  EXPECT_EQ(
      blamed(),
      "build (lut.c:2) executes more: +90 clocks (100 % of the change), of which +90 clocks by issue, in phase lut");
}

// The look-up table takes 100 clocks longer: 11 are more than a tenth of that, 9 are less.
TEST_F(CheckBlameTest, NothingIsBlamedThatIsTooSmallForTheFigure) {
  figure("startup.lut_time", 0.0003, 0.0004);
  replace(after.functions, "0x200,4,b", "0x200,8,bb");
  replace(after.profile, "lut,build,lut.c,2,issue,,,300,300", "lut,build,lut.c,2,issue,,,311,311");
  EXPECT_THAT(blamed(), testing::StartsWith("build (lut.c:2) executes more: +11 clocks"));
  replace(after.profile, "lut,build,lut.c,2,issue,,,311,311", "lut,build,lut.c,2,issue,,,309,309");
  EXPECT_EQ(
      blamed(),
      "nothing for startup.lut_time: in phase lut busy clocks changed by +9 clocks of 300 clocks, which is not enough");
}

TEST_F(CheckBlameTest, AReferenceWithoutTheStartSaysSo) {
  figure("startup.first_frame", 0.0008, 0.0009);
  before.profile = before.profile.substr(before.profile.find("remap,"));
  EXPECT_THAT(blamed(),
              HasSubstr("nothing for startup.first_frame, because the reference has no clocks before the first frame"));
}

// A remap that is longer prolongs the latency: one sentence for both.
TEST_F(CheckBlameTest, TheWindowDoesNotRepeatWhatItsRemapsSay) {
  figure("frame.remap_time.mean", 0.0001, 0.00015);
  figure("frame.latency.mean", 0.0002, 0.00025);
  after = with_phases(3, 150);
  after.elf = "22";
  after.figure("frame.window", "0.001", "s");
  for (const char* name : {"frame.remap_time.mean", "frame.latency.mean"})
    after.figure(name, name[6] == 'r' ? "0.00015" : "0.00025", "s");
  before.figure("frame.remap_time.mean", "0.0001", "s");
  replace(after.functions, "0x300,4,c", "0x300,8,cc");
  EXPECT_EQ(blamed(),
            "remap (remap.c:3) executes more: +150 clocks (100 % of the change), of which +150 clocks by issue, in "
            "phase remap");
}

TEST(PartTest, FiguresBelongToTheirParts) {
  EXPECT_EQ(part_of_figure("startup.lut_time"), RunPart::kLut);
  EXPECT_EQ(part_of_figure("startup.first_frame"), RunPart::kStartup);
  EXPECT_EQ(part_of_figure("frame.remap_time.mean"), RunPart::kRemap);
  EXPECT_EQ(part_of_figure("frame.latency.mean"), RunPart::kWindow);
}

}  // namespace
}  // namespace fovea::regression
