// Remap of whole frames through a table on the host, and comparison of frames byte by byte.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fovea::oracle {

/// A 4:2:2 frame with bytes Cb Y0 Cr Y1; rows without padding.
struct Frame {
  unsigned width = 0, height = 0;
  std::vector<std::uint8_t> uyvy;
  friend bool operator==(const Frame&, const Frame&) = default;
};

/// The paper's loop: output pair i is the input pair at byte offset lut[i]. Offsets refer to target
/// memory with rows of pitch_bytes; the offset height * pitch_bytes is black (Cb 128, Y 16, Cr 128,
/// Y 16). @throws std::invalid_argument that names the first unaligned entry or the first outside
/// the frame
Frame remap(const Frame& in, std::span<const std::uint32_t> lut, std::uint32_t pitch_bytes);

struct Difference {
  unsigned x = 0, y = 0;      ///< pixel position
  unsigned byte = 0;          ///< position in the pair: 0 Cb, 1 Y0, 2 Cr, 3 Y1
  int expected = 0, got = 0;  ///< -1 if a frame has no such byte
  std::size_t count = 0;      ///< number of bytes that differ in the whole frame
  std::string text() const;
};
/// The first difference in raster order; empty if equal. Frames of different sizes differ.
std::optional<Difference> compare(const Frame& expected, const Frame& got);

}  // namespace fovea::oracle
