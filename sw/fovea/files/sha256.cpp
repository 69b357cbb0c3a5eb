#include "sw/fovea/files/sha256.h"

#include <fmt/format.h>
#include <gcrypt.h>

#include <array>

#include "model/common/check.h"

namespace fovea::app {

std::string sha256_of_text(std::string_view text) {
  [[maybe_unused]] static const char* const initialised = gcry_check_version(nullptr);
  if (const gcry_error_t failed = gcry_md_test_algo(GCRY_MD_SHA256))
    throw UserError(fmt::format("libgcrypt has no SHA-256: {}", gcry_strerror(failed)));
  std::array<unsigned char, 32> digest{};
  gcry_md_hash_buffer(GCRY_MD_SHA256, digest.data(), text.data(), text.size());
  std::string out;
  for (const unsigned char byte : digest) out += fmt::format("{:02x}", byte);
  return out;
}

}  // namespace fovea::app
