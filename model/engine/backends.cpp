#include "model/engine/backends.h"

#include "model/common/check.h"
#include "model/engine/core/tlm_backend.h"

namespace fovea::engine {

std::unique_ptr<EngineBackend> make_backend(const EngineParams& params, const Clock& clock,
                                            EngineBackend::Host& host) {
  // Without an engine nothing runs: the block is made to print its registers.
  if (params.kind.is("tlm") || params.kind.is("none")) return std::make_unique<TlmBackend>(clock, host);
  throw UserError("key 'engine': '" + params.kind() +
                  "' needs Verilator, which was missing when this program was built; allowed: none, tlm");
}

}  // namespace fovea::engine
