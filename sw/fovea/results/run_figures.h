// What comparisons read of a folder of results: figures, parameters, program and hashes.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/results/subject.h"

namespace fovea::regression {

/// A figure of stats.json.
struct Metric {
  std::optional<double> value;  ///< empty: it has none (null), such as a mean of nothing
  std::string unit = {};
  bool whole = false;           ///< a count
};

/// A parameter of config.json.
struct Parameter {
  std::string value, default_value, tag;
  bool path = false;  ///< names a file: its place differs between hosts, its hash matters
};

/// One folder of results, or the reference that a baseline keeps of one.
struct RunFigures {
  std::filesystem::path folder;
  std::string version, commit;
  bool modified = false;  ///< the simulator's source differed from the commit
  Subject subject;        ///< of results that do not name it, with an empty name
  std::map<std::string, Metric> metrics;
  std::map<std::string, Parameter> parameters;
  std::map<std::string, std::string> hashes;  ///< SHA-256 of the inputs, by key
  std::vector<std::string> command;           ///< empty: unknown
  std::optional<double> host_instructions;    ///< of the simulator, for each one of the guest

  /// Version and commit of the simulator, as `fovea version` prints them.
  std::string simulator() const;
  /// True if the window is one of frames, which begins with the first corrected one; false: it begins at power-up.
  bool has_frames() const;
  /// SHA-256 of what ran, the program or the trace; empty: it is not known.
  std::string input_hash() const;
  /// The figure, or nullptr.
  const Metric* metric(const std::string& name) const;
  /// Value of a figure; 0 if it is missing or has none.
  double value(const std::string& name) const;
};

/// Reads the complete results in `folder`. @throws UserError as results::read_stored_run() does
RunFigures read_run(const std::filesystem::path& folder);

/// Nearest name of a figure by edit distance; empty if none is similar.
std::string nearest_metric(const RunFigures& run, const std::string& name);

/// A figure for people: exact for counts, with a prefix for seconds, bytes and watts.
std::string figure_text(const Metric& metric);
/// The shortest text that is read back as the same number.
std::string exact_text(double value, bool whole);

}  // namespace fovea::regression
