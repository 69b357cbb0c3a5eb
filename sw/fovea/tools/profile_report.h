// The files of a profile: the core's clocks by function, source line, cause, region and culprit.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "model/cpu/core/clock_profile.h"
#include "sw/fovea/program/poll_loops.h"
#include "sw/fovea/program/source_lines.h"
#include "sw/fovea/tools/tool.h"

namespace fovea::app {

/// Clocks by call path, as a tree.
using ProfileStacks = std::vector<cpu::CallStacks::Path>;

/// Functions of a call path that a file shows: those of a deeper one are its first ones, `...` and its last one, so
/// that a file grows with the program and not with the depth of a recursion.
inline constexpr std::size_t kShownDepth = 200;

/// A part of the run, such as `boot`; its rows as ClockProfile gives them.
struct ProfilePhase {
  std::string name;
  bool window = false;  ///< part of the measured window
  std::vector<cpu::ProfileRow> rows;
  ProfileStacks stacks = {};  ///< all clocks of the phase
};

/// Calls of the window from one instruction to one function.
struct ProfileCall {
  std::uint32_t from = 0, to = 0;
  std::uint64_t count = 0;
  std::uint64_t clocks = 0;  ///< in the function and what it calls
};

struct ProfileData {
  std::string program;  ///< file name
  std::vector<ProfilePhase> phases;
  std::vector<std::string> regions;  ///< names, by number
  ProfileStacks stacks;  ///< of the window
  std::vector<ProfileCall> calls;
  std::vector<cpu::CallStacks::Range> ranges;  ///< of the stack pointer
  cpu::MaskWatch::Stretch masked;              ///< the longest stretch with IRQs masked
  /// From the latch of an interrupt to the instruction at its vector, by source, in order of time.
  std::map<std::string, std::vector<Picoseconds>> interrupts;
};

/// The functions of programs, the first program's first, as CallStacks wants them. A label in code that
/// lies in no function goes on to the next one.
std::vector<cpu::CallStacks::Function> program_functions(std::span<const ElfImage* const> programs);

/// profile.csv: `phase,function,file,line,cause,region,culprit,clocks,instructions,inlined_in,polls`, a row
/// for each combination with clocks. Instructions are counted in the rows of `issue`. `inlined_in`: the
/// functions that hold the inlined one, outermost first, each as `function|file`, with `;` between them.
/// `polls`: 1 in a loop that only waits (poll_loops.h). Equal profiles give equal bytes.
std::string profile_csv(const ProfileData& data, SourceLines& lines, const PollLoops& polls);
/// paths.csv: `phase,path,clocks`, the clocks of each phase by call path, written as `inlined_in` is; see kShownDepth.
std::string paths_csv(const ProfileData& data, SourceLines& lines);
/// objects.csv: `object,address,size`, the objects of the programs from kObjectBytes on, by address.
std::string objects_csv(std::span<const ElfImage* const> programs);
inline constexpr std::uint32_t kObjectBytes = 64;
/// profile.callgrind: the window by instruction, with calls, as callgrind_annotate and KCachegrind read
/// it.
std::string profile_callgrind(const ProfileData& data, SourceLines& lines);
/// profile.folded: a line `a;b;c clocks` for each call stack of the window, for flame graphs; see kShownDepth.
std::string profile_folded(const ProfileData& data, SourceLines& lines);
/// profile.txt: functions, lines and instructions of the window for people, and the phases.
std::string profile_text(const ProfileData& data, SourceLines& lines);
/// interrupts.csv: `interrupt,count,mean_ns,p99_ns,max_ns`, from the latch of each interrupt that the
/// window has seen to the instruction at its vector. p99: no more than 1 % took longer.
std::string interrupts_csv(const ProfileData& data);
/// functions.csv: `function,file,address,size,code`, for each function of profile.csv with clocks where its
/// code lies (that of an inlined one in each function that holds it) and a hash of it
/// that does not depend on addresses (code_places.h). The row `(data)` has the bytes and the hash of all
/// objects.
std::string functions_csv(const ProfileData& data, SourceLines& lines,
                          std::span<const ElfImage* const> programs);
/// The functions with most clocks of the window.
std::string profile_table(const ProfileData& data, SourceLines& lines, std::size_t functions);

/// All of these files and, for the user, the functions with most clocks and what is missing.
/// @param programs in whose names and lines the profile speaks; null: none
ToolOutput profile_result(const ProfileData& data, std::span<const ElfImage* const> programs);

}  // namespace fovea::app
