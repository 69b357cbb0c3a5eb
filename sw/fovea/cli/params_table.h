// The table that `fovea params` prints.
#pragma once

#include <string>
#include <vector>

#include "model/common/param.h"

namespace fovea::app {

/// One row for each key that matches one of the patterns, in the order of the keys. A pattern is a part of a key or,
/// with `*`, `?` or `[`, a shell pattern for the whole key. Without patterns: all keys; of the cameras, only those of
/// camera 0.
/// @throws UserError if a pattern matches no key
std::string params_table(const ParamSet& params, const std::vector<std::string>& patterns,
                         bool markdown);

}  // namespace fovea::app
