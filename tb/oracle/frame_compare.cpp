#include "tb/oracle/frame_compare.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

namespace fovea::oracle {

Frame remap(const Frame& in, std::span<const std::uint32_t> lut, std::uint32_t pitch_bytes) {
  const std::uint32_t row_bytes = in.width * 2;
  if (pitch_bytes < row_bytes || in.uyvy.size() != std::size_t{row_bytes} * in.height)
    throw std::invalid_argument("frame data, width, height and pitch disagree");
  if (lut.size() != std::size_t{in.width} / 2 * in.height)
    throw std::invalid_argument("table of " + std::to_string(lut.size()) + " entries for " +
                                std::to_string(in.width) + "x" + std::to_string(in.height));
  constexpr std::uint8_t kBlack[4] = {128, 16, 128, 16};
  Frame out{in.width, in.height, std::vector<std::uint8_t>(in.uyvy.size())};
  for (std::size_t i = 0; i < lut.size(); ++i) {
    const std::uint32_t row = lut[i] / pitch_bytes, column = lut[i] % pitch_bytes;
    const bool black = row == in.height && column == 0;
    if (!black && (row >= in.height || column >= row_bytes || column % 4 != 0))
      throw std::invalid_argument("entry " + std::to_string(i) + " points to byte " +
                                  std::to_string(lut[i]) + ", which is no pair of the frame");
    const std::uint8_t* from = black ? kBlack : &in.uyvy[std::size_t{row} * row_bytes + column];
    std::copy(from, from + 4, &out.uyvy[i * 4]);
  }
  return out;
}

std::string Difference::text() const {
  static const char* const kNames[] = {"Cb", "Y0", "Cr", "Y1"};
  char line[160];
  std::snprintf(line, sizeof line, "pixel %u,%u %s: expected %d, got %d (%zu bytes differ)", x, y,
                kNames[byte], expected, got, count);
  return line;
}

std::optional<Difference> compare(const Frame& expected, const Frame& got) {
  const std::size_t common = std::min(expected.uyvy.size(), got.uyvy.size());
  std::optional<Difference> first;
  std::size_t count = std::max(expected.uyvy.size(), got.uyvy.size()) - common;
  const unsigned row_bytes = std::max(1u, expected.width * 2);
  const auto at = [&](std::size_t i) {
    Difference d;
    d.y = static_cast<unsigned>(i / row_bytes);
    d.byte = static_cast<unsigned>(i % 4);
    d.x = static_cast<unsigned>(i % row_bytes / 4 * 2 + (d.byte == 3));
    d.expected = i < expected.uyvy.size() ? expected.uyvy[i] : -1;
    d.got = i < got.uyvy.size() ? got.uyvy[i] : -1;
    return d;
  };
  for (std::size_t i = 0; i < common; ++i) {
    if (expected.uyvy[i] == got.uyvy[i]) continue;
    if (!first) first = at(i);
    ++count;
  }
  const bool other_shape = expected.width != got.width || expected.height != got.height;
  if (!first && (count > 0 || other_shape)) first = at(common);
  if (first) first->count = count;
  return first;
}

}  // namespace fovea::oracle
