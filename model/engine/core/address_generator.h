// The address generator of the remap engine, clock by clock: where each pair comes from, and in which clock that is
// known. Pipelines move as a whole, as in rtl/remap; only what is valid in them is kept as bits.
#pragma once
#include <array>
#include <cstdint>

#include "model/engine/core/remap_job.h"
#include "model/engine/core/ring.h"

namespace fovea::engine {

/// A pair on its way through the engine.
struct Pair : Place {
  bool last = false;      ///< of the job
  std::uint32_t dst = 0;  ///< word address
};
static_assert(sizeof(Pair) == 16, "many are moved");

class AddressGenerator {
 public:
  /// The clock in which the unit's start signal is high.
  void start(const Job& job);
  void clear();
  /// The oldest pair that is not taken, if one can be in this clock.
  const Pair* front() const { return held_ > 0 ? &pairs_.at(taken_) : nullptr; }
  /// The oldest pair that was taken; it is kept until forget().
  const Pair& oldest() const { return pairs_.front(); }
  void forget() {
    pairs_.pop();
    --taken_;
  }
  /// A word of the map is taken in this clock if there is one. Call before clock().
  bool wants_map() const { return job_.mode == RemapMode::kTable ? entries_ > 0 && clip_moves() : wants_load(); }
  /// One clock, from the last stage to the first, so that each sees what its neighbour had before.
  /// @param taken front() goes; @param map the word that is there; null: none
  /// @return anything has moved
  bool clock(bool taken, const std::uint32_t* map) {
    const bool moves = clip_moves(), table = job_.mode == RemapMode::kTable;
    took_map_ = map && (table ? entries_ > 0 && moves : wants_load());
    const bool moved = taken || took_map_ || (moves && clip_);
    if (moves) {
      held_ += (clip_ & kClipEnd) != 0;
      clip_ = (clip_ << 1) & (2 * kClipEnd - 1);
    }
    if (taken) {
      ++taken_;
      --held_;
    }
    if (!table) return position(moves, map) || moved;
    if (took_map_) {
      enter(*map);
      --entries_;
    }
    return moved;
  }
  /// Whether the last clock() took the word of the map.
  bool took_map() const { return took_map_; }

 private:
  struct Cell {
    Edge left, right;
  };
  static constexpr unsigned kBuffer = 2, kClipEnd = 1u << 2;
  bool clip_moves() const { return held_ != kBuffer || !(clip_ & kClipEnd); }
  bool wants_load() const;
  bool position(bool clip_moves, const std::uint32_t* map);
  void load(std::uint32_t word);
  bool walk();
  bool next_offset(bool taken);
  bool pipelined(bool clip_moves);
  void next_form();
  void enter(const Place& place) { static_cast<Place&>(enter()) = place; }
  void enter(std::uint32_t entry) {
    Pair& pair = enter();
    const std::uint32_t word = entry / 4;
    if (entry % 4 == 0 && word < job_.end()) [[likely]]
      pair.src = (job_.src_base + word) & 0x3FFF'FFFF;
    else
      static_cast<Place&>(pair) = place(job_, entry);
  }
  /// A pair without its place.
  Pair& enter() {
    clip_ |= 1;
    Pair& pair = pairs_.push();
    pair = {};
    pair.dst = dst_++ & 0x3FFF'FFFF;
    if (++dst_pair_ == job_.pairs) next_row(pair);
    return pair;
  }
  void next_row(Pair& last);

  Job job_;
  unsigned held_ = 0;          // pairs in the buffer at the end, 2 at most
  unsigned clip_ = 0;          // valid bits of the stages that make addresses of positions, 3 of them
  std::uint32_t stages_ = 0;   // valid bits of the radial function's or the division's pipeline
  Ring<Pair, 64> pairs_;       // on their way, in order: those that were taken, in the buffer, in the stages
  std::size_t taken_ = 0;
  Ring<Place, 64> positions_;  // in `stages_`
  bool took_map_ = false;

  // The forms: where the walk over the pairs is.
  bool forms_ = false;         // a value is there
  std::uint32_t pair_ = 0, row_ = 0;
  std::int64_t a_ = 0, b_ = 0, c_ = 0, a_row_ = 0, b_row_ = 0, c_row_ = 0;
  // What has entered `clip_`.
  std::uint32_t dst_pair_ = 0, dst_row_ = 0, dst_ = 0, dst_start_ = 0;
  std::uint64_t entries_ = 0;  // of a table, to come

  // Radial function.
  std::array<Piece, kMostPieces> pieces_{};
  std::uint32_t coefficients_ = 0;  // loaded
  bool loading_ = false, loaded_ = false;

  // Grid: nodes of four rows, the walk over edges, cells.
  std::array<std::array<std::uint32_t, kMostNodes>, 4> nodes_{};
  std::uint32_t rows_there_ = 0, node_in_ = 0, node_rows_ = 0;
  bool walking_ = false;
  std::uint32_t walk_row_ = 0, walk_node_ = 0;
  bool v1_ = false, v2_ = false, first1_ = false, first2_ = false;
  Edge edge1_, edge2_, left_;
  Ring<Cell, 8> cells_;
  bool offset_ = false;        // of a pair is there
  Cell cell_;
  std::uint32_t at_ = 0, in_cell_ = 0, left_in_row_ = 0;  // pair of the cell, pairs of it, of the row behind it
};

}  // namespace fovea::engine
