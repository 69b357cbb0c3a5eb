// A job of the remap engine, and the arithmetic of its positions: rtl/README.md, section "Address generator".
#pragma once
#include <array>
#include <cstdint>

namespace fovea::engine {

enum class RemapMode : std::uint8_t { kTable, kGrid, kRadial, kProject };

inline constexpr unsigned kMostNodes = 256, kMostPieces = 128;

/// Widths are those of the registers; whether they make sense is possible()'s question.
struct Job {
  RemapMode mode = RemapMode::kTable;
  bool bilinear = false;
  std::uint32_t grid_log2 = 0, pieces = 0, piece_log2 = 0;
  std::uint32_t pairs = 0, rows = 0;              ///< of the result
  std::uint32_t src_base = 0, src_pitch = 0;      ///< words
  std::uint32_t src_width = 0, src_height = 0;    ///< pixels, rows
  std::uint32_t dst_base = 0, dst_pitch = 0;      ///< words
  std::uint32_t map_base = 0, map_words = 0;      ///< byte address, words
  std::uint32_t border = 0, radius_limit = 0;
  std::int32_t centre_x = 0, centre_y = 0;        ///< pixels, Q16
  std::array<std::int32_t, 3> a{}, b{}, c{};      ///< first value, step of a pair, step of a row

  std::uint32_t step() const { return 1u << grid_log2; }  ///< of the grid, pixels
  std::uint32_t cells() const { return (2 * pairs + step() - 1) >> grid_log2; }  ///< in a row of the grid
  std::uint32_t end() const { return src_height * src_pitch; }  ///< of the source, words behind its base
  /// False: the engine refuses the job.
  bool possible() const;
};

/// Where a pair comes from.
struct Place {
  std::uint32_t src = 0;  ///< word address
  bool border = false, bad = false, edge_x = false, edge_y = false, odd = false;
  std::uint8_t frac_x = 0, frac_y = 0;  ///< Q8
};

/// Pixels, Q16, and whether it is a position at all.
struct Position {
  std::int64_t x = 0, y = 0;
  bool exists = false;
};

/// A value of a linear form wraps to 36 bits.
constexpr std::int64_t form(std::int64_t v) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(v) << 28) >> 28;
}

/// One piece of the radial function, Q20.
struct Piece {
  std::int32_t c0 = 0, c1 = 0, c2 = 0;
};
/// The low 26 bits of a word of the map.
constexpr std::int32_t coefficient(std::uint32_t word) { return static_cast<std::int32_t>(word << 6) >> 6; }

Position radial_position(const Job& job, const std::array<Piece, kMostPieces>& pieces, std::int64_t a,
                         std::int64_t b, std::int64_t c);
Position projected_position(std::int64_t a, std::int64_t b, std::int64_t c);
/// Offsets of one edge of a cell: x and y of the nodes above and below it, weighted for an output row.
struct Edge {
  std::int32_t x = 0, y = 0;
};
Edge grid_edge(std::uint32_t above, std::uint32_t below, std::uint32_t step, std::uint32_t row_in_cell);
/// @param column pixels behind the left edge
Position grid_position(const Job& job, Edge left, Edge right, std::uint32_t column, std::int64_t a,
                       std::int64_t b);
Place place(const Job& job, const Position& position);
Place place(const Job& job, std::uint32_t entry);

/// The pair's word out of those at, right of, below, and right below its source word.
std::uint32_t blend(const Place& place, const std::array<std::uint32_t, 4>& words);

}  // namespace fovea::engine
