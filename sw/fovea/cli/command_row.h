// A command of `fovea`: its row in commands.cpp, and what it is called with.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sw/fovea/machine/command.h"
#include "sw/fovea/tools/tool.h"

namespace CLI {
class App;
}

namespace fovea::app {

/// A command line that has been read.
struct Call {
  const CLI::App& app;                   ///< the program, with all commands
  const std::vector<std::string>& args;  ///< as they were given, for host.json
  const CliContext& context;
};

/// A key after -s, and the words that it allows with blanks between them; "": it is no choice of words.
struct OfferedKey {
  std::string key, words;
};

/// What a command adds to the command line.
struct Command {
  CLI::App* options = nullptr;  ///< its name, its options, its help
  /// Runs it after its options were read. @return the exit status @throws UserError, GuestFailure, NotModelled
  std::function<int(const Call&)> run;
  /// The keys that its `-s` takes; empty: it has no `-s` that could be completed.
  std::function<std::vector<OfferedKey>(const CliContext&)> keys = {};
  /// Adds the options of these tools to its own; empty: it has none.
  std::function<void(std::span<const ToolRow>)> add_tools = {};
  /// Removes from the arguments, of which the first is the command's name, what is not for Fovea; empty: all is.
  std::function<void(std::vector<std::string>&)> take_foreign = {};
};

/// All commands, in the order of the help. Each adds itself to `app`.
std::vector<Command> add_commands(CLI::App& app);

/// The keys of `fovea run`.
std::vector<OfferedKey> keys_of_run(const CliContext& context);
std::vector<OfferedKey> keys_of(const ParamSet& params);

}  // namespace fovea::app
