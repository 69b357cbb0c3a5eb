// What lies in a folder of results: which files are Fovea's, of which command, complete or not.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace fovea::app {

/// What config.json of a run folder has under "format".
inline constexpr std::string_view kRunFormat = "fovea run 1";

/// True for the name, relative to the folder, of a file that Fovea writes ("stats.json",
/// "frames/frame_000000.png"). RunDir writes no others.
bool is_run_file(std::string_view name);

/// An existing folder as a place for results.
struct RunFolder {
  bool exists = false;   ///< something of this name exists, of whatever kind
  bool ours = false;     ///< a folder with a config.json of Fovea's
  bool vacant = false;   ///< a folder without any file, apart from empty folders of Fovea's
  std::string foreign;   ///< a file in it, relative to it, that Fovea does not write; empty: none
  std::string command;   ///< "run", "replay", "exec"; empty: unknown
  std::string date;      ///< local date and time of its results; empty if there are none
  bool complete = false; ///< it has results, and nothing says that they are only partial

  /// "the results of 2026-11-22 18:01:59" or "the partial results of ...".
  std::string results() const;
};
RunFolder look_at_run_folder(const std::filesystem::path& dir);

/// True if `dir` holds a config.json written by Fovea.
bool is_run_folder(const std::filesystem::path& dir);

/// Removes the files that Fovea writes, and then the folder (its contents alone with
/// `keep_folder`) unless something foreign is left in it. Nothing else is ever removed. An error of
/// the file system is left unsaid: what cannot be removed stays.
/// @return false if anything is left
bool remove_run_files(const std::filesystem::path& dir, bool keep_folder = false);

}  // namespace fovea::app
