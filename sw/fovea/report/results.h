// The results of one run, read back from its folder.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sw/fovea/report/binds.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/results/stored_run.h"
#include "sw/fovea/tools/slowest.h"

namespace fovea::report {

using results::Parameter;

/// A bin of latency.csv: `count` requests took from `low_ns` to `high_ns`.
struct LatencyBin {
  std::string master, direction, beat;
  double low_ns = 0, high_ns = 0;
  std::uint64_t count = 0;
};

/// A row of profile.csv.
struct ProfileRow {
  std::string phase, function, file, line, cause, region, culprit;
  std::uint64_t clocks = 0, instructions = 0;
};

struct Timeline {
  std::vector<std::string> masters;
  std::vector<app::TimelineRow> rows;
};

/// A folder of results. A file that is not there leaves its member empty (std::nullopt).
struct Results {
  std::filesystem::path folder;
  std::string name;  ///< as a reader of the report knows it
  std::string command, version, commit, experiment, ended_by, kernel;
  std::string picture;  ///< as the firmware names it in uart.log; empty: not known
  bool modified = false, complete = true;
  std::vector<std::string> arguments;                       ///< of the command, from host.json
  std::vector<std::pair<std::string, std::string>> hashes;  ///< SHA-256 by key; empty: not known
  std::vector<Parameter> parameters;
  std::vector<app::StatRow> stats, host;  ///< only those that have a value
  std::vector<results::Warning> warnings;
  std::optional<std::vector<video::FrameTimes>> frames;
  std::optional<Timeline> timeline;
  std::optional<std::vector<app::StallRow>> stalls;
  std::optional<std::vector<LatencyBin>> latency;
  std::optional<std::vector<app::SlowestRow>> slowest;
  std::optional<std::vector<ProfileRow>> profile;
  std::optional<std::vector<std::pair<std::string, std::uint64_t>>> stacks;  ///< profile.folded
  std::vector<Relaxed> binds;  ///< of `fovea limits`, if it was asked for

  /// The value of a figure; empty if it has none.
  std::optional<double> value(std::string_view figure) const;
  const Parameter* parameter(std::string_view key) const;
};

struct LoadOptions {
  bool partial = false;          ///< accepts results that are marked as partial
  bool across_versions = false;  ///< accepts results of another version of Fovea
};

/// Reads a folder. @throws UserError of one line: another version, and what results::read_stored_run() and
/// results::each_csv_row() refuse
Results load_results(const std::filesystem::path& folder, const LoadOptions& options);

}  // namespace fovea::report
