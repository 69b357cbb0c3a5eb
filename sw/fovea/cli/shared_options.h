// Options that several commands share.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/machine/simulation.h"
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
/// Adds `--around`.
void add_around_option(CLI::App& command, std::string& time);
/// Adds `--command-trace`.
void add_command_trace_option(CLI::App& command, std::string& file);
/// Adds `--log-registers` and the option for its size.
void add_register_log_options(CLI::App& command, RegisterLogRequest& request);
/// @throws UserError if a size is given although nothing can start a log
void check_register_log(const RegisterLogRequest& request, const std::string& gdb);
/// Adds `--hazards`.
void add_hazards_option(CLI::App& command, bool& hazards);
/// Adds `--profile`.
void add_profile_option(CLI::App& command, bool& profile);

}  // namespace fovea::app
