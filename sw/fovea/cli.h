// The command line of `fovea`.
#pragma once
#include <atomic>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "sw/fovea/executor.h"
#include "sw/fovea/simulation.h"

namespace fovea::app {

/// Exit statuses. A run that was stopped by SIGINT or SIGTERM leaves a valid partial result
/// (`"complete": false`) and exits with 128 + the signal's number, like shells: 130 or 143.
enum ExitStatus : int {
  kExitDone = 0,
  kExitCheckFailed = 1,
  kExitWrongInput = 2,
  kExitGuestFailed = 3,
  kExitOwnDefect = 4,
};

/// The surroundings of the program, which tests replace.
struct CliContext {
  std::ostream& out;
  std::ostream& err;
  bool terminal = false;  ///< true if err is a terminal
  std::function<std::unique_ptr<Simulation>()> make_simulation;
  std::function<std::unique_ptr<Executor>()> make_executor = nullptr;
  const std::atomic<int>* signal = nullptr;  ///< the signal that requested a stop; 0: none
  const std::atomic<bool>* stop = nullptr;   ///< set together with `signal`
};

/// Runs one command and reports every error. `args` does not contain the program's name. @return
/// the exit status
int run_cli(const std::vector<std::string>& args, const CliContext& context);

/// Installs signal handlers: SIGINT and SIGTERM set the flags (a second one ends the program at
/// once); SIGPIPE and SIGXFSZ are ignored, so that they become write errors.
void install_signals(CliContext& context);

/// Prints a sentence about what a command did of its own accord; nothing if it is empty.
void say_note(const std::string& note, const CliContext& context);
/// Says what is missing beside the results.
void say_lost(const LostOutputs& lost, const CliContext& context);

std::string version_text();

}  // namespace fovea::app
