// Options that several commands share.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/files/run_limits.h"
#include "sw/fovea/program/elf_image.h"

namespace CLI {
class App;
}

namespace fovea::app {

/// What `--across-versions` means for comparisons.
inline constexpr const char* kAcrossVersions =
    "Also take results of different simulators, and list what differs";

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

/// Adds `-s`, which takes one value each time, because the name of the experiment may follow it.
void add_set_option(CLI::App& command, std::vector<std::string>& sets);

}  // namespace fovea::app
