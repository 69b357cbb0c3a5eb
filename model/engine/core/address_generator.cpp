#include "model/engine/core/address_generator.h"

#include <algorithm>

namespace fovea::engine {
namespace {

constexpr unsigned kRadialStages = 6, kProjectStages = 22;
constexpr unsigned kNodeRows = 4;      // kept
constexpr std::size_t kCells = 4;      // of the buffer of cells

}  // namespace

void AddressGenerator::start(const Job& job) {
  clear();
  job_ = job;
  forms_ = job.mode != RemapMode::kTable;
  a_ = a_row_ = job.a[0];
  b_ = b_row_ = job.b[0];
  c_ = c_row_ = job.c[0];
  dst_ = dst_start_ = job.dst_base;
  entries_ = job.mode == RemapMode::kTable ? std::uint64_t{job.pairs} * job.rows : 0;
  loading_ = job.mode == RemapMode::kGrid || job.mode == RemapMode::kRadial;
  loaded_ = job.mode == RemapMode::kProject;
  walking_ = job.mode == RemapMode::kGrid;
  node_rows_ = ((job.rows + job.step() - 1) >> job.grid_log2) + 1;
}

void AddressGenerator::clear() {
  held_ = clip_ = 0;
  stages_ = 0;
  taken_ = 0;
  pairs_.clear();
  positions_.clear();
  cells_.clear();
  forms_ = loading_ = loaded_ = walking_ = v1_ = v2_ = offset_ = took_map_ = false;
  pair_ = row_ = dst_pair_ = dst_row_ = coefficients_ = 0;
  rows_there_ = node_in_ = walk_row_ = walk_node_ = left_in_row_ = 0;
  entries_ = 0;
}

/// Of the modes that load all or some of their map before they use it.
bool AddressGenerator::wants_load() const {
  switch (job_.mode) {
    case RemapMode::kGrid:
      return loading_ && rows_there_ < (walk_row_ >> job_.grid_log2) + kNodeRows;
    case RemapMode::kRadial:
      return loading_;
    case RemapMode::kTable:
    case RemapMode::kProject:
      break;
  }
  return false;
}

/// What is before `clip_`, in the modes that compute positions. @return anything has moved
bool AddressGenerator::position(bool moves, const std::uint32_t* map) {
  bool moved = false;
  switch (job_.mode) {
    case RemapMode::kTable:
      break;
    case RemapMode::kGrid: {
      const bool out = moves && forms_ && offset_;
      if (out) {
        enter(place(job_, grid_position(job_, cell_.left, cell_.right, 2 * at_, form(a_), form(b_))));
        next_form();
      }
      // The walk looks at the buffer of cells before next_offset() takes one of them.
      const bool full = cells_.size() == kCells;
      moved = next_offset(out);
      const std::uint32_t* const word = took_map_ ? map : nullptr;
      moved |= !(v2_ && !first2_ && full) && walk();
      if (word) load(*word);
      break;
    }
    case RemapMode::kRadial:
    case RemapMode::kProject:
      moved = pipelined(moves);
      if (took_map_) load(*map);
      break;
  }
  return moved;
}

/// A pair's position is computed when it enters the pipeline, with what is loaded by then.
bool AddressGenerator::pipelined(bool clip_moves) {
  const unsigned depth = job_.mode == RemapMode::kRadial ? kRadialStages : kProjectStages;
  const std::uint32_t end = 1u << (depth - 1);
  const bool out = stages_ & end;
  if (out && !clip_moves) return false;
  const bool in = forms_ && loaded_;
  const bool moved = in || stages_;
  if (out) {
    enter(positions_.front());
    positions_.pop();
  }
  stages_ = ((stages_ << 1) | in) & (2 * end - 1);
  if (in) {
    positions_.push(place(job_, job_.mode == RemapMode::kRadial
                                    ? radial_position(job_, pieces_, form(a_), form(b_), form(c_))
                                    : projected_position(form(a_), form(b_), form(c_))));
    next_form();
  }
  return moved;
}

void AddressGenerator::next_form() {
  if (++pair_ < job_.pairs) {
    a_ += job_.a[1];
    b_ += job_.b[1];
    c_ += job_.c[1];
    return;
  }
  pair_ = 0;
  forms_ = ++row_ < job_.rows;
  a_ = a_row_ += job_.a[2];
  b_ = b_row_ += job_.b[2];
  c_ = c_row_ += job_.c[2];
}

void AddressGenerator::next_row(Pair& last) {
  dst_pair_ = 0;
  dst_ = dst_start_ += job_.dst_pitch;
  last.last = ++dst_row_ == job_.rows;
}

void AddressGenerator::load(std::uint32_t word) {
  if (job_.mode == RemapMode::kRadial) {
    Piece& piece = pieces_[coefficients_ / 3];
    (coefficients_ % 3 == 0 ? piece.c0 : coefficients_ % 3 == 1 ? piece.c1 : piece.c2) = coefficient(word);
    if (++coefficients_ == 3 * job_.pieces) {
      loading_ = false;
      loaded_ = true;
    }
    return;
  }
  nodes_[rows_there_ % kNodeRows][node_in_] = word;
  if (++node_in_ <= job_.cells()) return;
  node_in_ = 0;
  loading_ = ++rows_there_ < node_rows_;
}

/// The next pair's offset, when the one before was taken or there was none.
bool AddressGenerator::next_offset(bool taken) {
  if (offset_ && !taken) return false;
  if (offset_ && ++at_ < in_cell_) return true;
  offset_ = !cells_.empty();
  if (!offset_) return taken;
  cell_ = cells_.front();
  cells_.pop();
  if (left_in_row_ == 0) left_in_row_ = job_.pairs;
  at_ = 0;
  in_cell_ = std::min(left_in_row_, job_.step() / 2);
  left_in_row_ -= in_cell_;
  return true;
}

/// Two stages: the nodes of an edge are read; the edge is there. An edge that is not the row's first closes a
/// cell.
bool AddressGenerator::walk() {
  const std::uint32_t cell_row = walk_row_ >> job_.grid_log2;
  const bool issue = walking_ && rows_there_ >= cell_row + 2;
  const bool moved = issue || v1_ || v2_;
  if (v2_) {
    if (!first2_) cells_.push({left_, edge2_});
    left_ = edge2_;
  }
  if (v1_) {
    first2_ = first1_;
    edge2_ = edge1_;
  }
  v2_ = v1_;
  v1_ = issue;
  if (!issue) return moved;
  first1_ = walk_node_ == 0;
  edge1_ = grid_edge(nodes_[cell_row % kNodeRows][walk_node_], nodes_[(cell_row + 1) % kNodeRows][walk_node_],
                     job_.step(), walk_row_ & (job_.step() - 1));
  if (++walk_node_ <= job_.cells()) return moved;
  walk_node_ = 0;
  walking_ = ++walk_row_ < job_.rows;
  return moved;
}

}  // namespace fovea::engine
