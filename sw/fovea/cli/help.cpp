#include "sw/fovea/cli/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "sw/fovea/config/experiment.h"
#include "sw/fovea/explain/wrapped.h"

namespace fovea::app {
namespace {

constexpr std::size_t kColumn = 28;  ///< column at which descriptions begin

/// Splits "WORD:{a,b}" into the name of the value and the description of its check.
struct TypeText {
  std::string name, check;
};

TypeText type_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t colon = type.find(':', 1);  // ":PORT" is only a name
  if (colon == std::string::npos) return {type, ""};
  return {type.substr(0, colon), type.substr(colon + 1)};
}

/// The words that the option allows; empty if it has no such list.
std::vector<std::string> words_of(const CLI::Option& option) {
  const std::string check = type_of(option).check;
  if (!check.starts_with('{') || !check.ends_with('}')) return {};
  std::vector<std::string> words;
  std::istringstream in(check.substr(1, check.size() - 2));
  for (std::string word; std::getline(in, word, ',');) words.push_back(word);
  return words;
}

/// "-s,--set KEY=VALUE", or the name of a positional argument.
std::string left_text(const CLI::Option& option, bool positional) {
  if (positional) return option.get_name(true, false);
  std::string text = option.get_name(false, true);
  if (option.get_type_size() == 0) return text;
  const auto words = words_of(option);
  return text + " " +
         (words.empty() ? type_of(option).name : fmt::format("{}", fmt::join(words, "|")));
}

std::string description_of(const CLI::Option& option) {
  std::string text = option.get_description();
  const std::string check = type_of(option).check;
  // CLI11's text for a range: "INT in [1 - 9]".
  if (const std::size_t in = check.find(" in ["); in != std::string::npos)
    text += " (" + check.substr(in + 5, check.find(']') - in - 5) + ")";
  if (!option.get_default_str().empty())
    text += fmt::format(" [default: {}]", option.get_default_str());
  return text;
}

std::string two_columns(const std::string& left, const std::string& right) {
  std::string out = "  " + left;
  if (out.size() + 2 > kColumn)
    out += "\n" + std::string(kColumn, ' ');
  else
    out.resize(kColumn, ' ');
  return out + wrapped(right, kColumn) + "\n";
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  return app.get_options(
      [positional](const CLI::Option* o) { return o->get_positional() == positional; });
}

/// All names of an option, including their dashes.
std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> out;
  for (const auto& name : option.get_snames()) out.push_back("-" + name);
  for (const auto& name : option.get_lnames()) out.push_back("--" + name);
  return out;
}

/// Escapes text for troff, so that it contains no escapes or requests, and hyphens are kept.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') out += "\\e";
    else if (c == '-') out += "\\-";
    else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n'))
      out += std::string("\\&") + c;
    else out += c;
  }
  return out;
}

}  // namespace

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  return two_columns(left_text(*option, is_positional), description_of(*option));
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  return two_columns(command->get_name(), command->get_description());
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  return wrapped(app->get_description(), 0) + "\n";
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
  const std::string footer = app->get_footer();
  return footer.empty() ? "" : wrapped(footer, 0) + "\n";
}

namespace {

/// What completes a subcommand: its options and words, and those of its parts.
std::string completion_case(const CLI::App& c, const std::map<std::string, std::vector<OfferedKey>>& keys) {
  std::string names, words;
  const auto add_names = [&names](const CLI::App& of) {
    for (const auto* o : options_of(of, false))
      for (const auto& name : names_of(*o))
        if ((" " + names + " ").find(" " + name + " ") == std::string::npos)
          names += (names.empty() ? "" : " ") + name;
  };
  add_names(c);
  for (const auto* part : commands_of(c)) {
    words += (words.empty() ? "" : " ") + part->get_name();
    add_names(*part);
  }
  for (const auto* o : options_of(c, true)) {
    if (o->get_name() == "experiment") words = fmt::format("{}", fmt::join(shipped_experiments(), " "));
    if (const auto list = words_of(*o); !list.empty()) words = fmt::format("{}", fmt::join(list, " "));
  }
  std::string out = fmt::format("    {}) options='{}' words='{}'", c.get_name(), names, words);
  if (const auto k = keys.find(c.get_name()); k != keys.end()) {
    out += " keys='";
    for (const OfferedKey& key : k->second) out += (&key == &k->second.front() ? "" : " ") + key.key;
    out += "'";
  }
  return out + " ;;\n";
}

std::string value_case(const std::string& before, const std::string& words) {
  return fmt::format("    {}) COMPREPLY=($(compgen -W '{}' -- \"$current\")); return ;;\n", before, words);
}

/// What completes the value of each option that allows certain words only, and of each key behind -s.
std::string completion_values(const CLI::App& c, const std::map<std::string, std::vector<OfferedKey>>& keys) {
  std::string out;
  if (const auto k = keys.find(c.get_name()); k != keys.end())
    for (const OfferedKey& key : k->second)
      if (!key.words.empty()) out += value_case(fmt::format("'{} {}'", c.get_name(), key.key), key.words);
  auto options = options_of(c, false);
  for (const auto* part : commands_of(c))
    for (const auto* o : options_of(*part, false)) options.push_back(o);
  for (const auto* o : options)
    if (const auto list = words_of(*o); !list.empty())
      for (const auto& name : names_of(*o))
        out += value_case(fmt::format("'{} {}'", c.get_name(), name), fmt::format("{}", fmt::join(list, " ")));
  return out;
}

}  // namespace

std::string bash_completion(const CLI::App& app, const std::map<std::string, std::vector<OfferedKey>>& keys) {
  std::string commands, cases, values;
  for (const auto* c : commands_of(app)) {
    commands += (commands.empty() ? "" : " ") + c->get_name();
    cases += completion_case(*c, keys);
    values += completion_values(*c, keys);
  }
  return "# Completion for bash: source it, or put it into /etc/bash_completion.d.\n"
         "_fovea() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
         "  local command=${COMP_WORDS[1]} options='' words='' keys=''\n"
         "  COMPREPLY=()\n"
         "  # Readline splits '--option=value' at the sign.\n"
         "  if [ \"$current\" = = ]; then current=''; fi\n"
         "  if [ \"$before\" = = ]; then before=${COMP_WORDS[COMP_CWORD-2]}; fi\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
         "    COMPREPLY=($(compgen -W '" +
         commands +
         " --help --version' -- \"$current\"))\n"
         "    return\n"
         "  fi\n"
         "  case $command in\n" +
         cases +
         "  esac\n"
         "  case \"$command $before\" in\n" +
         values +
         "    *' -s'|*' --set') COMPREPLY=($(compgen -S = -W \"$keys\" -- \"$current\"))\n"
         "      compopt -o nospace 2>/dev/null; return ;;\n"
         "  esac\n"
         "  case $current in\n"
         "    -*) COMPREPLY=($(compgen -W \"$options\" -- \"$current\")) ;;\n"
         "    *) COMPREPLY=($(compgen -W \"$words\" -- \"$current\") "
         "$(compgen -f -- \"$current\")) ;;\n"
         "  esac\n"
         "}\n"
         "complete -o filenames -F _fovea fovea\n";
}

std::string man_page(const CLI::App& app, const std::string& version) {
  std::string out = fmt::format(".TH FOVEA 1 \"\" \"fovea {}\" \"User Commands\"\n", roff(version));
  out += fmt::format(".SH NAME\nfovea \\- {}\n", roff(app.get_description()));
  out += ".SH SYNOPSIS\n.B fovea\nCOMMAND [OPTIONS]\n.SH COMMANDS\n";
  const auto add = [&out](const std::string& name, const CLI::App& c) {
    out += fmt::format(".SS fovea {}", roff(name));
    for (const auto* o : options_of(c, true)) out += " " + roff(left_text(*o, true));
    out += "\n" + roff(c.get_description()) + ".\n";
    for (const bool positional : {true, false})
      for (const auto* o : options_of(c, positional))
        out += fmt::format(".TP\n.B {}\n{}\n", roff(left_text(*o, positional)),
                           roff(description_of(*o)));
    if (!c.get_footer().empty()) out += ".PP\n" + roff(c.get_footer()) + "\n";
  };
  for (const auto* c : commands_of(app)) {
    add(c->get_name(), *c);
    for (const auto* part : commands_of(*c)) add(c->get_name() + " " + part->get_name(), *part);
  }
  return out + ".SH EXIT STATUS\n" + roff(app.get_footer()) + "\n";
}

}  // namespace fovea::app
