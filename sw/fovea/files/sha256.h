// Hashes of texts.
#pragma once
#include <string>
#include <string_view>

namespace fovea::app {

/// SHA-256 in hexadecimal digits.
std::string sha256_of_text(std::string_view text);

}  // namespace fovea::app
