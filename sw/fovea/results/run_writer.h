// The files of a finished run, an `exec` or a replay.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "sw/fovea/results/outputs.h"
#include "sw/fovea/results/run_dir.h"

namespace fovea::app {

/// A file of a run's folder.
struct ResultFile {
  std::string name, text;
  bool shown = false;  ///< told to the user if there is no folder
};

/// What a run leaves when it is over.
struct FinishedRun {
  std::span<const StatRow> stats;  ///< in any order
  std::vector<StatRow> host;       ///< what was measured of the host
  bool complete = true;            ///< false: it was stopped or failed
  RunWords words = {};
  std::vector<Warning> warnings = {};
};

/// Writes `files`, then host.json and last stats.json: if that exists, all others do.
/// @param command as it was given @throws UserError
void write_run(RunDir& dir, const FinishedRun& run, std::span<const ResultFile> files,
               std::span<const std::string> command);

}  // namespace fovea::app
