// BT.656 data and codes compared with the published tables.
#include "model/video/core/bt656.h"

#include <gtest/gtest.h>

#include <bit>
#include <numeric>
#include <vector>

#include "model/video/core/burst_split.h"

namespace fovea::video {
namespace {

TEST(TimingCodeTest, EqualsThePublishedTable) {
  EXPECT_EQ(encode_xy(false, false, false), 0x80);
  EXPECT_EQ(encode_xy(false, true, false), 0xAB);
  EXPECT_EQ(encode_xy(true, false, false), 0xC7);
  EXPECT_EQ(encode_xy(true, true, false), 0xEC);
  EXPECT_EQ(encode_xy(false, false, true), 0x9D);
  EXPECT_EQ(encode_xy(false, true, true), 0xB6);
  EXPECT_EQ(encode_xy(true, false, true), 0xDA);
  EXPECT_EQ(encode_xy(true, true, true), 0xF1);
}

TEST(TimingCodeTest, EverySingleWrongBitIsCorrected) {
  for (unsigned fvh = 0; fvh < 8; ++fvh) {
    const bool f = fvh & 4, v = fvh & 2, h = fvh & 1;
    const std::uint8_t good = encode_xy(f, v, h);
    EXPECT_EQ(decode_xy(good).quality, XyCode::Quality::kGood);
    for (unsigned bit = 0; bit < 8; ++bit) {
      const XyCode c = decode_xy(static_cast<std::uint8_t>(good ^ 1u << bit));
      EXPECT_EQ(c.quality, XyCode::Quality::kCorrected) << fvh << " bit " << bit;
      EXPECT_TRUE(c.f == f && c.v == v && c.h == h) << fvh << " bit " << bit;
    }
  }
}

TEST(TimingCodeTest, EveryDoubleErrorOfTheSevenCodedBitsIsDetected) {
  for (unsigned fvh = 0; fvh < 8; ++fvh)
    for (unsigned a = 0; a < 7; ++a)
      for (unsigned b = a + 1; b < 7; ++b) {
        const unsigned bad = encode_xy(fvh & 4, fvh & 2, fvh & 1) ^ 1u << a ^ 1u << b;
        EXPECT_EQ(decode_xy(static_cast<std::uint8_t>(bad)).quality, XyCode::Quality::kBad);
      }
}

struct Expected {
  unsigned first, last;
  bool f, v;
};

void expect_flags(const Standard& s, std::initializer_list<Expected> table) {
  unsigned covered = 0;
  for (const Expected& e : table)
    for (unsigned line = e.first; line <= e.last; ++line, ++covered) {
      EXPECT_EQ(s.at(line).f, e.f) << "line " << line;
      EXPECT_EQ(s.at(line).v, e.v) << "line " << line;
    }
  EXPECT_EQ(covered, s.lines);
}

TEST(StandardTest, FieldAndBlankingBitsByLine625) {
  expect_flags(k625, {{624, 625, true, true},
                      {1, 22, false, true},
                      {23, 310, false, false},
                      {311, 312, false, true},
                      {313, 335, true, true},
                      {336, 623, true, false}});
}

TEST(StandardTest, FieldAndBlankingBitsByLine525) {
  expect_flags(k525, {{1, 3, true, true},
                      {4, 19, false, true},
                      {20, 263, false, false},
                      {264, 265, false, true},
                      {266, 282, true, true},
                      {283, 525, true, false}});
}

TEST(StandardTest, ProgressiveRastersHaveNoSecondField) {
  expect_flags(k480p, {{1, 45, false, true}, {46, 525, false, false}});
  expect_flags(k600p, {{1, 27, false, true}, {28, 627, false, false}, {628, 628, false, true}});
  EXPECT_EQ(k480p.frame_rate(), Frequency(30000, 1001));
  EXPECT_EQ(k600p.frame_rate(), Frequency(25));
  EXPECT_EQ(k480p.active_offset(), 1716u - 1280u);
  EXPECT_EQ(k600p.active_offset(), 2112u - 1600u);
  for (const Standard* s : {&k480p, &k600p})
    for (const std::uint64_t field : {0u, 1u, 7u}) {
      EXPECT_EQ(first_line_of_field(*s, field), field * s->lines);
      EXPECT_EQ(locate(*s, field * s->lines).field, field);
      EXPECT_EQ(locate(*s, field * s->lines).line, 1u);
      EXPECT_EQ(locate(*s, field * s->lines + s->lines - 1).line, s->lines);
    }
}

TEST(StandardTest, WholeFrameBytesAndRates) {
  EXPECT_EQ(k625.frame_bytes(), 1'080'000u);
  EXPECT_EQ(k525.frame_bytes(), 900'900u);
  EXPECT_EQ(k625.active_offset(), 288u);
  EXPECT_EQ(k525.active_offset(), 276u);
  EXPECT_EQ(k625.frame_rate(), Frequency(25));
  EXPECT_EQ(k525.frame_rate(), Frequency(30000, 1001));
}

TEST(StandardTest, ActiveLineCounts) {
  for (const Standard* s : {&k625, &k525}) {
    unsigned active[2] = {};
    for (unsigned line = 1; line <= s->lines; ++line)
      if (!s->at(line).v) ++active[s->at(line).f];
    EXPECT_EQ(active[0], s->active_count[0]);
    EXPECT_EQ(active[1], s->active_count[1]);
  }
  EXPECT_EQ(k525.active_count[0] + k525.active_count[1], 487u);
  EXPECT_EQ(k625.active_count[0] + k625.active_count[1], 576u);
}

TEST(RasterTest, FieldsBeginWhereFChanges) {
  for (const Standard* s : {&k625, &k525})
    for (std::uint64_t field = 0; field < 5; ++field) {
      const std::uint64_t n = first_line_of_field(*s, field);
      EXPECT_EQ(locate(*s, n).field, field);
      EXPECT_EQ(locate(*s, n).line, s->field_start[field % 2]);
      EXPECT_EQ(s->at(locate(*s, n).line).f, field % 2 == 1);
      if (n) {
        EXPECT_EQ(locate(*s, n - 1).field, field - 1);
      }
    }
}

TEST(PlacementTest, EveryRowOnOneLineAndInTheRightField) {
  const auto check = [](const Standard& s, const Placement& p, bool upper_field) {
    std::vector<int> seen(p.rows, 0);
    for (unsigned line = 1; line <= s.lines; ++line) {
      const Standard::Lines& fv = s.at(line);
      const int row = fv.v ? -1 : p.row(fv.f, line);
      if (row < 0) continue;
      ++seen[static_cast<unsigned>(row)];
      EXPECT_EQ(row % 2 == 0, fv.f == upper_field) << "line " << line;
    }
    for (int count : seen) EXPECT_EQ(count, 1);
  };
  check(k625, kPlacement625, false);
  check(k525, kPlacement525, false);
  check(k525, kPlacement525All, false);
  EXPECT_EQ(kPlacement525All.rows, 486u) << "all lines that are not blanked in both fields";
  check(k525, kPlacement525Studio, true);  // the first field holds the lower rows
}

TEST(LineTest, CodesBlankingAndPayloadInPlace) {
  std::vector<std::uint8_t> active(kActiveBytes);
  std::iota(active.begin(), active.end(), 0);
  for (const Standard* s : {&k625, &k525}) {
    std::vector<std::uint8_t> out(s->line_bytes);
    compose_line(*s, 0x9D, 0x80, active.data(), out);
    const unsigned sav = s->active_offset() - 4;
    EXPECT_EQ((std::vector<std::uint8_t>(out.begin(), out.begin() + 6)),
              (std::vector<std::uint8_t>{0xFF, 0, 0, 0x9D, 0x80, 0x10}));
    EXPECT_EQ((std::vector<std::uint8_t>(out.begin() + sav, out.begin() + sav + 4)),
              (std::vector<std::uint8_t>{0xFF, 0, 0, 0x80}));
    EXPECT_TRUE(std::equal(active.begin(), active.end(), out.begin() + sav + 4));
    compose_line(*s, 0xB6, 0xAB, nullptr, out);
    EXPECT_EQ(out[s->active_offset()], 0x80);
    EXPECT_EQ(out[s->line_bytes - 1], 0x10);
  }
}

TEST(BurstSplitTest, CoversTheRunInOrderWithoutCrossingAMultiple) {
  for (std::uint32_t start : {0x80000000u, 0x80000020u, 0x80000004u, 0x8000003Cu})
    for (unsigned length : {4u, 60u, 128u, 1280u, 1440u})
      for (unsigned burst : {32u, 64u}) {
        std::uint32_t at = start;
        unsigned left = length;
        while (left) {
          const unsigned b = first_burst(at, left, burst);
          ASSERT_TRUE(b >= 4 && b <= burst && b <= left && std::has_single_bit(b));
          ASSERT_EQ(at % b, 0u);
          at += b;
          left -= b;
        }
      }
}

TEST(BurstSplitTest, PalRowTakes23BurstsAtEitherAlignment) {
  for (std::uint32_t start : {0x80000000u, 0x80000020u}) {
    unsigned count = 0, left = 1440;
    for (std::uint32_t at = start; left; ++count) {
      const unsigned b = first_burst(at, left, 64);
      at += b;
      left -= b;
    }
    EXPECT_EQ(count, 23u);
  }
}

}  // namespace
}  // namespace fovea::video
