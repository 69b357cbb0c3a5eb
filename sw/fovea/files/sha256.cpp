#include "sw/fovea/files/sha256.h"

#include <fmt/format.h>
#include <gcrypt.h>

#include <array>

namespace fovea::app {

std::string sha256_of_text(std::string_view text) {
  [[maybe_unused]] static const char* const initialised = gcry_check_version(nullptr);
  std::array<unsigned char, 32> digest{};
  gcry_md_hash_buffer(GCRY_MD_SHA256, digest.data(), text.data(), text.size());
  std::string out;
  for (const unsigned char byte : digest) out += fmt::format("{:02x}", byte);
  return out;
}

}  // namespace fovea::app
