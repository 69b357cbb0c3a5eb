// Which backend the parameter `engine` asks for.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>

#include "model/common/clock.h"
#include "model/engine/core/engine_backend.h"
#include "model/engine/engine_params.h"

namespace fovea::engine {

/// Called for each pair of equal requests of two compared backends: clocks that the twin asked later.
using OnCompared = std::function<void(std::int64_t lag)>;

/// @throws UserError if this program was built without it
std::unique_ptr<EngineBackend> make_backend(const EngineParams& params, const Clock& clock,
                                            EngineBackend::Host& host, OnCompared on_compared = {});

}  // namespace fovea::engine
