// The seam between `fovea exec` and the machines that run a foreign program.
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
#include "sw/fovea/exec_program.h"
#include "sw/fovea/outputs.h"
#include "sw/fovea/register_log.h"
#include "sw/fovea/run_limits.h"
#include "sw/fovea/semihosting.h"

namespace fovea::app {

struct ExecRequest {
  const ExecProgram& program;
  std::vector<std::string> arguments;  ///< argv[1] and on
  std::filesystem::path root;          ///< folder of the program's files; empty: none
  const ParamSet& params;
  std::optional<std::uint16_t> gdb_port;  ///< waits for a debugger there before it starts
  std::ostream& notes;                 ///< for whoever watches
  bool caches = false;                 ///< MMU and caches are on when the program begins
  bool fast_memory = false;            ///< flat memory without wait states; no bus, no SDRAM
  SemihostingConsole& console;
  const std::atomic<bool>& stop;       ///< set by a signal
  RegisterLogRequest registers = {};
  RunLimits limits = {};
  const ElfImage* symbols = nullptr;  ///< of --symbols; null: none
  ProgressSink* progress = nullptr;   ///< null: nobody looks
};

struct ExecResult {
  bool complete = false;      ///< the program ended by itself
  bool killed = false;        ///< by the debugger
  bool left = false;          ///< a person left the console
  int exit_code = 0;          ///< its own
  Frequency core_clock;
  std::string guest_failure;  ///< not empty: the guest failed (exit 3); may have several lines
  std::vector<StatRow> stats, host;
  std::vector<StallRow> stalls;
  std::string registers;  ///< the log that was asked for
  std::string ended;      ///< with --board: a sentence about what ended the run; may be empty
};

/// A machine that runs one program.
class Executor {
 public:
  virtual ~Executor() = default;
  /// Adds all parameters; called once, first.
  virtual void declare(ParamSet& params) = 0;
  /// Bytes of the machine's memory, by the parameters.
  virtual std::uint64_t memory_bytes() const = 0;
  virtual ExecResult run(const ExecRequest& request) = 0;
};

/// Defined beside make_simulation().
std::unique_ptr<Executor> make_executor();

}  // namespace fovea::app
