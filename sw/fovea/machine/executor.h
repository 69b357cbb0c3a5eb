// The interface between `fovea exec` and the machines that run a program.
#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "model/common/param.h"
#include "sw/fovea/console/semihosting.h"
#include "sw/fovea/files/run_limits.h"
#include "sw/fovea/files/side_output.h"
#include "sw/fovea/program/exec_program.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/tools/profile_report.h"
#include "sw/fovea/tools/register_log.h"

namespace fovea::app {

struct ExecRequest {
  const ExecProgram& program;
  std::vector<std::string> arguments;  ///< argv[1] and the following ones
  std::filesystem::path root;          ///< folder of the program's files; empty: no files
  const ParamSet& params;
  std::optional<std::uint16_t> gdb_port;  ///< port on which to wait for a debugger before the start
  std::ostream& notes;                 ///< messages for the user
  bool caches = false;                 ///< MMU and caches are enabled when the program begins
  bool profile = false;                ///< attribute the core's clocks to the program
  bool fast_memory = false;            ///< memory without wait states; no bus, no SDRAM
  SemihostingConsole& console;
  const std::atomic<bool>& stop;       ///< set by a signal
  RegisterLogRequest registers = {};
  RunLimits limits = {};
  const ElfImage* symbols = nullptr;  ///< from --symbols; null: none
  ProgressSink* progress = nullptr;   ///< null: progress is not reported
};

struct ExecResult {
  bool complete = false;      ///< the program ended by itself
  bool killed = false;        ///< the debugger ended it
  bool left = false;          ///< the user left the console
  int exit_code = 0;          ///< the program's own
  Frequency core_clock;
  std::string guest_failure;  ///< not empty: the guest failed (exit 3); may have several lines
  std::string difference;     ///< with --board: two models of a block differ (exit 1); empty: none do
  std::vector<StatRow> stats, host;
  std::vector<StallRow> stalls;
  std::string registers;  ///< the register log, if requested
  ProfileResult profile;  ///< if requested
  LostOutputs lost = {};  ///< of what was asked for beside the results
  std::string hazards;    ///< with --hazards: a sentence about those found; empty: none
  std::string ended;      ///< with --board: a sentence about what ended the run; may be empty
};

/// A machine that runs one program.
class Executor {
 public:
  virtual ~Executor() = default;
  /// Adds all parameters; called once, before the other functions.
  virtual void declare(ParamSet& params) = 0;
  /// Size of the machine's memory in bytes, according to the parameters.
  virtual std::uint64_t memory_bytes() const = 0;
  virtual ExecResult run(const ExecRequest& request) = 0;
};

/// Defined together with make_simulation().
std::unique_ptr<Executor> make_executor();

}  // namespace fovea::app
