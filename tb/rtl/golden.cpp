#include "tb/rtl/golden.h"

#include <algorithm>
#include <array>
#include <deque>
#include <optional>
#include <set>

namespace fovea::rtl {
namespace {

using Wide = __int128;

std::int64_t floor_shift(std::int64_t value, unsigned bits) { return value >> bits; }

bool fits(std::int64_t value, unsigned bits) {
  const std::int64_t limit = std::int64_t{1} << (bits - 1);
  return value >= -limit && value < limit;
}

std::int64_t wrap(std::int64_t value, unsigned bits) {
  const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
  const std::uint64_t low = static_cast<std::uint64_t>(value) & mask;
  return low >> (bits - 1) ? static_cast<std::int64_t>(low) - (std::int64_t{1} << bits)
                           : static_cast<std::int64_t>(low);
}

std::int64_t form(const std::int32_t (&k)[3], unsigned i, unsigned j) {
  return wrap(k[0] + std::int64_t{k[1]} * i + std::int64_t{k[2]} * j, 36);
}

/// A source position in pixels, Q16.
struct Position {
  std::int64_t x, y;
};

Position node_offset(std::uint32_t node) {
  return {static_cast<std::int16_t>(node & 0xFFFF), static_cast<std::int16_t>(node >> 16)};
}

std::optional<Position> by_grid(const Job& job, std::span<const std::uint32_t> map, unsigned i,
                                unsigned j) {
  const unsigned step = 1u << job.grid_log2, nodes = grid_nodes(job);
  const unsigned u = 2 * i, g = u / step, h = j / step;
  const std::int64_t p = u % step, q = j % step, s = step;
  const auto at = [&](unsigned column, unsigned row) {
    return node_offset(map[row * nodes + column]);
  };
  const Position n00 = at(g, h), n10 = at(g + 1, h), n01 = at(g, h + 1), n11 = at(g + 1, h + 1);
  const auto blend = [&](std::int64_t a, std::int64_t b, std::int64_t c, std::int64_t d) {
    return ((s - p) * (s - q) * a + p * (s - q) * b + (s - p) * q * c + p * q * d) *
           (std::int64_t{1} << (12 - 2 * job.grid_log2));
  };
  return Position{form(job.a, i, j) + blend(n00.x, n10.x, n01.x, n11.x),
                  form(job.b, i, j) + blend(n00.y, n10.y, n01.y, n11.y)};
}

std::optional<Position> by_radius(const Job& job, std::span<const std::uint32_t> map, unsigned i,
                                  unsigned j) {
  const std::int64_t x = floor_shift(form(job.a, i, j), 8), y = floor_shift(form(job.b, i, j), 8),
                     z = floor_shift(form(job.c, i, j), 8);
  if (!fits(x, 20) || !fits(y, 20) || !fits(z, 20)) return {};
  const std::int64_t s = x * x + y * y;
  const std::int64_t n = s >> (16 + job.piece_log2), t = (s >> job.piece_log2) & 0xFFFF;
  if (n >= job.pieces || (s >> 8) > job.radius_limit) return {};
  const auto coefficient = [&](unsigned k) {
    return wrap(map[static_cast<std::size_t>(n) * 3 + k] & 0x3FFFFFF, 26);
  };
  const std::int64_t inner = coefficient(1) + floor_shift(coefficient(2) * t, 16);
  const std::int64_t gain = coefficient(0) + floor_shift(inner * t, 16);
  return Position{job.centre_x + floor_shift(gain * x, 12),
                  job.centre_y + floor_shift(gain * z, 12)};
}

std::optional<Position> by_division(const Job& job, unsigned i, unsigned j) {
  const std::int64_t a = form(job.a, i, j), b = form(job.b, i, j), c = form(job.c, i, j);
  if (c <= 0 || c >= 1 << 24) return {};
  const auto quotient = [&](std::int64_t n) -> std::optional<std::int64_t> {
    const std::int64_t size = n < 0 ? -n : n;
    if (size >= c * 8192) return {};
    const std::int64_t q = static_cast<std::int64_t>(Wide{size} * 256 / c) * 256;
    return n < 0 ? -q : q;
  };
  const auto x = quotient(a), y = quotient(b);
  if (!x || !y) return {};
  return Position{*x, *y};
}

void place_position(const Job& job, std::optional<Position> p, Beat& beat) {
  beat.border = true;
  if (!p || !fits(p->x, 30) || !fits(p->y, 30)) return;
  const std::int64_t half = job.bilinear ? 0 : 0x8000;
  const std::int64_t column = floor_shift(p->x + half, 16), row = floor_shift(p->y + half, 16);
  if (column < 0 || column >= job.src_width || row < 0 || row >= job.src_height) return;
  beat.border = false;
  beat.edge_x = column / 2 == job.src_width / 2 - 1;
  beat.edge_y = row == job.src_height - 1;
  if (job.bilinear) {
    beat.odd = column % 2 != 0;
    beat.frac_x = (p->x >> 8) & 0xFF;
    beat.frac_y = (p->y >> 8) & 0xFF;
  }
  beat.src = (job.src_base + static_cast<std::uint32_t>(row) * job.src_pitch +
              static_cast<std::uint32_t>(column / 2)) &
             0x3FFFFFFF;
}

void place_entry(const Job& job, std::uint32_t entry, Beat& beat) {
  const std::uint32_t end = job.src_height * job.src_pitch * 4;
  beat.border = entry % 4 != 0 || entry >= end;
  beat.bad = beat.border && entry != end;
  if (!beat.border) beat.src = (job.src_base + entry / 4) & 0x3FFFFFFF;
}

/// Four pixels in a row of two neighbouring words, and the colour differences of both.
struct Quad {
  std::array<unsigned, 4> luma;
  std::array<unsigned, 2> blue, red;
};

Quad quad(std::uint32_t left, std::uint32_t right, bool no_right) {
  Quad q;
  q.luma = {left >> 8 & 255, left >> 24, right >> 8 & 255, right >> 24};
  q.blue = {left & 255, right & 255};
  q.red = {left >> 16 & 255, right >> 16 & 255};
  if (no_right) {
    q.luma[2] = q.luma[3] = q.luma[1];
    q.blue[1] = q.blue[0];
    q.red[1] = q.red[0];
  }
  return q;
}

std::uint32_t blend(const Beat& b, const Quad& top, const Quad& bottom) {
  const auto mix = [&](unsigned a, unsigned right, unsigned c, unsigned below_right,
                       unsigned fraction) {
    const unsigned upper = a * (256 - fraction) + right * fraction;
    const unsigned lower = c * (256 - fraction) + below_right * fraction;
    return (upper * (256 - b.frac_y) + lower * b.frac_y + 32768) / 65536;
  };
  const unsigned n = b.odd, half = (256 * n + b.frac_x) / 2;
  const unsigned y0 =
      mix(top.luma[n], top.luma[n + 1], bottom.luma[n], bottom.luma[n + 1], b.frac_x);
  const unsigned y1 = mix(top.luma[n + 1], top.luma[std::min(n + 2, 3u)], bottom.luma[n + 1],
                          bottom.luma[std::min(n + 2, 3u)], b.frac_x);
  return mix(top.blue[0], top.blue[1], bottom.blue[0], bottom.blue[1], half) | y0 << 8 |
         mix(top.red[0], top.red[1], bottom.red[0], bottom.red[1], half) << 16 | y1 << 24;
}

unsigned ceil_div(unsigned a, unsigned b) { return (a + b - 1) / b; }

}  // namespace

unsigned grid_nodes(const Job& job) { return ceil_div(2 * job.pairs, 1u << job.grid_log2) + 1; }
unsigned grid_rows(const Job& job) { return ceil_div(job.rows, 1u << job.grid_log2) + 1; }

bool possible(const Job& job) {
  const auto between = [](unsigned value, unsigned low, unsigned high) {
    return value >= low && value <= high;
  };
  if (!between(job.pairs, 1, 2048) || !between(job.rows, 1, 4096)) return false;
  if (!between(job.src_width, 1, 4096) || job.src_width % 2 || !between(job.src_height, 1, 4096))
    return false;
  if (job.src_pitch < job.src_width / 2) return false;
  if (job.mode == Mode::kGrid) return between(job.grid_log2, 2, 6) && grid_nodes(job) <= 256;
  if (job.mode == Mode::kRadial) return between(job.pieces, 1, 128) && job.piece_log2 <= 23;
  return true;
}

std::size_t map_words(const Job& job) {
  switch (job.mode) {
    case Mode::kTable:
      return std::size_t{job.pairs} * job.rows;
    case Mode::kGrid:
      return std::size_t{grid_nodes(job)} * grid_rows(job);
    case Mode::kRadial:
      return std::size_t{job.pieces} * 3;
    case Mode::kProject:
      break;
  }
  return 0;
}

std::vector<Beat> addresses(const Job& job, std::span<const std::uint32_t> map) {
  std::vector<Beat> beats;
  beats.reserve(std::size_t{job.pairs} * job.rows);
  for (unsigned j = 0; j < job.rows; ++j)
    for (unsigned i = 0; i < job.pairs; ++i) {
      Beat beat;
      beat.dst = (job.dst_base + j * job.dst_pitch + i) & 0x3FFFFFFF;
      switch (job.mode) {
        case Mode::kTable:
          place_entry(job, map[std::size_t{j} * job.pairs + i], beat);
          break;
        case Mode::kGrid:
          place_position(job, by_grid(job, map, i, j), beat);
          break;
        case Mode::kRadial:
          place_position(job, by_radius(job, map, i, j), beat);
          break;
        case Mode::kProject:
          place_position(job, by_division(job, i, j), beat);
          break;
      }
      beats.push_back(beat);
    }
  if (!beats.empty()) beats.back().last = true;
  return beats;
}

std::size_t lines_read(std::span<const Beat> beats, unsigned log_lines) {
  const unsigned ways = log_lines < 2 ? 1u << log_lines : 4;
  const unsigned log_sets = log_lines < 2 ? 0 : log_lines - 2;
  const auto bits = [&](std::uint32_t line, unsigned from) { return line >> from & ((1u << log_sets) - 1); };
  std::vector<std::deque<std::uint32_t>> sets(std::size_t{1} << log_sets);  // lines, the one that came first first
  std::size_t read = 0;
  for (const Beat& b : beats) {
    if (b.border) continue;
    const std::uint32_t line = b.src / 8;
    auto& set = sets[bits(line, 0) ^ bits(line, log_sets)];
    if (std::ranges::find(set, line) != set.end()) continue;
    if (set.size() == ways) set.pop_front();
    set.push_back(line);
    ++read;
  }
  return read;
}

std::size_t lines_needed(std::span<const Beat> beats) {
  std::set<std::uint32_t> lines;
  for (const Beat& b : beats)
    if (!b.border) lines.insert(b.src / 8);
  return lines.size();
}

std::vector<std::uint32_t> picture(const Job& job, std::span<const std::uint32_t> map,
                                   std::uint32_t border,
                                   const std::function<std::uint32_t(std::uint32_t)>& word) {
  std::vector<std::uint32_t> result;
  for (const Beat& b : addresses(job, map)) {
    if (b.border) {
      result.push_back(border);
    } else if (!job.bilinear) {
      result.push_back(word(b.src));
    } else {
      const std::uint32_t below = b.src + (b.edge_y ? 0 : job.src_pitch);
      const auto row = [&](std::uint32_t at) {
        return quad(word(at), b.edge_x ? 0 : word(at + 1), b.edge_x);
      };
      result.push_back(blend(b, row(b.src), row(below)));
    }
  }
  return result;
}

}  // namespace fovea::rtl
