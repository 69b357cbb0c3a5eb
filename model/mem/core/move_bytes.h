// Copies of a few bytes in the hot path.
#pragma once
#include <cstdint>
#include <cstring>

namespace fovea::mem {

/// The usual lengths in line; memcpy() of a length not known is a call.
[[gnu::always_inline]] inline void move_bytes(std::uint8_t* to, const std::uint8_t* from,
                                              unsigned bytes) {
  if (bytes == 4)
    std::memcpy(to, from, 4);
  else if (bytes == 32)
    std::memcpy(to, from, 32);
  else if (bytes == 64)
    std::memcpy(to, from, 64);
  else
    std::memcpy(to, from, bytes);
}

}  // namespace fovea::mem
