// What every command of `fovea` is given, and the statuses with which it ends.
#pragma once
#include <atomic>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>

#include "sw/fovea/machine/machine.h"

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
  MakeMachine make_machine = nullptr;
  std::vector<ToolRow> tools = {};  ///< of the machines; outlives the command
  const std::atomic<int>* signal = nullptr;  ///< the signal that requested a stop; 0: none
  const std::atomic<bool>* stop = nullptr;   ///< set together with `signal`
};

/// Prints a sentence about what a command did of its own accord; nothing if it is empty.
void say_note(const std::string& note, const CliContext& context);
/// Says what is missing beside the results.
void say_lost(const LostOutputs& lost, const CliContext& context);

/// Version and commit of this program, as `--version` and host.json have them.
std::string version_text();

}  // namespace fovea::app
