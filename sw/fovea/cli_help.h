// What the command line tells about itself, all of it from the one declaration to CLI11.
#pragma once
#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

namespace fovea::app {

/// Help of at most 80 columns, with the default of each option that has one.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;
};

/// Lines of at most `width` columns, all but the first indented by `indent`; a line feed in `text`
/// stays one.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width = 80);

/// Completion for bash: commands, options, words that an option allows, and after -s the keys that
/// `keys` lists for the command.
std::string bash_completion(const CLI::App& app,
                            const std::map<std::string, std::vector<std::string>>& keys);

/// The manual page, for `man -l`.
std::string man_page(const CLI::App& app, const std::string& version);

}  // namespace fovea::app
