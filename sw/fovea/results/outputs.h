// The text files of a run: config.json, stats.json, host.json, frames.csv, timeline.csv,
// stalls.csv.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/check.h"
#include "model/common/stats.h"
#include "model/video/core/frame.h"
#include "sw/fovea/config/experiment.h"
#include "sw/fovea/results/csv.h"
#include "sw/fovea/results/provenance.h"
#include "sw/fovea/results/stored_run.h"

namespace fovea::app {

/// One statistic as a file shows it.
struct StatRow {
  std::string name;
  StatBase::Value value;
  std::string unit;
  std::string description;
};

/// Appends the current values of a group.
void collect(const StatGroup& group, std::vector<StatRow>& rows);
/// The row called `name`, or nullptr.
const StatRow* find(std::span<const StatRow> rows, std::string_view name);

/// Bytes moved in [start, end), for each master in the order of the timeline's names.
struct TimelineRow {
  Picoseconds start = 0, end = 0;
  std::vector<std::uint64_t> read_bytes, write_bytes;
};

/// Clocks of one stall cause, region and culprit.
struct StallRow {
  std::string cause, region, culprit;
  std::uint64_t cycles = 0;
};

/// A bin of a histogram of SDRAM latencies that is not empty: `count` requests of a master took
/// low <= t < high to a beat.
struct LatencyRow {
  std::string master, direction, beat;  ///< read, write; first, last
  Picoseconds low = 0, high = 0;
  std::uint64_t count = 0;
};

/// The shortest text that is read back as the same double, always with '.' or an exponent; "null"
/// for infinities and NaN (a mean of nothing), which JSON does not have.
std::string number_text(double value);
std::string number_text(const StatBase::Value& value);

/// Picoseconds as nanoseconds with exactly three decimals, without rounding.
std::string ns_text(Picoseconds ps);

/// What produced the result, and every parameter: value, unit, where the value was given, origin of
/// its default.
std::string config_json(const ParamSet& params, const Experiment& experiment,
                        const Provenance& provenance);

using results::Warning;
std::vector<Warning> collect_warnings(const DiagnosticsRef& diagnostics, bool replay = false);

/// What a run says of itself in words; empty: nothing.
struct RunWords {
  std::string_view ended_by = {};  ///< the condition of run.until that was met
  std::string_view kernel = {};    ///< the remap kernels that ran
};

/// Sorted by name, one value per line, so that equal runs give equal bytes. `complete` is false for
/// a run that was stopped early. A name that occurs twice is a defect of Fovea (FOVEA_CHECK).
std::string stats_json(std::vector<StatRow> rows, bool complete,
                       const std::vector<Warning>& warnings = {}, const RunWords& words = {});
/// Like stats.json but without the state of the run; for values that differ from run to run.
std::string host_json(std::vector<StatRow> rows, std::span<const std::string> command,
                      std::string_view version);

using results::csv_field;

/// The header and one line of frames.csv and timeline.csv, for files that are written during the
/// run.
std::string frames_csv_header();
std::string frames_csv_line(const video::FrameTimes& row);
std::string timeline_csv_header(std::span<const std::string> masters);
std::string timeline_csv_line(const TimelineRow& row, std::size_t masters);

std::string frames_csv(std::span<const video::FrameTimes> rows);
/// `masters` names the elements of each row's vectors; columns are bytes per interval.
std::string timeline_csv(std::span<const std::string> masters, std::span<const TimelineRow> rows);

std::string stalls_csv(std::span<const StallRow> rows);
std::string latency_csv(std::span<const LatencyRow> rows);

/// A count with commas between groups of three digits.
std::string grouped(std::uint64_t value);

/// A value for people: three to five digits and a suitable prefix ("40.2 ms", "165.9 MB").
std::string human_text(const StatBase::Value& value, std::string_view unit);
/// Whether the firmware kept up with the camera, as one line with its end; empty if no corrected
/// frame was displayed.
std::string verdict(std::span<const StatRow> stats);

}  // namespace fovea::app
