// Which backend the parameter `engine` asks for.
#pragma once
#include <memory>

#include "model/common/clock.h"
#include "model/engine/core/engine_backend.h"
#include "model/engine/engine_params.h"

namespace fovea::engine {

/// @throws UserError if this program was built without it
std::unique_ptr<EngineBackend> make_backend(const EngineParams& params, const Clock& clock,
                                            EngineBackend::Host& host);

}  // namespace fovea::engine
