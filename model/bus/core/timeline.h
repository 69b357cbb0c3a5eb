// Bytes moved by master, in rows of equal simulated time.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "model/common/masters.h"
#include "model/common/units.h"

namespace fovea::bus {

class Timeline {
 public:
  struct Row {
    std::uint64_t number = 0;  // intervals since time 0
    std::array<std::uint64_t, kMasterCount> read{}, write{};
  };
  /// As many rows are listed at most.
  static constexpr std::uint64_t kMaxRows = 1'000'000;

  explicit Timeline(Picoseconds interval) : interval_(interval) {}
  /// The first row listed begins at `start`; nothing comes before.
  void begin(Picoseconds start) {
    begin_ = start;
    first_ = next_ = start / interval_;
  }
  /// `at` never decreases by a row.
  void add(std::size_t master, bool write, std::uint64_t bytes, Picoseconds at) {
    if (at >= end_) [[unlikely]] {
      rows_.emplace_back().number = at / interval_;
      end_ = (rows_.back().number + 1) * interval_;
    }
    (write ? rows_.back().write : rows_.back().read)[master] += bytes;
  }
  /// Rows in which something moved, but for those that were taken.
  const std::vector<Row>& rows() const { return rows_; }
  /// Calls list(start, end, row) for each row that is over at `until`, also those without bytes
  /// between the first and the last. `all`: a last one that is not over ends at `until`. Rows that
  /// were taken before are left out.
  template <class List>
  void list_until(Picoseconds until, List list, bool all = false) const {
    std::uint64_t next = next_;
    for (const Row& r : rows_)
      if (!list_to(r, next, until, all, list)) return;
  }
  /// The same for rows that cannot change any more and are over at `until`, which are then forgotten:
  /// a long run keeps few rows.
  template <class List>
  void take_until(Picoseconds until, List list) {
    std::size_t n = 0;
    // Bytes are added to the last row only.
    for (; n + 1 < rows_.size() && (rows_[n].number + 1) * interval_ <= until; ++n)
      list_to(rows_[n], next_, until, false, list);
    rows_.erase(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(n));
  }

 private:
  /// Lists from row number `next` to `r`. False when that is the end of the list.
  template <class List>
  bool list_to(const Row& r, std::uint64_t& next, Picoseconds until, bool all, List& list) const {
    for (; next <= r.number; ++next) {
      const Picoseconds start = next * interval_, end = start + interval_;
      const bool over = end <= until;
      if (next - first_ >= kMaxRows || !(over || (all && start < until))) return false;
      list(std::max(start, begin_), over ? end : until, next == r.number ? r : Row{});
    }
    return true;
  }

  Picoseconds interval_, begin_ = 0, end_ = 0;
  std::uint64_t first_ = 0;  // number of the first row of all
  std::uint64_t next_ = 0;   // number of the first row that was not taken
  std::vector<Row> rows_;
};

}  // namespace fovea::bus
