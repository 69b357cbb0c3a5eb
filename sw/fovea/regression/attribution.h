// Where the clocks of a run's window went: rows of profile.csv, or of stalls.csv without functions.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sw/fovea/regression/run_figures.h"
#include "sw/fovea/sleep.h"

namespace fovea::regression {

/// Clocks of one function, line, cause, region and culprit. Texts are empty where there is none.
struct AttributionRow {
  std::string phase, function, file;
  unsigned line = 0;  ///< 0: unknown
  /// `issue`, `idle.<event>` (or `idle`), `wait.dma`, `wait.engine` or `wait.dma_or_engine` (or `wait`), or a stall
  /// cause.
  std::string cause;
  std::string region, culprit;
  std::uint64_t clocks = 0, instructions = 0;

  bool idle() const { return app::is_idle(cause); }
};

/// Name and file of a function.
using FunctionKey = std::pair<std::string, std::string>;

/// A piece of code, from functions.csv: texts that are equal or not.
struct CodePlace {
  std::string address, size, code;
  auto operator<=>(const CodePlace&) const = default;
};
/// The name of the row that stands for all objects of the program.
inline const FunctionKey kDataPlace{"(data)", ""};

struct Attribution {
  std::vector<AttributionRow> rows;
  /// Where the code of each function lies, that of an inlined one in each function that holds it; empty:
  /// the run does not tell.
  std::map<FunctionKey, std::set<CodePlace>> places;
  bool by_function = false;  ///< from a profile
  double clocks = 0;         ///< cpu.cycles, which the rows should add up to
  double seconds = 0;        ///< length of a clock; 0: unknown

  double sum() const;
};

/// The attribution of a run: from profile.csv if `profile` and the run has one, else from
/// stalls.csv, cpu.issue and cpu.idle. Without any of these it has no rows. @throws UserError if a
/// file cannot be read, or its rows miss cpu.cycles by more than 1 %
Attribution attribution_of(const RunFigures& run, bool profile);
/// True if the folder has a profile.
bool has_profile(const RunFigures& run);

/// Texts in the formats of profile.csv and functions.csv.
std::string attribution_csv(const Attribution& attribution);
std::string places_csv(const Attribution& attribution);

}  // namespace fovea::regression
