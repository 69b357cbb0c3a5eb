// Which backend the parameter `engine` asks for.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "model/common/clock.h"
#include "model/engine/core/engine_backend.h"
#include "model/engine/engine_params.h"

namespace fovea::engine {

/// What two compared backends report.
struct Comparison {
  std::function<void(std::int64_t lag)> on_equal;          ///< equal requests: clocks that the twin asked later
  std::function<void(std::uint64_t requests)> on_skipped;  ///< behind an error or an abort, which are not compared
  std::function<void(const std::string& what)> on_difference;  ///< the first one; waveforms end 1 us behind it
};

/// For tests of what a run says of a difference: which write of the twin, counted from 1, is wrong by a bit; 0: none.
inline std::uint64_t planted_difference = 0;

/// @throws UserError if this program was built without it
std::unique_ptr<EngineBackend> make_backend(const EngineParams& params, const Clock& clock,
                                            EngineBackend::Host& host, Comparison comparison);

}  // namespace fovea::engine
