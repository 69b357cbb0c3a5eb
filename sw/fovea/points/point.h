// A point: one run or replay with its settings, and what came out of it.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fovea::points {

/// What the program is asked to do for a point: `fovea COMMAND INPUT OPTIONS -s SETTING... -o DIR`.
struct Point {
  std::string command = "run";  ///< "run" or "replay"
  std::string input;            ///< experiment file, or trace
  std::vector<std::string> settings;  ///< key=value; a later one wins
  /// Further arguments; kFolder in them stands for the point's own folder.
  std::vector<std::string> options;
  /// The effective configuration: everything that decides the result, in a form that does not
  /// depend on how it was written down.
  std::string identity;
  std::string label;  ///< how progress lines and tables call it
};

inline constexpr std::string_view kFolder = "{folder}";

/// SHA-256 of command, options and identity, in hexadecimal digits: equal for points that must have
/// equal results.
std::string key_of(const Point& point);
/// What a point's folder is called: the first 16 digits of its key.
std::string folder_name(std::string_view key);

/// The result of a point. A failed one has a status other than 0 and its message.
struct PointResult {
  std::string key;
  int status = 0;       ///< exit status of the program
  std::string message;  ///< its error, on one line; empty if there was none
  std::filesystem::path folder;  ///< run/ holds the files of the run, messages.txt its error stream
  double wall_seconds = 0;       ///< host time
  bool reused = false;           ///< an earlier call has run it
  std::map<std::string, double, std::less<>> stats;  ///< the figures that have a number
  std::map<std::string, std::string, std::less<>> units;  ///< of all figures

  std::optional<double> stat(std::string_view name) const {
    const auto found = stats.find(name);
    return found == stats.end() ? std::nullopt : std::optional(found->second);
  }
};

/// Reads the figures of `folder`/run/stats.json into the result; none if there is no such file.
/// @throws UserError for a file that is not what Fovea writes
void read_stats(PointResult& result);

/// The line of the program's error stream that says why it ended; empty if it says nothing.
std::string reason_in(std::string_view messages);

}  // namespace fovea::points
