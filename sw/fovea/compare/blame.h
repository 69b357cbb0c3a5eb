// The difference of two runs' clocks, by function, line, cause and culprit, and what is to blame.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/compare/attribution.h"
#include "sw/fovea/compare/origins.h"

namespace fovea::regression {

/// Why a function's clocks changed.
enum class ChangeKind {
  kAdded,     ///< only the second run has it
  kRemoved,   ///< only the first run has it
  kExecutes,  ///< it executes another number of instructions
  kLayout,    ///< the same code at other addresses
  kWaits,     ///< the same instructions, which wait for something else or longer
  kPolls,     ///< it waits in a loop of its own for what comes later or earlier
};
/// "new", "gone", "executes more", ... for a table. `more` is the sign of the instructions.
std::string kind_text(ChangeKind kind, bool more);

/// The part of a run whose clocks are compared.
enum class RunPart {
  kWindow,   ///< the measured window
  kRemap,    ///< its remaps
  kLut,      ///< the look-up table, before it
  kStartup,  ///< all that comes before it
};
/// The part that a figure measures: `startup.lut_time` the look-up table, `frame.remap_time.mean` the remaps.
RunPart part_of_figure(const std::string& name);
/// "in phase lut", or empty for the window.
std::string part_text(RunPart part);

/// A part of a difference. Amounts are clocks, or seconds if the clocks of the cores differ.
struct Share {
  double before = 0, after = 0;
  double change() const { return after - before; }
};

/// A cause with region and culprit, or a line.
struct CauseChange {
  std::string cause, region, culprit;
  Share share;
};
struct LineChange {
  std::optional<unsigned> before, after;  ///< numbers in the two sources; empty: not there
  Share share;
  std::map<std::string, double> causes;  ///< change of each cause that changed; they add up to the share's
};

/// A function; without profiles everything is one function without a name.
struct FunctionChange {
  std::string function, file;
  ChangeKind kind = ChangeKind::kWaits;
  Share share;
  double instructions_before = 0, instructions_after = 0;
  std::vector<CauseChange> causes;  ///< largest change first
  std::vector<LineChange> lines;    ///< largest change first; those without a change are left out
  double layout = 0;                ///< part of the change that comes from other addresses
};

/// What differs between two attributions. The idle clocks are kept apart: a loop that waits for a
/// camera becomes slower by waiting less. A sleep until the EDMA or the engine is done is busy (sleep.h).
struct Difference {
  RunPart part = RunPart::kWindow;
  bool known = true;        ///< both runs tell the clocks of the part
  bool by_function = false;
  bool in_seconds = false;  ///< the clocks of the two cores have other lengths
  bool per_remap = false;   ///< the parts have other numbers of remaps; amounts are those of one
  double remaps = 0;        ///< in the second run's window; 0: unknown
  double seconds = 0;       ///< length of the second core's clock; 0: unknown
  Share total, busy, idle;
  std::vector<FunctionChange> functions;  ///< busy clocks; largest change first
  std::vector<ClockOrigin> origins;       ///< of what comes from other code; largest change first
  std::string moved_objects;              ///< "frame_out moved by +4,096 bytes"
  std::vector<std::string> notes;         ///< of the circumstances
  double unexplained = 0;                 ///< of the change of `total`, not in any row
  bool program_differs = false, settings_differ = false;
  bool places_known = false;  ///< both runs tell where their code lies

  /// Share of the change that no row explains: 0 is all explained.
  double unexplained_share() const;
  bool none() const;
};

/// What is known of the circumstances, to tell moved code from code that waits.
struct Circumstances {
  bool program_differs = false;   ///< hashes of the programs differ
  bool settings_differ = false;   ///< values of parameters or other inputs differ
  std::vector<std::string> notes = {};  ///< "the I-cache is off"
};
/// Where one of the two runs does not tell its remaps apart, the window is compared instead.
Difference difference_of(const Attribution& before, const Attribution& after, const Circumstances& circumstances,
                         RunPart part = RunPart::kWindow);

/// The largest contribution in the direction of the whole change.
struct Blame {
  std::shared_ptr<const FunctionChange> function;  ///< null: there is none
  std::vector<FunctionKey> path, with;     ///< of an origin
  std::vector<std::pair<FunctionKey, double>> others;  ///< with it, 80 % of the whole change
  const CauseChange* cause = nullptr;  ///< of the function: largest row of the cause that contributes most
  double by_cause = 0;                 ///< of that cause, over all regions and culprits
  const LineChange* line = nullptr;    ///< of the function: where that cause grew most
};
/// @param slower what became worse: more busy clocks, or fewer
Blame blame_of(const Difference& difference, bool slower);

/// Clocks, or seconds, that a failed time is worse by, in the unit of the difference; empty for other figures.
std::optional<double> needed(const Difference& difference, const std::string& figure, double change);

/// One sentence: "remap_plain (remap_plain.c:42) executes more: +1,234 clocks (82 % of the change), of
/// which +900 clocks by dcache, mostly region lut, culprit vpbe". If no clocks changed that way, the
/// function that executes more is named; empty if there is none.
std::string blame_text(const Difference& difference, const Blame& blame);
/// "dcache, region lut, culprit vpbe"; `extent` stands before the region.
std::string cause_text(const CauseChange& cause, const std::string& extent = "");
/// A number of clocks, or seconds, with its sign.
std::string amount_text(const Difference& difference, double amount);
/// "function (file:line)"; for the attribution without functions "the program".
std::string place_text(const FunctionChange& function, const LineChange* line);

}  // namespace fovea::regression
