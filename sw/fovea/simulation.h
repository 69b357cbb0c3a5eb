// The seam between the host program and the board: what a run is asked for and what it answers.
#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "model/common/param.h"
#include "sw/fovea/outputs.h"
#include "sw/fovea/register_log.h"

namespace fovea::app {

/// How far a run is; all counts since the start of the run.
struct Progress {
  Picoseconds simulated = 0;
  std::uint64_t frames_shown = 0;   ///< corrected frames displayed
  std::uint64_t frames_wanted = 0;  ///< 0: unknown
  std::uint64_t instructions = 0;   ///< executed by the core
};

/// Takes progress; cheap enough to be called at every field (it decides when to print).
class ProgressSink {
 public:
  virtual ~ProgressSink() = default;
  virtual void update(const Progress& progress) = 0;
};

/// A displayed frame: 4:2:2, bytes Cb Y0 Cr Y1, no padding. Valid during the call only.
struct DisplayedFrame {
  std::uint64_t index = 0;
  unsigned width = 0, height = 0;
  std::span<const std::uint8_t> uyvy;
};

/// What `fovea run` asks of the board.
struct RunRequest {
  const ParamSet& params;
  /// Folder of the run (still DIR.tmp) for files that the board writes itself, such as traces.
  std::filesystem::path folder;
  bool strict_sync = false;  ///< --sync=strict
  /// Set by a signal: the board ends the run soon and returns what it has with complete = false.
  const std::atomic<bool>& stop;
  ProgressSink& progress;
  /// Called for each displayed frame, in order; empty with --no-frames. May throw UserError (disk
  /// full), which the board lets through.
  std::function<void(const DisplayedFrame&)> frame;
  /// Take rows as they become final, in order; the result has the rest of them. Empty: it has all.
  /// May throw UserError as `frame` may.
  std::function<void(const FrameRow&)> frame_row = {};
  std::function<void(std::span<const std::string> masters, const TimelineRow&)> timeline_row = {};
  std::filesystem::path bus_trace = {};  ///< file for the bus trace of the window; empty: none
  /// Waits for a debugger there before the core starts.
  std::optional<std::uint16_t> gdb_port = {};
  std::ostream* notes = nullptr;  ///< says where; not null with gdb_port
  RegisterLogRequest registers = {};
};

/// What the board answers.
struct RunResult {
  bool complete = true;        ///< false: stopped before the wanted frames were shown
  std::string guest_failure;   ///< not empty: the guest failed (exit 3); may have several lines
  std::vector<StatRow> stats;  ///< stats.json, in any order
  std::vector<StatRow> host;   ///< host.json, in any order (direct and queued accesses, ...)
  std::vector<FrameRow> frames;
  std::vector<std::string> timeline_masters;
  std::vector<TimelineRow> timeline;
  std::vector<StallRow> stalls;
  std::string uart;  ///< all that the firmware printed
  std::vector<std::string> notes;  ///< sentences for the person who looks, below the figures
  std::string registers;  ///< the log that was asked for
};

/// A board that can be run once.
class Simulation {
 public:
  virtual ~Simulation() = default;
  /// Adds all parameters of the board; called once, first.
  virtual void declare(ParamSet& params) = 0;
  /// Files that a run reads beside those that a parameter names, by the parameter that could.
  virtual std::vector<std::pair<std::string, std::filesystem::path>> input_files() const {
    return {};
  }
  /// Runs to the end. @throws UserError for input that only the board can judge (footage, program),
  ///   GuestFailure, NotModelled
  virtual RunResult run(const RunRequest& request) = 0;
};

/// The DM365 board; defined by the board library, not by this one.
std::unique_ptr<Simulation> make_simulation();

}  // namespace fovea::app
