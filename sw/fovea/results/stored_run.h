// A folder of results, read back: what config.json, stats.json and host.json say. The one reader of these files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/common/stats.h"

namespace fovea::results {

/// The value of "format" in config.json.
inline constexpr std::string_view kRunFormat = "fovea run 1";

/// A statistic.
struct Figure {
  std::string name;
  std::optional<StatBase::Value> value;  ///< empty: it has none (null), such as a mean of nothing
  std::string unit, description;
  bool whole = false;  ///< written without a fraction; one below zero is a double nevertheless
};

/// A parameter as config.json lists it.
struct Parameter {
  std::string key, value, origin, initial, tag, source, belief, description;
  bool changed() const { return origin != "default"; }
};

/// A warning as stats.json lists it.
struct Warning {
  std::string kind, what;
  std::uint64_t count = 0;
};

struct StoredRun {
  std::filesystem::path folder;
  // config.json
  std::string version, commit, experiment;
  std::string command, input;  ///< of `exec` and `replay`, and their file; empty: not named
  bool modified = false;       ///< the simulator's source differed from the commit
  std::vector<std::string> arguments, options;              ///< of a program; words that decide the result
  std::vector<std::pair<std::string, std::string>> hashes;  ///< SHA-256 of inputs by key; empty: not known
  std::vector<Parameter> parameters;
  // stats.json
  bool complete = true;
  std::string ended_by, kernel;
  std::vector<Figure> figures;
  std::vector<Warning> warnings;
  // host.json, if it is there
  std::vector<std::string> command_line;  ///< without the program's name
  std::vector<Figure> host;
};

/// Reads a folder that `fovea run`, `exec` or `replay` wrote. What it does not know in a file counts for nothing; what
/// it does know must be there and be what it was written as. @param partial takes partial results too
/// @param remedy what a message about partial results says is allowed
/// @throws UserError of one line: not such a folder, another format, no or partial results, a damaged file
StoredRun read_stored_run(const std::filesystem::path& folder, bool partial = false,
                          std::string_view remedy = "complete results");
/// The figures of a stats.json alone. @throws UserError
std::vector<Figure> read_figures(const std::filesystem::path& stats_json);

}  // namespace fovea::results
