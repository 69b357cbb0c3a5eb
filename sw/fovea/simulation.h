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
#include "sw/fovea/console.h"
#include "sw/fovea/elf_image.h"
#include "sw/fovea/outputs.h"
#include "sw/fovea/register_log.h"
#include "sw/fovea/run_limits.h"
#include "sw/fovea/semihosting.h"

namespace fovea::app {

/// A displayed frame: 4:2:2, bytes Cb Y0 Cr Y1, no padding. Valid during the call only.
struct DisplayedFrame {
  std::uint64_t index = 0;
  unsigned width = 0, height = 0;
  std::span<const std::uint8_t> uyvy;
};

/// A program that is run for its own sake (`fovea exec --board`), not as a camera's firmware.
struct HostedProgram {
  std::filesystem::path root;          ///< folder of its files; empty: none
  std::vector<std::string> arguments;  ///< argv[1] and on
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
  RunLimits limits = {};
  const ElfImage* symbols = nullptr;  ///< of --symbols; null: none
  ConsoleStream* console = nullptr;   ///< shows UART0 and has what is typed; null: neither
  /// For the program's semihosting calls, which are served if run.until has `exit`.
  SemihostingConsole* semihosting = nullptr;
  std::optional<HostedProgram> hosted = {};
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
  std::string ended_by;      ///< the condition of run.until that was met; empty: none was
  std::string ended;         ///< a sentence about that, for people
  std::optional<int> exit_code = {};  ///< the program's own, if it ended by semihosting
  std::string typed;         ///< what a person typed on the console, as a file for uart0.input
  std::string untyped;       ///< the step of uart0.input that was not reached; empty: all were
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
