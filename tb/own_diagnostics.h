// Diagnostics of one test or bench.
#pragma once
#include "model/common/check.h"

namespace fovea {

/// The current ones as long as they live. As the first member of a bench: of all blocks in it.
struct OwnDiagnostics : Diagnostics {
 private:
  DiagnosticsScope scope_{*this};
};

}  // namespace fovea
