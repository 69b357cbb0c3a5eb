// Options that `fovea run` and `fovea exec` share: limits of a run, and an additional symbol file.
#pragma once
#include <optional>
#include <string>

#include "sw/fovea/machine/simulation.h"
#include "sw/fovea/program/elf_image.h"

namespace CLI {
class App;
}

namespace fovea::app {

struct LimitOptions {
  std::string max_time;
  std::optional<std::uint64_t> max_instructions;
  std::string symbols;
};

void add_limit_options(CLI::App& command, LimitOptions& options);
/// @throws UserError that names the option
RunLimits limits_of(const LimitOptions& options);
/// The file of --symbols, if that was given. @throws UserError
std::optional<ElfImage> symbols_of(const LimitOptions& options);

}  // namespace fovea::app
