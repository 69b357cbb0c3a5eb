// The origin of a result: the program's commit, and hashes of the files that it read.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sw/fovea/config/experiment.h"

namespace fovea::app {

struct Provenance {
  std::string version = {};
  std::string commit = {};   ///< commit of the program's source, or "unknown"
  bool modified = false;     ///< the source differed from that commit
  /// SHA-256 of each file, with the key or argument that names it; empty if it is not there or can be read once only.
  std::vector<std::pair<std::string, std::string>> inputs = {};
  /// Of `exec` and `replay`, which have no experiment: the command, the name of the file that it ran, and
  /// the words that decide its result besides the parameters.
  std::string command = {}, input = {};
  std::vector<std::string> arguments = {}, options = {};
};

using InputFiles = std::vector<std::pair<std::string, std::filesystem::path>>;

/// SHA-256 in hexadecimal digits; empty for what can be read once only, such as a pipe.
/// @throws UserError if the file is not there or cannot be read, or if the library fails
std::string sha256_of(const std::filesystem::path& file);

/// Version and commit of this program (from the file `fovea.commit` beside it, written by the
/// build).
Provenance program_provenance();
/// The same, with hashes of `inputs` and of the files of all path keys that are set and have an
/// effect, unless `inputs` contains them already. One of these that is not there is refused by whoever reads it.
/// @param read further inputs, which were read already @throws UserError if one of them is not there any more
Provenance provenance_of(const ParamSet& params, InputFiles inputs, const InputFiles& read = {});

/// "0.1.0 (commit 0123456789ab, modified)".
std::string provenance_text(const Provenance& program);

}  // namespace fovea::app
