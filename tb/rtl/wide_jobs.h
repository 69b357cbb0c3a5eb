// Random jobs whose sizes, addresses, forms and maps use all of their bits, for the tests of address generator and
// engine. random_jobs.h makes likely ones.
#pragma once
#include <algorithm>
#include <bit>

#include "tb/rtl/random_jobs.h"

namespace fovea::rtl {

/// 1 to `most`, each number of bits about equally often; `most` itself too.
inline unsigned any_size(Dice& dice, unsigned most) {
  if (dice.to(9) == 0) return most;
  const unsigned bits = dice.to(static_cast<unsigned>(std::bit_width(most)) - 1);
  return std::min(most, (1u << bits) + dice.to((1u << bits) - 1));
}

/// A form that is `value` at the first pair, and about as large as `span` everywhere.
inline void any_form(Dice& dice, std::int32_t (&form)[3], std::int64_t value, std::int64_t span, const Job& j) {
  const auto clamped = [](std::int64_t k) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(k, -0x8000'0000LL, 0x7FFF'FFFFLL));
  };
  const auto up_to = [&](std::int64_t n) {
    return static_cast<std::int64_t>(dice.word()) * (n >> 16) / 0x1'0000 * (dice.to(1) ? 1 : -1);
  };
  form[0] = clamped(value);
  form[1] = clamped(up_to(span) / j.pairs);
  form[2] = clamped(up_to(span) / j.rows);
}

/// A possible job of a mode with about `most_pairs` pairs at most; about half of them have a source.
inline MappedJob wide_job(Dice& dice, Mode mode, unsigned most_pairs) {
  MappedJob m;
  Job& j = m.job;
  j.mode = mode;
  j.bilinear = dice.to(1);
  j.grid_log2 = 2 + dice.to(4);
  const unsigned widest = mode == Mode::kGrid ? std::min(2048u, 255u << (j.grid_log2 - 1)) : 2048;
  j.pairs = any_size(dice, std::min(widest, most_pairs));
  j.rows = any_size(dice, std::min(4096u, most_pairs / j.pairs));
  j.src_width = 2 * any_size(dice, 2048);
  j.src_height = any_size(dice, 4096);
  j.src_pitch = std::max(j.src_width / 2, any_size(dice, 8191));
  j.dst_pitch = dice.to(8191);
  j.src_base = dice.word() >> 2;
  j.dst_base = dice.word() >> 2;
  const std::int64_t width = std::int64_t{j.src_width} << 16, height = std::int64_t{j.src_height} << 16;
  const auto within = [&](std::int64_t n) { return static_cast<std::int64_t>(dice.word()) * (n >> 8) >> 24; };
  any_form(dice, j.a, within(width), width, j);
  any_form(dice, j.b, within(height), height, j);
  any_form(dice, j.c, dice.within(1 << 30), 1 << 30, j);
  j.radius_limit = dice.to(1) ? 0xFFFF'FFFF : dice.word() >> dice.to(24);
  j.centre_x = static_cast<std::int32_t>(within(width));
  j.centre_y = static_cast<std::int32_t>(within(height));
  if (mode == Mode::kRadial) {
    // A square radius that lies within the pieces, whatever their width.
    j.pieces = any_size(dice, 128);
    j.piece_log2 = dice.to(23);
    const std::int64_t radius = std::int64_t{1} << std::min(27, 17 + static_cast<int>(j.piece_log2 / 2 + dice.to(3)));
    for (auto* form : {&j.a, &j.b, &j.c}) any_form(dice, *form, within(2 * radius) - radius, radius, j);
  } else if (mode == Mode::kProject) {
    // A divisor of any size, and numerators so that the quotients are in the frame, at either end of it or beyond.
    const std::int64_t divisor = std::int64_t{1 + dice.to(255)} << dice.to(16);
    any_form(dice, j.c, divisor, divisor / 2, j);
    any_form(dice, j.a, within(width >> 16) * divisor, (width >> 16) * divisor, j);
    any_form(dice, j.b, within(height >> 16) * divisor, (height >> 16) * divisor, j);
  }
  m.map.resize(map_words(j));
  const std::uint32_t end = j.src_height * j.src_pitch * 4;
  for (std::uint32_t& word : m.map) {
    if (mode == Mode::kTable)
      word = dice.to(9) ? static_cast<std::uint32_t>(within(end)) & ~3u
                        : dice.to(3) ? dice.word() : end + 4 * dice.to(2) - 4;
    else if (mode == Mode::kGrid)
      word = dice.word() >> dice.to(1) * 8 & (dice.to(1) ? 0x0FFF'0FFF : 0xFFFF'FFFF);
    else if (dice.to(1))
      word = dice.word();
    else
      word = static_cast<std::uint32_t>(dice.within(1 << dice.to(24)));
  }
  return m;
}

/// Any words in the fields of a job: hardly any of them is possible.
inline Job any_job(Dice& dice) {
  Job j;
  j.mode = static_cast<Mode>(dice.to(3));
  j.bilinear = dice.to(1);
  j.pairs = dice.to(4095);
  j.rows = dice.to(8191);
  j.src_base = dice.word() >> 2;
  j.dst_base = dice.word() >> 2;
  j.src_pitch = dice.to(8191);
  j.dst_pitch = dice.to(8191);
  j.src_width = dice.to(8191);
  j.src_height = dice.to(8191);
  j.grid_log2 = dice.to(7);
  j.pieces = dice.to(255);
  j.piece_log2 = dice.to(31);
  j.radius_limit = dice.word();
  j.centre_x = static_cast<std::int32_t>(dice.word());
  j.centre_y = static_cast<std::int32_t>(dice.word());
  for (auto* form : {&j.a, &j.b, &j.c})
    for (auto& k : *form) k = static_cast<std::int32_t>(dice.word());
  return j;
}

}  // namespace fovea::rtl
