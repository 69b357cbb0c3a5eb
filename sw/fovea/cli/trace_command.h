// `fovea trace convert` and `fovea trace info`: bus traces between formats.
#pragma once
#include <optional>
#include <string>

#include "sw/fovea/machine/command.h"

namespace CLI {
class App;
}

namespace fovea::app {

struct TraceOptions {
  std::string in, out;
  std::string from, to;  ///< formats; `from` empty: by the file's content
  std::string clock;     ///< frequency or period of the cycles
  std::optional<std::string> master;
  std::optional<unsigned> bytes, window;
  std::optional<std::string> size;
  bool wrap = false;
};

void add_trace_command(CLI::App& app, TraceOptions& options);
/// Runs the sub-command that was parsed. @throws UserError
int command_trace(const CLI::App& trace, const TraceOptions& options, const CliContext& context);

}  // namespace fovea::app
