// Command lines as they are shown to people.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace fovea::explain {

/// A word of a command line, in quotes where a shell would not take it as it is.
std::string shell_word(std::string_view word);

/// "fovea limits EXPERIMENT -s KEY=VALUE --binds frame.remap_time.mean": the command that finds out by runs
/// what would make the remaps of an experiment faster. One run alone does not show that.
/// @param sets what was set on the command line, as "key=value"
std::string binds_command(std::string_view experiment, std::span<const std::string> sets);

/// A path or a list of words in which each absolute path is shortened to its last name: "/home/me/a.yaml"
/// becomes "a.yaml", "firmware.elf=/b/c.elf" becomes "firmware.elf=c.elf". For pages that are passed on.
std::string without_folders(std::string_view word);

}  // namespace fovea::explain
