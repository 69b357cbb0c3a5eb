// The files of a profile, and the functions and lines of a program's addresses.
#include <fmt/format.h>

#include <cstdlib>
#include <set>

#include "sw/fovea/program/code_places.h"
#include "sw/fovea/tools/frame_parts.h"
#include "sw/fovea/tools/profile_report.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

using cpu::ProfileRow;
using test::read_text;
using test::TempDir;
using test::user_error;
using testing::HasSubstr;

const std::string kInlined = FIXTURE_INLINED, kStripped = FIXTURE_STRIPPED;

/// Number of the line of the fixture that has a mark.
unsigned line_with(const std::string& mark) {
  const std::string text = read_text(FIXTURE_SOURCE);
  const std::size_t at = text.find("line " + mark + " *");
  return 1 + static_cast<unsigned>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
}

/// Addresses of the code of a function.
std::vector<std::uint32_t> code_of(const ElfImage& image, const char* name) {
  std::vector<std::uint32_t> out;
  const ElfSymbol* const s = image.find(name);
  for (std::uint32_t a = s->address; a < s->address + s->size; a += 4) out.push_back(a);
  return out;
}

TEST(SourceLinesTest, InlinedFunctionsAreResolved) {
  const ElfImage image = ElfImage::load(kInlined);
  SourceLines lines;
  lines.add(image);
  EXPECT_TRUE(lines.have_lines());
  std::set<std::size_t> depths;
  for (const std::uint32_t a : code_of(image, "outer")) {
    const auto& frames = lines.at(a);
    depths.insert(frames.size());
    EXPECT_EQ(frames.back().function, "outer");
    EXPECT_EQ(frames.back().file, "inlined.c");
    if (frames.size() < 3) continue;
    EXPECT_EQ(frames[0], (SourceFrame{"innermost", "inlined.c", line_with("innermost")}));
    EXPECT_EQ(frames[1], (SourceFrame{"middle", "inlined.c", line_with("middle")}));
    EXPECT_EQ(frames[2], (SourceFrame{"outer", "inlined.c", line_with("outer")}));
  }
  EXPECT_TRUE(depths.contains(3)) << "the load and the product are inlined twice";
  EXPECT_EQ(lines.at(image.entry()).front().function, "_start");
  EXPECT_EQ(lines.function_start(code_of(image, "outer").back()), image.find("outer")->address);
}

TEST(SourceLinesTest, WithoutDebugInformationTheSymbolsAreKnown) {
  const ElfImage image = ElfImage::load(kStripped);
  SourceLines lines;
  lines.add(image);
  EXPECT_FALSE(lines.have_lines());
  const std::uint32_t inside = image.find("outer")->address + 4;
  EXPECT_EQ(lines.at(inside), (std::vector<SourceFrame>{{"outer", "", 0}}));
  EXPECT_EQ(lines.at(0x10), (std::vector<SourceFrame>{{"(unknown)", "", 0}}));
  EXPECT_EQ(lines.function_start(0x10), 0x10u);
}

TEST(SourceLinesTest, ASecondProgramNamesWhatTheFirstDoesNotHave) {
  const ElfImage first = ElfImage::load(FIXTURE_OUTSIDE), second = ElfImage::load(kInlined);
  SourceLines lines;
  lines.add(first);
  lines.add(second);
  EXPECT_EQ(lines.at(second.find("outer")->address).back().function, "outer");
  EXPECT_EQ(lines.at(first.entry() & ~1u).back().function, "_start");
}

TEST(SourceLinesTest, AProgramThatIsGone) {
  TempDir dir;
  const auto file = dir.write("p.elf", read_text(kInlined));
  const ElfImage image = ElfImage::load(file);
  std::filesystem::remove(file);
  SourceLines lines;
  EXPECT_THAT(user_error([&] { lines.add(image); }), HasSubstr("can no longer be read"));
}

constexpr std::uint8_t stall(cpu::Cause c) {
  return static_cast<std::uint8_t>(ProfileRow::kStall + cpu::index(c));
}

class ProfileReportTest : public testing::Test {
 protected:
  ProfileReportTest() {
    lines.add(image);
    const auto outer = code_of(image, "outer");
    // The first instruction that is innermost's.
    for (const std::uint32_t a : outer)
      if (!inner && lines.at(a).size() == 3) inner = a;
    start = image.entry();
    data.program = "inlined.elf";
    data.regions = {"none", "other", "sdram, slow"};
    const auto dcache = stall(cpu::Cause::kDcache);
    data.phases = {
        {"boot", false, {{start, ProfileRow::kIssue, 0, 0, 7, 5}}, {{}, {0, start, 7}}},
        {"frames",
         true,
         {{start, ProfileRow::kIssue, 0, 0, 20, 10},
          {start, ProfileRow::kIdle + 2, 0, 0, 40, 0},
          {start + 4, ProfileRow::kIssue, 0, 0, 0, 1},  // ended in the section, without clocks
          {inner, ProfileRow::kIssue, 0, 0, 100, 50},
          {inner, dcache, 2, static_cast<std::uint8_t>(cpu::kService), 300, 0},
          {inner, dcache, 2, static_cast<std::uint8_t>(cpu::kCore), 30, 0},
          {0x10, stall(cpu::Cause::kInterlock), 0, static_cast<std::uint8_t>(cpu::kCore), 10, 0}}}};
    // The program was started twice.
    data.stacks = {{0, 0, 5}, {0, start, 60}, {1, image.find("outer")->address, 430}, {0, start, 5}};
    data.calls = {{start, image.find("outer")->address, 50, 430}};
  }
  ElfImage image = ElfImage::load(kInlined);
  SourceLines lines;
  ProfileData data;
  std::uint32_t inner = 0, start = 0;
};

TEST_F(ProfileReportTest, RowsByFunctionLineCauseRegionAndCulprit) {
  const std::string text = profile_csv(data, lines, PollLoops());
  const std::string at = std::to_string(line_with("innermost")), held = "outer|inlined.c;middle|inlined.c";
  const auto begin_line = std::to_string(lines.at(start).front().line);
  EXPECT_EQ(text,
            "phase,function,file,line,cause,region,culprit,clocks,instructions,inlined_in,polls\n"
            "boot,_start,inlined.c," + begin_line + ",issue,,,7,5,,\n"
            "frames,(unknown),,,interlock,none,core,10,0,,\n"
            "frames,_start,inlined.c," + begin_line + ",issue,,,20,10,,\n"
            "frames,_start,inlined.c," + begin_line + ",idle.capture,,,40,0,,\n"
            "frames,innermost,inlined.c," + at + ",issue,,,100,50," + held + ",\n"
            "frames,innermost,inlined.c," + at + ",dcache,\"sdram, slow\",service,300,0," + held + ",\n"
            "frames,innermost,inlined.c," + at + ",dcache,\"sdram, slow\",core,30,0," + held + ",\n");
}

TEST_F(ProfileReportTest, FoldedStacks) {
  EXPECT_EQ(profile_folded(data, lines), "(unknown) 5\n_start 65\n_start;outer 430\n");
}

// 100,000 calls of a function by itself are a few hundred lines; all clocks are in them.
TEST_F(ProfileReportTest, FilesDoNotGrowWithTheDepthOfARecursion) {
  const std::uint32_t outer = image.find("outer")->address;
  data.stacks = {{}, {0, start, 1}};
  for (std::uint32_t n = 1; n <= 100'000; ++n) data.stacks.push_back({n, outer, 3});
  data.stacks.push_back({100'001, start, 7});
  data.phases.back().stacks = data.stacks;
  const std::string text = profile_folded(data, lines);
  std::string deepest = "_start";
  for (std::size_t n = 1; n < kShownDepth; ++n) deepest += ";outer";
  EXPECT_THAT(text, HasSubstr("\n" + deepest + " 3\n"));
  EXPECT_THAT(text, HasSubstr("\n" + deepest + ";...;outer " + std::to_string(3 * (100'001 - kShownDepth)) + "\n"));
  EXPECT_THAT(text, HasSubstr("\n" + deepest + ";...;_start 7\n"));
  EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')), kShownDepth + 2);
  EXPECT_LT(paths_csv(data, lines).size(), std::size_t{1} << 20);
}

TEST_F(ProfileReportTest, TableNamesTheLargestCauses) {
  const std::string text = profile_table(data, lines, 1);
  EXPECT_THAT(text, HasSubstr(" 86.0 %         430            50  innermost (inlined.c): "
                              "dcache 77 %, issue 23 %\n"));
  EXPECT_THAT(text, HasSubstr("and 2 more"));
  EXPECT_THAT(profile_text(data, lines), HasSubstr("boot                 7  issue 100 %"));
  ProfileData nothing;
  EXPECT_EQ(profile_table(nothing, lines, 5), "");
}

TEST_F(ProfileReportTest, InterruptsAndTheirWorstPercent) {
  EXPECT_EQ(interrupts_csv(data), "interrupt,count,mean_ns,p99_ns,max_ns\n");
  data.interrupts["timer0.tint12"] = {3000, 1000, 2001};
  // One of a hundred may take longer than p99, but none of 99.
  for (unsigned k = 1; k <= 100; ++k) data.interrupts["vpss.vpssint0"].push_back(k * 1000);
  EXPECT_EQ(interrupts_csv(data),
            "interrupt,count,mean_ns,p99_ns,max_ns\n"
            "timer0.tint12,3,2.000,3.000,3.000\n"
            "vpss.vpssint0,100,50.500,99.000,100.000\n");
  data.interrupts["vpss.vpssint0"].pop_back();
  EXPECT_THAT(interrupts_csv(data), HasSubstr("vpss.vpssint0,99,50.000,99.000,99.000\n"));
}

TEST_F(ProfileReportTest, MaskedStretchAndStacks) {
  EXPECT_THAT(profile_text(data, lines), testing::Not(HasSubstr("masked")));
  data.masked = {1234, start, inner};
  data.ranges = {{0x4000, 0x3f00, start}};
  const std::string text = profile_text(data, lines);
  EXPECT_THAT(text, HasSubstr("IRQs masked, without sleep: 1234 clocks, from 0x8"));
  EXPECT_THAT(text, HasSubstr("0x00004000 down to 0x00003f00: 256 bytes, begun in _start"));
}

TEST(FramePartsTest, PartsAddUpToTheLatency) {
  video::FrameTimes frame;
  frame.index = 7;
  frame.capture_start = 1'000;
  frame.capture_end = 21'000;
  frame.remap_start = 25'500;
  frame.remap_end = 35'501;
  frame.display_start = 40'000;
  std::map<Picoseconds, cpu::ClockProfile::Snapshot> snapshots;
  auto& from = snapshots[25'500];
  auto& to = snapshots[35'501];
  from.issue = 100;
  from.idle = 5;
  to = from;
  to.issue = 101;
  to.stall[cpu::index(cpu::Cause::kDcache)] = 2;
  const std::string head = "frame,part,time_ns\n";
  EXPECT_EQ(frame_parts_csv(std::vector{frame}, snapshots),
            head + "7,capture,20.000\n7,wait_for_core,4.500\n7,remap.issue,3.333\n"
                   "7,remap.dcache,6.668\n7,wait_for_display,4.499\n");
  // The remap was not seen by the core, or the frame has no remap.
  snapshots.erase(35'501);
  EXPECT_EQ(frame_parts_csv(std::vector{frame}, snapshots), head);
  snapshots[35'501] = from;
  EXPECT_THAT(frame_parts_csv(std::vector{frame}, snapshots), HasSubstr("7,remap,10.001\n"));
  frame.remap_start.reset();
  EXPECT_EQ(frame_parts_csv(std::vector{frame}, snapshots), head);
}

/// Hashes of the functions of a variant of the fixture, and of its data as "(data)".
std::map<std::string, std::string> hashes_of(const std::string& variant) {
  const ElfImage image = ElfImage::load(FIXTURE_PLACES + variant + ".elf");
  std::map<std::string, std::string> out{{"(data)", data_hash(image)}};
  for (const char* name : {"one", "two", "small", "_start"}) {
    const ElfSymbol* const s = image.find(name);
    EXPECT_EQ(s->thumb, std::string_view(name) == "small");
    out[name] = code_hash(image, s->address, s->size, s->thumb);
  }
  return out;
}

TEST(CodePlacesTest, CodeThatIsMovedStaysTheSame) {
  const auto base = hashes_of("");
  EXPECT_EQ(hashes_of("_moved"), base);
  std::set<std::string> different;
  for (const auto& [name, hash] : base) different.insert(hash);
  EXPECT_EQ(different.size(), base.size());
}

TEST(CodePlacesTest, WhatIsChangedIsFoundAndNothingElse) {
  for (const auto& [variant, changed] : {std::pair("_constant", "small"), std::pair("_entry", "(data)"),
                                         std::pair("_callee", "small")}) {
    const auto base = hashes_of(""), now = hashes_of(variant);
    for (const auto& [name, hash] : base) EXPECT_EQ(now.at(name) != hash, name == changed) << variant << " " << name;
  }
}

// Also where one begins at the end of another.
TEST(ProgramFunctionsTest, EachFunctionOfTheSymbolTableIsOne) {
  const ElfImage image = ElfImage::load(FIXTURE_PLACES ".elf");
  const ElfImage* const programs[] = {&image};
  std::map<std::uint32_t, std::uint32_t> ends, expected;
  for (const auto& f : program_functions(programs)) ends[f.begin] = f.end;
  unsigned adjacent = 0;
  for (const ElfSymbol& s : image.symbols())
    if (s.function && s.size) expected[s.address] = s.address + s.size;
  for (const auto& [begin, end] : expected) {
    EXPECT_EQ(ends[begin], end) << std::hex << begin;
    adjacent += expected.contains(end);
  }
  EXPECT_GT(adjacent, 0u) << "the fixture must have functions side by side";
}

TEST_F(ProfileReportTest, FunctionsLieWhereTheProgramHasThem) {
  const ElfImage* const programs[] = {&image};
  const ElfSymbol* const outer = image.find("outer");
  const std::string text = functions_csv(data, lines, programs);
  EXPECT_THAT(text, testing::StartsWith("function,file,address,size,code\n"));
  // The inlined one lies in the function that holds it; boot is not of the window, and the first rows
  // of the window that have clocks are _start's and innermost's.
  EXPECT_THAT(text, HasSubstr(fmt::format("\ninnermost,inlined.c,0x{:08x},{},", outer->address, outer->size)));
  EXPECT_THAT(text, HasSubstr(fmt::format("\n_start,inlined.c,0x{:08x},", start)));
  EXPECT_THAT(text, HasSubstr("\n(data),,,4,"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
}

/// Names of all functions of a program, as its call paths and the debugger have them. Further entries of a function,
/// such as those of the comparisons in libgcc, which run into each other, are none of their own.
std::vector<std::string> names_of(const char* file, bool symbols) {
  const ElfImage image = ElfImage::load(file);
  const ElfImage* const programs[] = {&image};
  SourceLines lines;
  lines.add(image);
  std::vector<std::string> out;
  for (const auto& f : program_functions(programs))
    out.push_back(symbols ? image.describe(f.begin) : lines.function_text(f.begin));
  return out;
}

// Two classes, overloads, constructors and destructors, lambdas, and two files.
TEST(FunctionNamesTest, NoTwoFunctionsHaveOneName) {
  for (const char* file : {FIXTURE_NAMES, FIXTURE_NAMES_STRIPPED})
    for (const bool symbols : {false, true}) {
      const auto names = names_of(file, symbols);
      const std::set<std::string> different(names.begin(), names.end());
      EXPECT_EQ(different.size(), names.size()) << file << ": " << testing::PrintToString(names);
      EXPECT_GE(names.size(), 15u) << file;
      for (const char* name :
           {"A::step(int)", "B::step(int)", "Made::Made(int)", "Made::Made(Made const&)", "_start", "elsewhere",
            "(anonymous namespace)::func(int)", "(anonymous namespace)::func(float)",
            "_start::{lambda(int)#1}::operator()(int) const", "_start::{lambda(int)#2}::operator()(int) const",
            "helper() (names.cpp)", "helper() (other_names.cpp)"})
        EXPECT_TRUE(different.contains(name)) << name << ": " << testing::PrintToString(names);
    }
}

// Deleting an object calls its destructor, which has the same name in the source.
TEST(FunctionNamesTest, TheTwoDestructorsAreNoRecursion) {
  const auto names = names_of(FIXTURE_NAMES, false);
  EXPECT_EQ(std::count_if(names.begin(), names.end(), [](const auto& n) { return n.starts_with("Made::~Made()"); }), 2);
}

// Of those without a symbol the debug information has to tell the same.
TEST(FunctionNamesTest, InlinedFunctionsHaveTheirScopesAndParameters) {
  const ElfImage image = ElfImage::load(FIXTURE_NAMES);
  SourceLines lines;
  lines.add(image);
  std::set<std::string> inlined;
  for (const std::uint32_t a : code_of(image, "_start"))
    if (lines.at(a).size() > 1) inlined.insert(lines.at(a).front().function);
  EXPECT_EQ(inlined, (std::set<std::string>{"(anonymous namespace)::within(int)",
                                            "(anonymous namespace)::within(char const*)",
                                            "(anonymous namespace)::Local::inlined(unsigned int) const"}));
}

TEST(FunctionNamesTest, SymbolsAreFoundByBothNames) {
  const ElfImage image = ElfImage::load(FIXTURE_NAMES);
  ASSERT_TRUE(image.find("A::step(int)"));
  EXPECT_EQ(image.find("A::step(int)"), image.find("_ZN1A4stepEi"));
  EXPECT_NE(image.find("helper() (names.cpp)"), image.find("helper() (other_names.cpp)"));
  EXPECT_EQ(demangled("_Zbad"), "_Zbad");
  EXPECT_EQ(demangled("plain"), "plain");
}

TEST(PollLoopsTest, OnlyLoopsThatWaitAreFound) {
  const ElfImage image = ElfImage::load(FIXTURE_POLLS);
  const ElfImage* const programs[] = {nullptr, &image};
  const PollLoops polls(programs);
  unsigned functions = 0;
  for (const ElfSymbol& s : image.symbols()) {
    if (!s.function || s.size == 0) continue;
    ++functions;
    unsigned found = 0;
    for (std::uint32_t a = s.address; a < s.address + s.size; a += 4) found += polls.contains(a);
    EXPECT_EQ(found > 0, s.name.starts_with("wait_")) << s.name;
    EXPECT_LT(found, s.size / 4) << s.name << ": the return is none of it";
  }
  EXPECT_EQ(functions, 11u);
}

/// callgrind_annotate, of Debian's valgrind, reads the file and finds the same sums.
TEST_F(ProfileReportTest, CallgrindFileOpens) {
  TempDir dir;
  const auto file = dir.write("profile.callgrind", profile_callgrind(data, lines));
  const auto out = dir.path() / "out";
  const std::string command = "callgrind_annotate --inclusive=yes --threshold=100 --show=Clocks '" +
                              file.string() + "' >'" + out.string() + "' 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << read_text(out);
  const std::string text = read_text(out);
  EXPECT_THAT(text, HasSubstr("500 (100.0%)  PROGRAM TOTALS"));
  EXPECT_THAT(text, HasSubstr("490 (98.00%)  inlined.c:_start"));
  EXPECT_THAT(text, HasSubstr("430 (86.00%)  inlined.c:innermost"));
}

}  // namespace
}  // namespace fovea::app
