// A baseline: what a run's figures should be, and how far they may lie from it.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/compare/tolerance.h"
#include "sw/fovea/files/output_folder.h"
#include "sw/fovea/results/run_figures.h"

namespace fovea::regression {

/// Which deviation is worse, and so fails.
enum class Worse { kHigher, kLower, kBoth };
/// Where an expected value comes from.
enum class Kind {
  kExact,     ///< a run: `fovea bless` replaces it
  kAnalytic,  ///< a formula or a standard: never replaced
  kBudget,    ///< a limit that a user set: never replaced
};
std::string_view kind_name(Kind kind);

struct Expectation {
  std::string name;
  std::optional<double> value;  ///< empty (`null`): the run's figure must have no value
  std::string unit;
  Tolerance tolerance;
  Worse worse = Worse::kBoth;
  Kind kind = Kind::kExact;
  std::string reason;
  std::size_t value_at = 0;  ///< of the value's text in the file
  int line = 0;              ///< in the file, from 1 on
};

struct Baseline {
  std::filesystem::path file;
  std::string text;  ///< of the whole file; empty: it is no file, but another run
  Subject subject;   ///< what a run must be of
  std::string version, commit;
  std::size_t version_at = 0, commit_at = 0;  ///< of these texts in the file
  std::map<std::string, std::string> settings;  ///< parameters that a run must have
  std::filesystem::path reference;            ///< folder of the reference; empty: none
  std::string reference_sha256;               ///< of its files; empty: not known, as in one written by hand
  std::size_t reference_sha256_at = 0;        ///< of this text in the file
  /// Where a line with it can be put in: at the end of this line of the file, behind so many blanks.
  std::size_t reference_line_at = 0, reference_indent = 0;
  std::vector<Expectation> metrics;           ///< in the order of the file
  /// How the file writes its history: a list of lines, `[]`, or none.
  struct History {
    bool there = false, brackets = false;  ///< brackets: with entries in them
    std::size_t indent = 2;                ///< of its lines
    std::size_t at = 0, size = 0;          ///< of `[]` or `null` in the file
    int line = 0;
  } history;
};

inline constexpr std::string_view kBaselineFormat = "fovea baseline 1";

/// @throws UserError with file and line: not YAML, an unknown key, a value that is not allowed
Baseline read_baseline(const std::filesystem::path& file);
/// The same from a text that may become the contents of `file`.
Baseline parse_baseline(const std::filesystem::path& file, std::string text);

/// A text as a YAML scalar in double quotes; as one with quotes only where it needs them.
std::string yaml_text(const std::string& text);
std::string yaml_scalar(const std::string& text);

/// The simulator's commit for a baseline; that of a modified source ends in "-modified".
std::string commit_text(const RunFigures& run);

/// The text of a baseline with another hash of its reference.
std::string with_reference_hash(const Baseline& baseline, const std::string& hash);

/// Files that a baseline keeps of the run it was taken from: where the clocks went, parameters and
/// figures. Names of files of the host are left out. The result maps names to texts.
std::map<std::string, std::string> reference_files(const RunFigures& run);
/// The folder that holds them.
extern const app::FolderKind kReferenceKind;

/// The hash of such files, of names and contents; empty for none.
std::string reference_hash(const std::map<std::string, std::string>& files);
/// That of the files in a folder; empty if there are none, or it is no folder. @throws UserError
std::string reference_hash(const std::filesystem::path& folder);

/// Where the reference of a baseline is. A `fovea bless` that was killed may have left it beside its place, and in its
/// place that of the baseline which it did not write any more. @throws UserError: it is not there, or is another one
std::filesystem::path reference_folder(const Baseline& baseline);
/// Reads it. @throws UserError
RunFigures read_reference(const Baseline& baseline);

}  // namespace fovea::regression
