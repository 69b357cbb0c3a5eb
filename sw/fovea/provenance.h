// What a result was made by: the program's commit and the contents of the files that it read.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sw/fovea/experiment.h"

namespace fovea::app {

struct Provenance {
  std::string version = {};
  std::string commit = {};   ///< of the source that the program was built from; "unknown"
  bool modified = false;     ///< the source differed from that commit
  /// SHA-256 of each file, by the key or argument that names it; empty if it cannot be read.
  std::vector<std::pair<std::string, std::string>> inputs = {};
};

using InputFiles = std::vector<std::pair<std::string, std::filesystem::path>>;

/// SHA-256 in hexadecimal digits; empty if it is no regular file or cannot be read.
std::string sha256_of(const std::filesystem::path& file);

/// Version and commit of this program (`fovea.commit` lies beside it, written by the build).
Provenance program_provenance();
/// The same with the files of `inputs` and of those path keys that are set and have an effect; what
/// `inputs` names already is not asked for again.
Provenance provenance_of(const ParamSet& params, InputFiles inputs);

/// "0.1.0 (commit 0123456789ab, modified)".
std::string provenance_text(const Provenance& program);

}  // namespace fovea::app
