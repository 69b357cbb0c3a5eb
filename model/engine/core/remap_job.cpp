#include "model/engine/core/remap_job.h"

namespace fovea::engine {
namespace {

constexpr bool fits(std::int64_t v, unsigned bits) {
  const std::int64_t limit = std::int64_t{1} << (bits - 1);
  return v >= -limit && v < limit;
}
constexpr unsigned kPositionBits = 30;

Position checked(std::int64_t x, std::int64_t y) {
  return {x, y, fits(x, kPositionBits) && fits(y, kPositionBits)};
}

}  // namespace

bool Job::possible() const {
  const bool sizes = pairs >= 1 && pairs <= 2048 && rows >= 1 && rows <= 4096;
  const bool source = src_width >= 2 && src_width <= 4096 && src_width % 2 == 0 && src_height >= 1 &&
                      src_height <= 4096 && src_pitch >= src_width / 2;
  if (!sizes || !source) return false;
  switch (mode) {
    case RemapMode::kGrid:
      return grid_log2 >= 2 && grid_log2 <= 6 && cells() + 1 <= kMostNodes;
    case RemapMode::kRadial:
      return pieces >= 1 && pieces <= kMostPieces && piece_log2 <= 23;
    case RemapMode::kTable:
    case RemapMode::kProject:
      break;
  }
  return true;
}

Position radial_position(const Job& job, const std::array<Piece, kMostPieces>& pieces, std::int64_t a,
                         std::int64_t b, std::int64_t c) {
  const std::int64_t x = a >> 8, y = b >> 8, z = c >> 8;
  if (!fits(x, 20) || !fits(y, 20) || !fits(z, 20)) return {};
  const auto s = static_cast<std::uint64_t>(x * x + y * y);
  const std::uint64_t scaled = s >> job.piece_log2, n = scaled >> 16;
  if (n >= job.pieces || s >> 8 > job.radius_limit) return {};
  const auto t = static_cast<std::int64_t>(scaled & 0xFFFF);
  const Piece& p = pieces[n];
  const std::int64_t inner = p.c1 + (p.c2 * t >> 16), gain = p.c0 + (inner * t >> 16);
  return checked(job.centre_x + (gain * x >> 12), job.centre_y + (gain * z >> 12));
}

Position projected_position(std::int64_t a, std::int64_t b, std::int64_t c) {
  if (c <= 0 || c >= std::int64_t{1} << 24) return {};
  const std::int64_t size_a = a < 0 ? -a : a, size_b = b < 0 ? -b : b;
  if (size_a >= c << 13 || size_b >= c << 13) return {};
  const std::int64_t x = (size_a << 8) / c << 8, y = (size_b << 8) / c << 8;
  return {a < 0 ? -x : x, b < 0 ? -y : y, true};
}

Edge grid_edge(std::uint32_t above, std::uint32_t below, std::uint32_t step, std::uint32_t row_in_cell) {
  const auto low = [](std::uint32_t node) { return static_cast<std::int16_t>(node); };
  const auto high = [](std::uint32_t node) { return static_cast<std::int16_t>(node >> 16); };
  const auto q = static_cast<std::int32_t>(row_in_cell), r = static_cast<std::int32_t>(step) - q;
  return {r * low(above) + q * low(below), r * high(above) + q * high(below)};
}

Position grid_position(const Job& job, Edge left, Edge right, std::uint32_t column, std::int64_t a,
                       std::int64_t b) {
  const std::int64_t p = column, rest = job.step() - p;
  const unsigned up = 12 - 2 * job.grid_log2;
  const std::int64_t x = (rest * left.x + p * right.x) << up, y = (rest * left.y + p * right.y) << up;
  return checked(a + x, b + y);
}

Place place(const Job& job, const Position& position) {
  Place out;
  const std::int64_t half = job.bilinear ? 0 : 0x8000;
  const std::int64_t x = position.x + half, y = position.y + half;
  const std::int64_t column = x >> 16, row = y >> 16;
  if (!position.exists || column < 0 || column >= job.src_width || row < 0 || row >= job.src_height) {
    out.border = true;
    return out;
  }
  const auto col = static_cast<std::uint32_t>(column), line = static_cast<std::uint32_t>(row);
  out.src = (job.src_base + line * job.src_pitch + col / 2) & 0x3FFF'FFFF;
  out.edge_x = col / 2 + 1 == job.src_width / 2;
  out.edge_y = line + 1 == job.src_height;
  if (job.bilinear) {
    out.odd = col & 1;
    out.frac_x = static_cast<std::uint8_t>(x >> 8);
    out.frac_y = static_cast<std::uint8_t>(y >> 8);
  }
  return out;
}

Place place(const Job& job, std::uint32_t entry) {
  Place out;
  const std::uint32_t word = entry / 4;
  out.border = entry % 4 != 0 || word >= job.end();
  out.bad = out.border && (entry % 4 != 0 || word != job.end());
  if (!out.border) out.src = (job.src_base + word) & 0x3FFF'FFFF;
  return out;
}

std::uint32_t blend(const Place& p, const std::array<std::uint32_t, 4>& words) {
  // Bytes of a word: Cb, Y0, Cr, Y1. Beyond the last word of a row its last pixel is repeated.
  const auto byte = [](std::uint32_t w, unsigned n) { return w >> 8 * n & 0xFF; };
  std::array<std::array<std::uint32_t, 2>, 2> w{{{words[0], words[1]}, {words[2], words[3]}}};
  if (p.edge_x)
    for (auto& row : w) {
      const std::uint32_t last = byte(row[0], 3);
      row[1] = (row[0] & 0x00FF'00FF) | last << 8 | last << 24;
    }
  const auto mix = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d,
                       std::uint32_t fx) {
    const std::uint32_t fy = p.frac_y;
    const std::uint32_t top = (256 - fx) * a + fx * b, bottom = (256 - fx) * c + fx * d;
    return ((256 - fy) * top + fy * bottom + 0x8000) >> 16;
  };
  /// Luma `n` pixels right of the word's first.
  const auto luma = [&](unsigned row, unsigned n) { return byte(w[row][n / 2], n % 2 ? 3 : 1); };
  const std::uint32_t colour = (256u * p.odd + p.frac_x) / 2;
  const auto at = [&](unsigned n) {
    return mix(luma(0, n), luma(0, n + 1), luma(1, n), luma(1, n + 1), p.frac_x);
  };
  const auto chroma = [&](unsigned n) {
    return mix(byte(w[0][0], n), byte(w[0][1], n), byte(w[1][0], n), byte(w[1][1], n), colour);
  };
  return chroma(0) | at(p.odd) << 8 | chroma(2) << 16 | at(p.odd + 1u) << 24;
}

}  // namespace fovea::engine
