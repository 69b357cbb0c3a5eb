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

/// Exit statuses. A run that SIGINT or SIGTERM stopped leaves a valid partial result
/// (`"complete": false`) and exits with 128 + the signal's number, as shells have it: 130, 143.
enum ExitStatus : int {
  kExitDone = 0,
  kExitCheckFailed = 1,
  kExitWrongInput = 2,
  kExitGuestFailed = 3,
  kExitOwnDefect = 4,
};

/// Surroundings of the program, so that tests can stand in for them.
struct CliContext {
  std::ostream& out;
  std::ostream& err;
  bool terminal = false;  ///< err is a terminal
  std::function<std::unique_ptr<Simulation>()> make_simulation;
  std::function<std::unique_ptr<Executor>()> make_executor = nullptr;
  const std::atomic<int>* signal = nullptr;  ///< the signal that asked to stop; 0: none
  const std::atomic<bool>* stop = nullptr;   ///< set together with it
};

/// Runs one command. `args` is without the program's name. Every error is reported here.
int run_cli(const std::vector<std::string>& args, const CliContext& context);

/// The table of `fovea params`. `pattern`: part of a key, or with `*` and `?` all of it; empty:
/// all.
/// @throws UserError if no key matches
std::string params_table(const ParamSet& params, const std::string& pattern, bool markdown);

/// SIGINT and SIGTERM set the flags (a second one ends the program at once); SIGPIPE and SIGXFSZ
/// become errors of the write.
void install_signals(CliContext& context);

/// Prints what RunDir::commit() says about results that the folder held before.
void report_earlier(const std::string& note, const CliContext& context);

std::string version_text();

}  // namespace fovea::app
