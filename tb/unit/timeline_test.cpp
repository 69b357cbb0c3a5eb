// model/bus/core/timeline.h: rows that are taken early equal those that are listed at the end.
#include "model/bus/core/timeline.h"

#include <gtest/gtest.h>

#include <random>
#include <tuple>

namespace fovea::bus {
namespace {

using Listed = std::vector<std::tuple<Picoseconds, Picoseconds, std::uint64_t>>;

auto into(Listed& out) {
  return [&out](Picoseconds start, Picoseconds end, const Timeline::Row& row) {
    out.emplace_back(start, end, row.read[0] + 1000 * row.write[1]);
  };
}

TEST(TimelineTest, ARowCountsTheBytesFromItsStartToBeforeItsEnd) {
  Timeline t(100);
  t.add(0, false, 1, 0);
  t.add(0, false, 2, 99);
  t.add(1, true, 4, 100);
  t.add(0, false, 8, 350);
  Listed rows;
  t.list_until(400, into(rows));
  EXPECT_EQ(rows, (Listed{{0, 100, 3}, {100, 200, 4000}, {200, 300, 0}, {300, 400, 8}}));
  rows.clear();
  t.list_until(399, into(rows));
  EXPECT_EQ(rows.size(), 3u);
}

TEST(TimelineTest, ARowIsTakenAtItsEndUnlessItIsTheLast) {
  for (const Picoseconds until : {99u, 100u, 200u}) {
    Timeline t(100);
    t.add(0, false, 1, 0);
    t.add(0, false, 2, 100);
    Listed rows;
    t.take_until(until, into(rows));
    EXPECT_EQ(rows, until < 100 ? Listed{} : (Listed{{0, 100, 1}})) << until;
    EXPECT_EQ(t.rows().size(), until < 100 ? 2u : 1u) << until;
  }
}

TEST(TimelineTest, TakenRowsAndTheRestAreTheWholeList) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    Timeline all(100), taken(100);
    const Picoseconds begin = random() % 1000;
    if (round % 2) {
      all.begin(begin);
      taken.begin(begin);
    }
    Listed parts;
    Picoseconds now = round % 2 ? begin : 0;
    std::size_t most = 0;
    for (int i = 0; i < 300; ++i) {
      now += random() % (i % 10 == 0 ? 700 : 60);
      const std::size_t master = random() % 2;
      all.add(master, master == 1, 1 + i, now);
      taken.add(master, master == 1, 1 + i, now);
      if (i % 7 == 0) taken.take_until(now - std::min<Picoseconds>(now, random() % 300), into(parts));
      most = std::max(most, taken.rows().size());
    }
    const Picoseconds end = now + random() % 200;
    for (const bool also_open : {false, true}) {
      Listed whole, rest = parts;
      all.list_until(end, into(whole), also_open);
      taken.list_until(end, into(rest), also_open);
      EXPECT_EQ(rest, whole);
    }
    EXPECT_LT(most, 20u) << "of " << all.rows().size();
  }
}

}  // namespace
}  // namespace fovea::bus
