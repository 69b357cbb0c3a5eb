// Options that `fovea run` and `fovea exec` share: limits of a run, and an additional symbol file.
#pragma once
#include <optional>
#include <string>

#include "sw/fovea/elf_image.h"
#include "sw/fovea/simulation.h"

namespace CLI {
class App;
}

namespace fovea::app {

struct LimitOptions {
  std::string max_time;
  std::optional<std::uint64_t> max_instructions;
  std::string symbols;
};

/// Options of `--perfetto`; what was given, checked.
struct PerfettoOptions {
  PerfettoRequest request;
  std::string file, duration;
};
void add_perfetto_options(CLI::App& command, PerfettoOptions& options);
/// @throws UserError that names the option
PerfettoRequest perfetto_of(const PerfettoOptions& options);

void add_limit_options(CLI::App& command, LimitOptions& options);
/// @throws UserError that names the option
RunLimits limits_of(const LimitOptions& options);
/// The file of --symbols, if that was given. @throws UserError
std::optional<ElfImage> symbols_of(const LimitOptions& options);

}  // namespace fovea::app
