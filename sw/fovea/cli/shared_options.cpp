#include "sw/fovea/cli/shared_options.h"

#include <CLI/CLI.hpp>

#include "sw/fovea/config/run_until.h"

namespace fovea::app {

void add_limit_options(CLI::App& command, LimitOptions& options) {
  command.add_option("--max-time", options.max_time,
                     "Give up (status 3) after this much simulated time, such as 20s")
      ->type_name("TIME");
  command
      .add_option("--max-instructions", options.max_instructions,
                  "Give up (status 3) after this many instructions")
      ->check(CLI::Validator(
          [](const std::string& s) {
            return s == "0" ? std::string("at least one instruction is needed") : "";
          },
          ""))
      ->type_name("N");
  command.add_option("--symbols", options.symbols,
                     "ELF file with more symbols, such as a kernel that the program loads")
      ->type_name("FILE");
}

RunLimits limits_of(const LimitOptions& options) {
  RunLimits limits;
  if (!options.max_time.empty()) limits.time = parse_time("--max-time", options.max_time);
  if (options.max_instructions) limits.instructions = *options.max_instructions;
  return limits;
}

std::optional<ElfImage> symbols_of(const LimitOptions& options) {
  if (options.symbols.empty()) return std::nullopt;
  return ElfImage::load(options.symbols);
}

void add_set_option(CLI::App& command, std::vector<std::string>& sets) {
  command.add_option("-s,--set", sets, "Set a parameter; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

}  // namespace fovea::app
