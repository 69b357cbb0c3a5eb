// What a guest may write to registers, as inputs for the fuzzer.
#pragma once
#include <string_view>

#include "tb/fuzz/readers.h"

namespace fovea::fuzz {

/// Steps of 7 bytes for the EDMA's channel controller: what (modulo 8), 16 bits of offset, 32 of value. All it submits
/// must be something that a transfer controller can execute, and QSTAT must show what is in the queues.
Result edma(std::string_view bytes);
/// Steps of 6 bytes for the remap engine on a memory: what (modulo 8), offset, 32 bits of value. An abort at the end
/// must bring it to rest.
Result engine(std::string_view bytes);

}  // namespace fovea::fuzz
