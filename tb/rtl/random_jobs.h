// Random jobs of all modes, for the tests of address generator and engine.
#pragma once
#include <array>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "tb/rtl/lens_maps.h"

namespace fovea::rtl {

/// FOVEA_SEED, or 1; printed once.
inline std::uint32_t seed() {
  static const std::uint32_t value = [] {
    const char* text = std::getenv("FOVEA_SEED");
    const auto s = text ? static_cast<std::uint32_t>(std::strtoul(text, nullptr, 0)) : 1u;
    std::printf("seed %u\n", s);
    return s;
  }();
  return value;
}

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : random_(seed) {}
  unsigned to(unsigned n) { return static_cast<unsigned>(random_()) % (n + 1); }  ///< 0 to n
  std::uint32_t word() { return static_cast<std::uint32_t>(random_()); }
  std::int32_t within(std::int32_t n) {
    return static_cast<std::int32_t>(word() % (2u * static_cast<unsigned>(n) + 1)) - n;
  }

 private:
  std::mt19937 random_;
};

/// Any possible job of a mode with up to about 600 pairs, and a map of any words that lead
/// somewhere near the frame.
inline MappedJob random_job(Dice& dice, Mode mode) {
  MappedJob m;
  Job& j = m.job;
  j.mode = mode;
  j.bilinear = dice.to(1);
  j.pairs = 1 + dice.to(dice.to(1) ? 70 : 3);
  j.rows = 1 + dice.to(600 / j.pairs);
  j.src_width = 2 * (1 + dice.to(dice.to(1) ? 200 : 4));
  j.src_height = 1 + dice.to(dice.to(1) ? 300 : 4);
  j.src_pitch = j.src_width / 2 + dice.to(dice.to(1) ? 0 : 20);
  j.dst_pitch = dice.to(8191);
  j.src_base = dice.word() >> 2;
  j.dst_base = dice.word() >> 2;
  const std::int32_t width = static_cast<std::int32_t>(j.src_width),
                     height = static_cast<std::int32_t>(j.src_height);
  const std::int32_t pairs = static_cast<std::int32_t>(j.pairs),
                     rows = static_cast<std::int32_t>(j.rows);
  // Forms that cross the frame once, more or less, and are a little beyond it.
  j.a[0] = dice.within(width << 14);
  j.a[1] = (dice.within(width << 14) + (width << 16)) / pairs;
  j.a[2] = dice.within(width << 14) / rows;
  j.b[0] = dice.within(height << 14);
  j.b[1] = dice.within(height << 14) / pairs;
  j.b[2] = (dice.within(height << 14) + (height << 16)) / rows;
  j.c[0] = j.b[0];
  j.c[1] = j.b[1];
  j.c[2] = j.b[2] + dice.within(1 << 14);
  if (dice.to(7) == 0)  // anything at all
    for (auto* form : {&j.a, &j.b, &j.c})
      for (auto& k : *form) k = static_cast<std::int32_t>(dice.word());
  switch (mode) {
    case Mode::kTable:
      break;
    case Mode::kGrid:
      j.grid_log2 = 2 + dice.to(4);
      break;
    case Mode::kRadial:
      j.pieces = 1 + dice.to(127);
      j.piece_log2 = dice.to(12);
      if (dice.to(1)) j.radius_limit = dice.word() >> dice.to(16);
      j.piece_log2 += 6;
      j.centre_x = dice.within(width << 15) + (width << 14);
      j.centre_y = dice.within(height << 15) + (height << 14);
      break;
    case Mode::kProject: {
      const std::int32_t scale = 1 << dice.to(6);
      for (auto* form : {&j.a, &j.b})
        for (auto& k : *form) k = k / 256 * scale;
      j.c[0] = 256 * scale + dice.within(16 * scale);
      j.c[1] = dice.within(4 * scale);
      j.c[2] = dice.within(4 * scale);
      if (dice.to(3) == 0) j.c[0] = (1 << 24) - static_cast<std::int32_t>(dice.to(200));
      break;
    }
  }
  m.map.resize(map_words(j));
  const std::uint32_t end = j.src_height * j.src_pitch * 4;
  for (std::uint32_t& word : m.map) {
    if (mode == Mode::kTable)
      word = dice.to(15) ? (dice.word() % (end + 8)) & ~(dice.to(31) ? 3u : 0u)
                         : std::array{end - 4, end, end + 4, 0xFFFFFFFCu}[dice.to(3)];
    else if (mode == Mode::kGrid)
      word = dice.to(15) ? (dice.word() & 0x007F007F) : dice.word();
    else
      word =
          dice.to(31) ? static_cast<std::uint32_t>(dice.within(1 << 18) + (1 << 19)) : dice.word();
  }
  return m;
}

}  // namespace fovea::rtl
