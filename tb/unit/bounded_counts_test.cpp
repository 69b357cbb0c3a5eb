// model/common/bounded_counts.h: memory is bounded, everything is counted, the order does not
// matter.
#include "model/common/bounded_counts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <tuple>

#include "model/common/check.h"

namespace fovea {
namespace {

using Show = BoundedCounts::Show;

std::string hole(unsigned address) {
  char text[64];
  std::snprintf(text, sizeof text, "no register at 0x%08x", address);
  return text;
}
std::uint64_t sum(const BoundedCounts& counts) {
  std::uint64_t n = 0;
  for (const auto& line : counts.list()) n += line.count;
  return n;
}

TEST(BoundedCountsTest, NumbersAreExamplesAndNamesAreKinds) {
  EXPECT_EQ(BoundedCounts::kind_of("read at 0x01C40938 by arm_d, 16 bytes"),
            "read at # by arm_d, # bytes");
  EXPECT_EQ(BoundedCounts::kind_of("TIM12 of TIMER0: 13 at 243 MHz, 4x3, -7.25 s"),
            "TIM12 of TIMER0: # at # MHz, 4x3, -#.# s");
  EXPECT_EQ(BoundedCounts::kind_of("0x"), "0x");
  EXPECT_EQ(BoundedCounts::kind_of("0x1G 12"), "0x1G #");
  EXPECT_EQ(BoundedCounts::kind_of(""), "");
  EXPECT_EQ(BoundedCounts::kind_of(std::string_view("x12y").substr(1, 2)), "#") << "of a part";
}

TEST(BoundedCountsTest, TheNinthExampleOfAKindIsCountedOnly) {
  BoundedCounts counts;
  for (unsigned n = 0; n < 8; ++n) {
    EXPECT_EQ(counts.add(0, hole(4 * n)), Show::kText);
    EXPECT_EQ(counts.add(0, hole(4 * n)), Show::kNothing);
  }
  EXPECT_EQ(counts.list().size(), 8u);
  EXPECT_EQ(counts.add(0, hole(100)), Show::kLastOfKind);
  EXPECT_EQ(counts.add(0, hole(104)), Show::kNothing);
  EXPECT_EQ(counts.add(0, hole(2)), Show::kNothing) << "kept in place of 0x1c, but enough was shown";
  const auto lines = counts.list();
  ASSERT_EQ(lines.size(), 9u);
  EXPECT_EQ(lines[1].text, hole(2));
  EXPECT_EQ(lines[1].count, 1u);
  EXPECT_EQ(lines[7].text, hole(24));
  EXPECT_EQ(lines[8].text, "others like: " + hole(0));
  EXPECT_EQ(lines[8].count, 4u) << "two of 0x1c, one of each of the others";
  EXPECT_EQ(counts.add(0, "another kind"), Show::kText);
}

TEST(BoundedCountsTest, The129thKindIsCountedOnly) {
  BoundedCounts counts;
  const auto kind = [](unsigned n) { return "kind " + std::string(n, 'x'); };
  for (unsigned n = 1; n <= 128; ++n) EXPECT_EQ(counts.add(1, kind(n)), Show::kText);
  EXPECT_EQ(counts.list().size(), 128u);
  EXPECT_EQ(counts.add(1, kind(129)), Show::kNoMore);
  EXPECT_EQ(counts.add(1, kind(130)), Show::kNothing);
  EXPECT_EQ(counts.add(1, kind(3)), Show::kNothing);
  EXPECT_EQ(counts.add(0, "first of all"), Show::kText) << "in place of the last kind";
  const auto lines = counts.list();
  ASSERT_EQ(lines.size(), 129u);
  EXPECT_EQ(lines[0].text, "first of all");
  EXPECT_EQ(lines.back().text, "warnings of further kinds");
  EXPECT_EQ(lines.back().group, 1u);
  EXPECT_EQ(lines.back().count, 3u);
  EXPECT_EQ(sum(counts), 132u);
}

TEST(BoundedCountsTest, AMillionTextsTakeNoMoreRoomThanTen) {
  BoundedCounts counts;
  unsigned shown = 0;
  for (unsigned n = 0; n < 1'000'000; ++n)
    shown += counts.add(0, hole(0x2000'0000 - 4 * n)) != Show::kNothing;
  EXPECT_EQ(shown, 9u);
  EXPECT_EQ(counts.list().size(), 9u);
  EXPECT_EQ(sum(counts), 1'000'000u);
}

TEST(BoundedCountsTest, TheListDoesNotDependOnTheOrder) {
  std::mt19937 random(7);
  std::vector<std::pair<unsigned, std::string>> texts;
  for (unsigned k = 0; k < 300; ++k)
    for (unsigned n = 0; n < 1 + k % 20; ++n)
      texts.emplace_back(k % 3, std::string(1 + k / 3, 'k') + " at " + hole(random() % 40));
  const auto list = [&] {
    BoundedCounts counts;
    for (const auto& [group, text] : texts) counts.add(group, text);
    EXPECT_EQ(sum(counts), texts.size());
    std::vector<std::tuple<unsigned, std::string, std::uint64_t>> out;
    for (const auto& l : counts.list()) out.emplace_back(l.group, l.text, l.count);
    return out;
  };
  const auto first = list();
  for (int i = 0; i < 20; ++i) {
    std::shuffle(texts.begin(), texts.end(), random);
    EXPECT_EQ(list(), first);
  }
}

TEST(DiagnosticsTest, EachTextIsShownOnceAndFewOfAKind) {
  Diagnostics d;
  std::vector<std::string> said;
  d.set_sink([&](Diagnostics::Kind, const std::string& what) { said.push_back(what); });
  for (int i = 0; i < 3; ++i)
    for (unsigned n = 0; n < 100; ++n) d.guest(hole(n));
  ASSERT_EQ(said.size(), 9u);
  EXPECT_EQ(said[7], hole(7));
  EXPECT_EQ(said[8], hole(8) + " (others like this one are only counted)");
  const auto counts = d.counts();
  EXPECT_EQ(counts.size(), 9u);
  EXPECT_EQ(counts.at({Diagnostics::Kind::kGuest, hole(0)}), 3u);
  EXPECT_EQ(counts.at({Diagnostics::Kind::kGuest, "others like: " + hole(0)}), 3u * 92);
}

}  // namespace
}  // namespace fovea
