// Bytes moved by master, in rows of equal simulated time.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/common/masters.h"
#include "model/common/units.h"

namespace fovea::bus {

class Timeline {
 public:
  struct Row {
    std::array<std::uint64_t, kMasterCount> read{}, write{};
  };
  /// What comes after that many rows is in none.
  static constexpr std::size_t kMaxRows = 1'000'000;
  explicit Timeline(Picoseconds interval) : interval_(interval) {}
  /// The first row begins at `start`, in steps of the interval from time 0; nothing was added yet.
  void begin(Picoseconds start) { origin_ = start / interval_ * interval_; }
  /// `at` never decreases, and is not before the first row.
  void add(std::size_t master, bool write, std::uint64_t bytes, Picoseconds at) {
    if (at >= end_ || rows_.empty()) [[unlikely]] {
      const std::uint64_t row = (at - origin_) / interval_;
      if (row >= kMaxRows) return;
      rows_.resize(row + 1);
      end_ = origin_ + rows_.size() * interval_;
    }
    (write ? rows_.back().write : rows_.back().read)[master] += bytes;
  }
  const std::vector<Row>& rows() const { return rows_; }
  Picoseconds interval() const { return interval_; }
  Picoseconds start(std::size_t row) const { return origin_ + row * interval_; }

 private:
  Picoseconds interval_, origin_ = 0, end_ = 0;
  std::vector<Row> rows_;
};

}  // namespace fovea::bus
