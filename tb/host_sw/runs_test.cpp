// The EDMA's remap tables: division of rows into pieces, and of pieces into runs. A run is decoded here by the rules of
// the controller's guide (SPRUH82C, AB-synchronised transfer), byte by byte.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <random>
#include <vector>

#include "sw/lens/lens.h"
#include "sw/remap/runs.h"

namespace {

using Words = std::vector<std::uint32_t>;

constexpr std::uint32_t kDestination = 0x100;

/// A source in which each word is its own address.
std::uint8_t source_byte(std::uint32_t address) {
  return static_cast<std::uint8_t>((address & ~3u) >> 8 * (address & 3));
}

/// What the runs make of the target.
void transfer(const std::vector<remap_run_t>& runs, std::vector<std::uint8_t>& target) {
  for (const remap_run_t& r : runs) {
    const unsigned acnt = r.counts & 0xFFFF, bcnt = r.counts >> 16;
    const int from = static_cast<std::int16_t>(r.steps & 0xFFFF);
    const int to = static_cast<std::int16_t>(r.steps >> 16);
    ASSERT_TRUE(acnt == 4 || acnt == 8);
    ASSERT_GT(bcnt, 0u);
    for (unsigned b = 0; b < bcnt; ++b)
      for (unsigned a = 0; a < acnt; ++a)
        target.at(r.destination + static_cast<unsigned>(to) * b + a) =
            source_byte(r.source + static_cast<std::uint32_t>(from) * b + a);
  }
}

std::vector<remap_run_t> encode(const Words& sources, unsigned most = REMAP_PIECE_MAX) {
  std::vector<remap_run_t> runs(most + 1, remap_run_t{1, 2, 3, 4});
  const unsigned n = remap_encode_runs(sources.data(), static_cast<unsigned>(sources.size()),
                                       kDestination, most, runs.data());
  EXPECT_LE(n, most);
  for (std::size_t i = n; i < runs.size(); ++i)
    EXPECT_EQ(runs[i].destination, 3u) << "written behind the last run";
  runs.resize(n);
  return runs;
}

/// The source addresses of the pairs that arrive.
Words moved(const std::vector<remap_run_t>& runs, std::size_t pairs) {
  std::vector<std::uint8_t> target(kDestination + 4 * pairs + 4, 0xEE);
  transfer(runs, target);
  Words out(pairs + 1);
  std::memcpy(out.data(), &target[kDestination], 4 * out.size());
  EXPECT_EQ(out.back(), 0xEEEEEEEE) << "written behind the piece";
  out.pop_back();
  return out;
}

/// Words at equal distances.
Words spaced(std::uint32_t first, std::int32_t step, unsigned pairs) {
  Words out;
  for (unsigned i = 0; i < pairs; ++i) out.push_back(first + static_cast<std::uint32_t>(step) * i);
  return out;
}

TEST(PiecesTest, AreTheFewestEqualOnesThatAreTheRow) {
  for (unsigned longest = 1; longest <= 64; ++longest)
    for (unsigned pairs = 1; pairs <= 400; ++pairs) {
      const remap_pieces_t p = remap_divide(pairs, longest, 1);
      ASSERT_GE(p.pairs, 1u);
      ASSERT_LE(p.pairs, longest);
      ASSERT_EQ(p.step * (p.count - 1) + p.pairs, pairs) << "they end with the row";
      ASSERT_LE(p.step, p.pairs) << "no gap";
      // With fewer pieces no step would do.
      for (unsigned count = (pairs + longest - 1) / longest; count < p.count; ++count)
        ASSERT_GT(pairs - pairs / count * (count - 1), longest);
    }
}

TEST(PiecesTest, PalAndTheLimits) {
  const auto is = [](remap_pieces_t p, unsigned count, unsigned pairs, unsigned step) {
    return p.count == count && p.pairs == pairs && p.step == step;
  };
  EXPECT_TRUE(is(remap_divide(360, 46, 1), 8, 45, 45));
  EXPECT_TRUE(is(remap_divide(46, 46, 1), 1, 46, 46));
  EXPECT_TRUE(is(remap_divide(47, 46, 1), 2, 24, 23));
  EXPECT_TRUE(is(remap_divide(360, 256, 3), 3, 120, 120));
  EXPECT_TRUE(is(remap_divide(360, 256, 4), 4, 90, 90));
  EXPECT_TRUE(is(remap_divide(5, 5, 5), 5, 1, 1));
}

TEST(RunsTest, EquallySpacedPairsAreOneRun) {
  for (int step : {0, 4, 8, -4, 1440, -1440, 32764, -32768}) {
    const Words s = spaced(1'000'000, step, 9);
    const auto runs = encode(s);
    ASSERT_EQ(runs.size(), 1u) << step;
    EXPECT_EQ(runs[0].counts, 4u | 9u << 16);
    EXPECT_EQ(runs[0].steps, (static_cast<std::uint32_t>(step) & 0xFFFFu) | 4u << 16);
    EXPECT_EQ(moved(runs, 9), s);
  }
}

TEST(RunsTest, AStepBeyondSixteenBitsEndsARun) {
  for (int step : {32768, -32772}) {
    const Words s = spaced(1'000'000, step, 5);
    const auto runs = encode(s);
    EXPECT_EQ(runs.size(), 5u) << step;
    EXPECT_EQ(moved(runs, 5), s);
  }
}

TEST(RunsTest, CouplesThatAreEquallySpacedAreOneRun) {
  for (int step : {4, 0, 1440, -1436}) {
    Words s;
    for (int i = 0; i < 5; ++i)
      for (int k = 0; k < 2; ++k) s.push_back(static_cast<std::uint32_t>(100'000 + i * step + 4 * k));
    const auto runs = encode(s);
    ASSERT_EQ(runs.size(), 1u) << step;
    EXPECT_EQ(runs[0].counts, 8u | 5u << 16);
    EXPECT_EQ(moved(runs, 10), s);
  }
  // A couple cannot begin with the last pair, and its step has 16 bits too.
  EXPECT_EQ(encode({0, 4, 40'000, 40'004}).size(), 2u);
  EXPECT_EQ(encode({0, 4, 100, 104, 200}).size(), 2u);
}

TEST(RunsTest, OnePairAndTheLongestPiece) {
  EXPECT_EQ(encode({64}).size(), 1u);
  const Words s = spaced(4096, 0, REMAP_PIECE_MAX);
  const auto runs = encode(s);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(moved(runs, s.size()), s);
}

TEST(RunsTest, MoreRunsThanAllowedAreRefused) {
  const Words s = {0, 100, 0, 300, 4, 700, 8};  // no two equal steps, no neighbours: 4 runs of two at best
  const unsigned n = static_cast<unsigned>(encode(s).size());
  ASSERT_EQ(n, 4u);
  EXPECT_EQ(encode(s, n).size(), n);
  EXPECT_EQ(encode(s, n - 1).size(), 0u);
}

/// The fewest runs, by trying what may begin at each pair: all runs, or one pair and the longest of each kind.
std::size_t fewest(const Words& s, bool all) {
  std::vector<std::size_t> best(s.size() + 1, 0);
  const auto step = [&](std::size_t a, std::size_t b) {
    return static_cast<std::int32_t>(s[b] - s[a]);
  };
  const auto fits = [](std::int32_t d) { return d >= -32768 && d <= 32767; };
  for (std::size_t i = s.size(); i-- > 0;) {
    std::size_t least = best[i + 1];
    std::size_t singles = i + 1, couples = i + 1;  // ends of the longest
    for (std::size_t e = i + 2; e <= s.size(); ++e) {
      bool single = fits(step(i, i + 1)), couple = (e - i) % 2 == 0;
      for (std::size_t k = i + 1; k < e; ++k) single &= step(k - 1, k) == step(i, i + 1);
      for (std::size_t k = i; couple && k < e; k += 2)
        couple &= step(k, k + 1) == 4 &&
                  (k == i || (fits(step(i, i + 2)) && step(k - 2, k) == step(i, i + 2)));
      if (single) singles = e;
      if (couple) couples = e;
      if (all && (single || couple)) least = std::min(least, best[e]);
    }
    if (!all) least = std::min({least, best[singles], best[couples]});
    best[i] = least + 1;
  }
  return best[0];
}

TEST(RunsTest, RandomPiecesArriveInTheFewestLongRuns) {
  std::mt19937 random(5);
  const int steps[] = {4, 4, 4, 0, 0, 1440, -1436, 8, 40'000};
  std::size_t ours = 0, least = 0;
  for (unsigned round = 0; round < 2000; ++round) {
    Words s{1'000'000};
    const unsigned pairs = 1 + random() % 40, kinds = 2 + random() % 8;
    while (s.size() < pairs) s.push_back(s.back() + static_cast<std::uint32_t>(steps[random() % kinds]));
    const auto runs = encode(s);
    ASSERT_EQ(moved(runs, s.size()), s) << round;
    ASSERT_EQ(runs.size(), fewest(s, false)) << round;
    ours += runs.size();
    least += fewest(s, true);
  }
  EXPECT_GE(ours, least);
  std::printf("%zu runs; the fewest of all would be %zu\n", ours, least);
}

struct Size {
  unsigned width, height;
};

/// Whole pictures: lenses, methods, black rims, sizes; with the pieces that the firmware would take.
TEST(RunsTest, TablesOfManyLensesAreExact) {
  unsigned pictures = 0, black = 0;
  for (std::uint32_t mapping = LENS_NONE; mapping < LENS_TABLE; ++mapping)
    for (const Size size : {Size{720, 576}, Size{320, 240}, Size{716, 8}, Size{64, 48}})
      for (unsigned variant = 0; variant < 8; ++variant) {
        lens_view_t view;
        lens_view_default(&view);
        view.mapping = mapping;
        view.fov_deg = 130;
        if (variant & 1) view.pair_method = PAIR_CENTRE;
        if (variant & 2) view.shift_x = 30.25;
        if (variant & 4) view.out_focal_px = size.width / 6.0;  // wide: black where nothing is imaged
        lens_t lens;
        ASSERT_EQ(lens_init(&lens, &view, size.width, size.height), LENS_OK);
        const std::uint32_t pitch = (size.width * 2 + 31) / 32 * 32, row = size.width / 2;
        Words lut(std::size_t{row} * size.height);
        lens_build_lut(&lens, lut.data(), pitch);
        const std::uint32_t black_word = lens_black_offset(size.height, pitch);
        black += static_cast<unsigned>(std::count(lut.begin(), lut.end(), black_word));
        ++pictures;
        for (unsigned longest : {46u, 90u, 256u}) {
          const remap_pieces_t p = remap_divide(row, longest, 1);
          for (unsigned v = 0; v < size.height; v += 1 + size.height / 40)
            for (unsigned n = 0; n < p.count; ++n) {
              const auto from = lut.begin() + v * row + n * p.step;
              const Words piece(from, from + p.pairs);
              ASSERT_EQ(moved(encode(piece), piece.size()), piece);
            }
        }
      }
  EXPECT_EQ(pictures, 192u);
  EXPECT_GT(black, 10'000u) << "black rims are among them";
}

}  // namespace
