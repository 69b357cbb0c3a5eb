// Hashes of texts.
#pragma once
#include <string>
#include <string_view>

namespace fovea::app {

/// SHA-256 in hexadecimal digits. @throws UserError if the library has no SHA-256
std::string sha256_of_text(std::string_view text);

}  // namespace fovea::app
