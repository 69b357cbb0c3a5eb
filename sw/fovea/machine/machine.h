// A machine that runs a program: what it is asked for, and what it answers.
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
#include <utility>
#include <vector>

#include "model/common/param.h"
#include "sw/fovea/console/console.h"
#include "sw/fovea/console/semihosting.h"
#include "sw/fovea/files/run_limits.h"
#include "sw/fovea/files/side_output.h"
#include "sw/fovea/program/elf_image.h"
#include "sw/fovea/program/exec_program.h"
#include "sw/fovea/results/frame_sink.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/tools/slowest.h"
#include "sw/fovea/tools/tool.h"

namespace fovea::app {

/// A program that the user brings, instead of the camera's firmware.
struct UserProgram {
  const ExecProgram& image;
  std::filesystem::path root = {};           ///< folder of its files; empty: no files
  std::vector<std::string> arguments = {};   ///< argv[1] and the following ones
  bool caches = false;                       ///< MMU and caches are enabled when it begins; not on the board
};

struct Request {
  const ParamSet& params;
  /// Set by a signal: the machine ends the run soon and returns a result with complete = false.
  const std::atomic<bool>& stop;
  ProgressSink& progress;
  bool strict_sync = false;            ///< --sync=strict
  std::vector<AskedTool> tools = {};   ///< no more than the machine provides (tools_of)
  std::vector<FrameSink*> frames = {};  ///< each gets every frame; only a board has any
  /// Called with rows when they become final, in order; the result contains the others. If empty,
  /// the result contains all rows. May throw UserError.
  std::function<void(std::span<const std::string> masters, const TimelineRow&)> timeline_row = {};
  /// Port on which to wait for a debugger before the core starts.
  std::optional<std::uint16_t> gdb_port = {};
  std::ostream* notes = nullptr;  ///< receives the message with the port; not null if gdb_port is
                                  ///< set
  RunLimits limits = {};
  const ElfImage* symbols = nullptr;  ///< from --symbols; null: none
  ConsoleStream* console = nullptr;   ///< shows the output of UART0 and provides its input; null:
                                      ///< neither
  /// For the program's semihosting calls. On the board they are enabled if run.until contains `exit`.
  SemihostingConsole* semihosting = nullptr;
  std::optional<UserProgram> program = {};
};

/// What a run leaves; the members of ToolOutput hold what the tools add to it.
struct Result : ToolOutput {
  bool complete = true;       ///< false: stopped before its end
  bool killed = false;        ///< the debugger ended it
  std::string guest_failure;  ///< not empty: the guest failed (exit 3); may have several lines
  std::string difference;     ///< not empty: two models of a block that ran side by side differ (exit 1)
  std::optional<int> exit_code = {};  ///< the program's own, if it ended by a semihosting call
  std::string ended_by;               ///< the condition of run.until that was met; empty: none
  std::string ended;                  ///< a sentence about that for the user
  std::string kernel;  ///< the remap kernels that the camera's firmware says it runs; empty: it said nothing
  Frequency core_clock;               ///< of a machine without a board
  std::vector<StatRow> host;          ///< for host.json, in any order
  std::vector<std::string> timeline_masters;
  std::vector<TimelineRow> timeline;
  std::vector<StallRow> stalls;
  std::vector<LatencyRow> latency;
  std::vector<SlowestRow> slowest;
  std::string uart;     ///< everything that the program printed there
  std::string typed;    ///< what a person typed on the console, as a file for uart0.input
  std::string untyped;  ///< the step of uart0.input that was not reached; empty: all were
  LostOutputs lost = {};  ///< of what was asked for beside the results
};

/// Two models of a block that ran side by side differ. Exit status 1, as of a check that failed.
struct ModelsDiffer : std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class MachineKind : std::uint8_t {
  kBoard,         ///< the DM365 board with the camera's firmware
  kProgramBoard,  ///< the same for a program that the user brings
  kCore,          ///< core, crossbar and SDRAM, for such a program
  kFlat           ///< the core with memory without wait states
};

/// What a machine of that kind provides.
constexpr ToolNeeds tools_of(MachineKind kind) {
  switch (kind) {
    case MachineKind::kBoard:
    case MachineKind::kProgramBoard: return ToolNeeds::kBoard;
    case MachineKind::kCore: return ToolNeeds::kRegisters;
    case MachineKind::kFlat: break;
  }
  return ToolNeeds::kCore;
}

/// A machine that can run once.
class Machine {
 public:
  virtual ~Machine() = default;
  /// Adds all parameters; called once, before the other functions.
  virtual void declare(ParamSet& params) = 0;
  /// Files that a run reads by default, with the parameter that could name another one.
  virtual std::vector<std::pair<std::string, std::filesystem::path>> input_files() const {
    return {};
  }
  /// Runs to the end. @throws UserError for input that only the machine can check (footage, program),
  /// GuestFailure, NotModelled
  virtual Result run(const Request& request) = 0;
};

using MakeMachine = std::function<std::unique_ptr<Machine>(MachineKind)>;

/// Defined in the library of the machines.
std::unique_ptr<Machine> make_machine(MachineKind kind);

}  // namespace fovea::app
