// Settings of the TVP5146 that act on the chip and have no effect in the model: found by the value that is written.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace fovea::video {

/// What a value in a register asks for that the model lacks, one sentence with the field's name each, such as
/// "TVP5146 OUTPUT_FORMATTER1.FORMAT (33, output format): only 0 is modelled"; empty: nothing.
std::vector<std::string> decoder_not_modelled(std::uint8_t index, std::uint8_t value);

/// The registers after a reset, as far as this is known; others are 0. Those that tell of the signal are not among
/// them.
std::array<std::uint8_t, 256> decoder_reset_values();

}  // namespace fovea::video
