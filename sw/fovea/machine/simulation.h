// The interface between the host program and the board: the request of a run and its result.
#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/common/param.h"
#include "sw/fovea/console/console.h"
#include "sw/fovea/console/semihosting.h"
#include "sw/fovea/files/run_limits.h"
#include "sw/fovea/files/side_output.h"
#include "sw/fovea/machine/frame_sink.h"
#include "sw/fovea/machine/perfetto_request.h"
#include "sw/fovea/program/elf_image.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/tools/profile_report.h"
#include "sw/fovea/tools/register_log.h"
#include "sw/fovea/tools/slowest.h"

namespace fovea::app {

/// A program that is run by `fovea exec --board` instead of the camera's firmware.
struct HostedProgram {
  std::filesystem::path root;          ///< folder of its files; empty: no files
  std::vector<std::string> arguments;  ///< argv[1] and the following ones
};

/// The request of `fovea run`.
struct RunRequest {
  const ParamSet& params;
  /// Folder of the run (still DIR.tmp), for files that the board writes itself, such as traces.
  std::filesystem::path folder;
  bool strict_sync = false;  ///< --sync=strict
  bool profile = false;      ///< --profile: attribute the core's clocks to the program
  bool hazards = false;      ///< --hazards: check the coherency of core and DMA
  /// Set by a signal: the board ends the run soon and returns a result with complete = false.
  const std::atomic<bool>& stop;
  ProgressSink& progress;
  std::vector<FrameSink*> frames = {};  ///< each gets every frame
  /// Called with rows when they become final, in order; the result contains the others. If empty,
  /// the result contains all rows. May throw UserError.
  std::function<void(std::span<const std::string> masters, const TimelineRow&)> timeline_row = {};
  PerfettoRequest perfetto = {};
  std::filesystem::path command_trace = {};  ///< file for the SDRAM's commands in the window; empty: none
  std::optional<Picoseconds> around = {};    ///< --around: list the SDRAM requests near this time; empty: do not
  std::filesystem::path bus_trace = {};  ///< file for the bus trace of the window; empty: none
  /// Port on which to wait for a debugger before the core starts.
  std::optional<std::uint16_t> gdb_port = {};
  std::ostream* notes = nullptr;  ///< receives the message with the port; not null if gdb_port is
                                  ///< set
  RegisterLogRequest registers = {};
  RunLimits limits = {};
  const ElfImage* symbols = nullptr;  ///< from --symbols; null: none
  ConsoleStream* console = nullptr;   ///< shows the output of UART0 and provides its input; null:
                                      ///< neither
  /// For the program's semihosting calls, which are enabled if run.until contains `exit`.
  SemihostingConsole* semihosting = nullptr;
  std::optional<HostedProgram> hosted = {};
};

/// The result of a run.
struct RunResult {
  bool complete = true;        ///< false: stopped before all requested frames were displayed
  std::string guest_failure;   ///< not empty: the guest failed (exit 3); may have several lines
  std::string difference;      ///< not empty: two models of a block that ran side by side differ (exit 1)
  std::vector<StatRow> stats;  ///< for stats.json, in any order
  std::vector<StatRow> host;   ///< for host.json, in any order
  std::vector<std::string> timeline_masters;
  std::vector<TimelineRow> timeline;
  std::vector<StallRow> stalls;
  std::vector<LatencyRow> latency;
  std::vector<SlowestRow> slowest;
  std::string around;  ///< for requests.csv; empty: not asked for
  std::string uart;  ///< everything that the firmware printed
  std::vector<std::string> notes;  ///< sentences for the user, shown below the figures
  std::string ended_by;      ///< the condition of run.until that was met; empty: none
  std::string kernel;        ///< the remap kernels that the camera's firmware says it runs; empty: it said nothing
  std::string ended;         ///< a sentence about that for the user
  std::optional<int> exit_code = {};  ///< the program's own, if it ended by a semihosting call
  std::string typed;         ///< what a person typed on the console, as a file for uart0.input
  std::string untyped;       ///< the step of uart0.input that was not reached; empty: all were
  std::string registers;  ///< the register log, if requested
  ProfileResult profile;  ///< with --profile
  LostOutputs lost = {};  ///< of what was asked for beside the results
  std::string hazards;    ///< a sentence about the coherency hazards that were found; empty: none
};

/// Two models of a block that ran side by side differ. Exit status 1, as of a check that failed.
struct ModelsDiffer : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A board that can run once.
class Simulation {
 public:
  virtual ~Simulation() = default;
  /// Adds all parameters of the board; called once, before the other functions.
  virtual void declare(ParamSet& params) = 0;
  /// The same for a program that the caller brings: what is known of the camera's firmware does not hold.
  virtual void declare_for_program(ParamSet& params) { declare(params); }
  /// Files that a run reads by default, with the parameter that could name another one.
  virtual std::vector<std::pair<std::string, std::filesystem::path>> input_files() const {
    return {};
  }
  /// Runs to the end. @throws UserError for input that only the board can check (footage, program),
  /// GuestFailure, NotModelled
  virtual RunResult run(const RunRequest& request) = 0;
};

/// The DM365 board; defined in the board's library.
std::unique_ptr<Simulation> make_simulation();

}  // namespace fovea::app
