// Rows of bytes by time: where one ends, and how many are listed.
#include <gtest/gtest.h>

#include <vector>

#include "model/bus/core/timeline.h"

namespace fovea::dram {
namespace {

using bus::Timeline;
struct Listed {
  Picoseconds start, end;
  std::uint64_t bytes;
  friend bool operator==(const Listed&, const Listed&) = default;
};
std::vector<Listed> list(const Timeline& t, Picoseconds until) {
  std::vector<Listed> out;
  t.list_until(until, [&](Picoseconds start, Picoseconds end, const Timeline::Row& row) {
    out.push_back({start, end, row.read[2] + row.write[2]});
  });
  return out;
}

TEST(TimelineTest, BytesAtARowsEndBelongToTheNextOne) {
  for (const bool write : {false, true}) {
    Timeline t(100);
    t.add(2, write, 1, 0);
    t.add(2, write, 2, 99);
    t.add(2, write, 4, 100);
    t.add(2, write, 8, 199);
    t.add(2, write, 16, 300);
    const std::vector<Listed> rows = {{0, 100, 3}, {100, 200, 12}, {200, 300, 0}, {300, 400, 16}};
    EXPECT_TRUE(list(t, 400) == rows);
    EXPECT_EQ(list(t, 399).size(), 3u) << "the last is not over";
  }
}

TEST(TimelineTest, NoMoreThanAMillionRowsAreListed) {
  for (const std::uint64_t last : {Timeline::kMaxRows - 1, Timeline::kMaxRows, 3 * Timeline::kMaxRows}) {
    Timeline t(10);
    t.begin(70);
    t.add(2, false, 1, 70);
    t.add(2, false, 2, 70 + last * 10);
    const auto rows = list(t, kNever);
    EXPECT_EQ(rows.size(), Timeline::kMaxRows) << last;
    EXPECT_EQ(rows.back().bytes, last < Timeline::kMaxRows ? 2u : 0u);
  }
}

}  // namespace
}  // namespace fovea::dram
