// Where the clocks of a run went: rows of profile.csv, or, of its window, of stalls.csv without functions.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sw/fovea/results/sleep.h"
#include "sw/fovea/results/run_figures.h"

namespace fovea::regression {

/// Name and file of a function. The name is that in the source, without what a compiler appends to the pieces that it
/// makes of one; the file has no folder, unless a function of that name is in two files of one name.
using FunctionKey = std::pair<std::string, std::string>;

/// Clocks of one function, line, cause, region and culprit. Texts are empty where there is none.
struct AttributionRow {
  std::string phase, function, file;
  unsigned line = 0;  ///< 0: unknown
  /// `issue`, `idle.<event>` (or `idle`), `wait.dma`, `wait.engine` or `wait.dma_or_engine` (or `wait`), or a stall
  /// cause.
  std::string cause;
  std::string region, culprit;
  std::uint64_t clocks = 0, instructions = 0;
  std::vector<FunctionKey> holders = {};  ///< functions that hold this one inlined, outermost first
  bool polls = false;                     ///< in a loop that only waits

  FunctionKey key() const { return {function, file}; }
  bool idle() const { return app::is_idle(cause); }
};

/// A piece of code, from functions.csv: texts that are equal or not.
struct CodePlace {
  std::string address, size, code;
  auto operator<=>(const CodePlace&) const = default;
};
/// The name of the row that stands for all objects of the program.
inline const FunctionKey kDataPlace{"(data)", ""};

/// Clocks of a phase in a function that was called in this way.
struct CallPath {
  std::string phase;
  std::vector<FunctionKey> functions;  ///< outermost first
  std::uint64_t clocks = 0;
};

/// An object of the program: its name is a region's if it is large.
struct ObjectPlace {
  std::string name;
  std::uint64_t address = 0, size = 0;
};

/// Phases of profile.csv.
inline constexpr const char *kFramesPhase = "frames", *kRemapPhase = "remap", *kLutPhase = "lut";

struct Attribution {
  std::vector<AttributionRow> rows;     ///< of the window
  std::vector<AttributionRow> startup;  ///< of what came before it; empty: the run does not tell
  std::vector<CallPath> paths;          ///< of all phases; empty: the run does not tell
  std::vector<ObjectPlace> objects;     ///< in the order of their addresses
  /// Where the code of each function lies, that of an inlined one in each function that holds it; empty:
  /// the run does not tell.
  std::map<FunctionKey, std::set<CodePlace>> places;
  bool by_function = false;  ///< from a profile
  double clocks = 0;         ///< cpu.cycles, which the rows should add up to
  double seconds = 0;        ///< length of a clock; 0: unknown
  double remaps = 0;         ///< remaps within the window, with fractions at its edges; 0: unknown

  double sum() const;
};

/// The attribution of a run: from profile.csv if `profile` and the run has one, else from
/// stalls.csv, cpu.issue and cpu.idle. Without any of these it has no rows. @throws UserError if a
/// file cannot be read, or its rows miss cpu.cycles by more than 1 %
Attribution attribution_of(const RunFigures& run, bool profile);
/// True if the folder has a profile.
bool has_profile(const RunFigures& run);

/// Texts in the formats of profile.csv, functions.csv, paths.csv and objects.csv. Of what came before the window, rows
/// and paths with less than kDetail of their phase are joined: rows by function and cause, paths by function.
inline constexpr double kDetail = 5e-4;
std::string attribution_csv(const Attribution& attribution);
std::string places_csv(const Attribution& attribution);
std::string paths_csv(const Attribution& attribution);
std::string objects_csv(const Attribution& attribution);

}  // namespace fovea::regression
