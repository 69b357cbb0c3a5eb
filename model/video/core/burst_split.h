// Splits a range of bytes into memory bursts.
#pragma once
#include <bit>
#include <cstdint>

namespace fovea::video {

/// Bytes of the first burst of `remaining` bytes at `address`: the largest power of two that is at
/// most `burst`, fits, and does not cross a multiple of its size. `address` and `remaining` must be
/// multiples of 4, `burst` a power of two.
constexpr unsigned first_burst(std::uint32_t address, unsigned remaining, unsigned burst) {
  const unsigned alignment = address ? 1u << std::countr_zero(address) : burst;
  unsigned bytes = alignment < burst ? alignment : burst;
  while (bytes > remaining) bytes >>= 1;
  return bytes;
}

}  // namespace fovea::video
