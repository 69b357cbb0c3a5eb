// The contents of a folder of results: which files are Fovea's, of which command, whether complete.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "sw/fovea/files/output_folder.h"
#include "sw/fovea/results/stored_run.h"

namespace fovea::app {

using results::kRunFormat;

/// True for names, relative to the folder, of files that Fovea writes ("stats.json",
/// "frames/frame_000000.png"). RunDir writes no other files.
bool is_run_file(std::string_view name);

/// What a folder of results holds.
extern const FolderKind kRunKind;

/// An existing folder that may receive results.
struct RunFolder : FolderContents {
  bool ours = false;     ///< a folder with a config.json written by Fovea
  std::string command;   ///< "run", "replay", "exec"; empty: unknown
  std::string date;      ///< local date and time of its results; empty if it has none
  bool complete = false; ///< it has results, and they are not marked as partial

  /// "the results of 2026-11-22 18:01:59" or "the partial results of ...".
  std::string results() const;
};
RunFolder inspect_run_folder(const std::filesystem::path& dir);

/// True if `dir` contains a config.json written by Fovea.
bool is_run_folder(const std::filesystem::path& dir);

}  // namespace fovea::app
