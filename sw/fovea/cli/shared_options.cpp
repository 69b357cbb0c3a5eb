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

void add_around_option(CLI::App& command, std::string& time) {
  command
      .add_option("--around", time,
                  "List all requests to the SDRAM within 2 us of this time (\"80.153412ms\", as slowest.csv has it) in "
                  "requests.csv")
      ->type_name("TIME")
      ->check(CLI::Validator([](const std::string& s) { return s.empty() ? "a time is needed" : std::string(); }, ""));
}

void add_command_trace_option(CLI::App& command, std::string& file) {
  command
      .add_option("--command-trace", file,
                  "Write the commands on the SDRAM's bus to this file: clock,command,bank,row")
      ->type_name("FILE")
      ->check(CLI::Validator([](const std::string& s) { return s.empty() ? "a file name is needed" : std::string(); },
                             ""));
}

void add_register_log_options(CLI::App& command, RegisterLogRequest& request) {
  command
      .add_option("--log-registers", request.pattern,
                  "Log accesses to registers whose BLOCK.REGISTER matches this regular expression")
      ->type_name("REGEX")
      ->check(CLI::Validator(
          [](const std::string& s) {
            return s.empty() ? std::string("a regular expression is needed; '.' takes all") : "";
          },
          ""));
  command
      .add_option("--log-registers-kept", request.kept,
                  "Keep the last N accesses; also of a log that GDB begins")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, kRegisterLogMost))
      ->capture_default_str();
}

void add_hazards_option(CLI::App& command, bool& hazards) {
  command.add_flag("--hazards", hazards,
                   "Warn where the core and a DMA master see different memory, because a line of the "
                   "D-cache is stale or dirty; with --strict that is an error at the end");
}

void add_profile_option(CLI::App& command, bool& profile) {
  command.add_flag("--profile", profile,
                   "Say where each clock of the core went, by function, line, cause and culprit: "
                   "profile.csv, .folded, .callgrind and .txt; changes no other result");
}

void check_register_log(const RegisterLogRequest& request, const std::string& gdb) {
  if (request.pattern.empty() && gdb.empty() && request.kept != RegisterLogRequest{}.kept)
    throw UserError(
        "--log-registers-kept: nothing is logged; allowed: with --log-registers or --gdb");
}

}  // namespace fovea::app
