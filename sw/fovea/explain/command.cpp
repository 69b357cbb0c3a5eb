#include "sw/fovea/explain/command.h"

#include <algorithm>

namespace fovea::explain {

std::string shell_word(std::string_view word) {
  constexpr std::string_view kSpecial = " \t\n'\"\\$`*?[]();&|<>~#!";
  if (!word.empty() && word.find_first_of(kSpecial) == word.npos) return std::string(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string binds_command(std::string_view experiment, std::span<const std::string> sets) {
  std::string out = "fovea limits " + shell_word(experiment);
  for (const std::string& set : sets) out += " -s " + shell_word(set);
  return out + " --binds frame.remap_time.mean";
}

std::string without_folders(std::string_view word) {
  std::string out;
  for (std::size_t at = 0; at < word.size();) {
    // A path begins where a word or a value does.
    const bool begins =
        at == 0 || word[at - 1] == '=' || word[at - 1] == ',' || word[at - 1] == ' ' || word[at - 1] == '\'';
    if (!begins || word[at] != '/') {
      out += word[at++];
      continue;
    }
    const std::size_t end = std::min(word.find_first_of(",' ", at), word.size());
    const std::string_view path = word.substr(at, end - at);
    const std::size_t last = path.find_last_not_of('/');
    const std::string_view trimmed = last == path.npos ? path : path.substr(0, last + 1);
    out += last == path.npos ? path : trimmed.substr(trimmed.rfind('/') + 1);
    at = end;
  }
  return out;
}

}  // namespace fovea::explain
