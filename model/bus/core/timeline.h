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
    first_ = start / interval_;
  }
  /// `at` never decreases by a row.
  void add(std::size_t master, bool write, std::uint64_t bytes, Picoseconds at) {
    if (at >= end_) [[unlikely]] {
      rows_.emplace_back().number = at / interval_;
      end_ = (rows_.back().number + 1) * interval_;
    }
    (write ? rows_.back().write : rows_.back().read)[master] += bytes;
  }
  /// Rows in which something moved.
  const std::vector<Row>& rows() const { return rows_; }
  /// Calls list(start, end, row) for each row that is over at `until`, also those without bytes
  /// between the first and the last. `all`: a last one that is not over ends at `until`.
  template <class List>
  void list_until(Picoseconds until, List list, bool all = false) const {
    std::uint64_t next = first_;
    for (const Row& r : rows_) {
      for (; next <= r.number; ++next) {
        const Picoseconds start = next * interval_, end = start + interval_;
        const bool over = end <= until;
        if (next - first_ >= kMaxRows || !(over || (all && start < until))) return;
        list(std::max(start, begin_), over ? end : until, next == r.number ? r : Row{});
      }
    }
  }

 private:
  Picoseconds interval_, begin_ = 0, end_ = 0;
  std::uint64_t first_ = 0;
  std::vector<Row> rows_;
};

}  // namespace fovea::bus
