// Help, completion and manual page, all generated from the declarations made to CLI11.
#pragma once
#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "sw/fovea/cli/command_row.h"

namespace fovea::app {

/// Help with at most 80 columns, including the default of each option that has one.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;
};

/// Completion script for bash: commands, options, the words that an option allows, shipped experiments and, after -s,
/// the keys that `keys` lists for the command with their words.
std::string bash_completion(const CLI::App& app, const std::map<std::string, std::vector<OfferedKey>>& keys);

/// The manual page in the format of `man -l`.
std::string man_page(const CLI::App& app, const std::string& version);

}  // namespace fovea::app
