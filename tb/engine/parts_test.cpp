// Regions of a picture as jobs of the engine: each region is covered and nothing else, and all jobs together make the
// picture of the whole table, by the golden model.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "sw/remap/engine_map.h"
#include "sw/remap/engine_parts.h"
#include "tb/rtl/golden.h"

namespace fovea::engine {
namespace {

using Spans = std::vector<engine_span_t>;

std::vector<engine_part_t> cover(const Spans& spans) {
  std::vector<engine_part_t> parts;
  const auto add = [](void* to, const engine_part_t* part) {
    static_cast<std::vector<engine_part_t>*>(to)->push_back(*part);
    return 0;
  };
  EXPECT_EQ(engine_parts_cover(spans.data(), static_cast<std::uint32_t>(spans.size()), add, &parts), 0);
  return parts;
}

/// How often each pair is made; the parts may not leave the picture.
std::vector<unsigned> made(const std::vector<engine_part_t>& parts, unsigned pairs, std::size_t rows) {
  std::vector<unsigned> count(pairs * rows, 0);
  for (const engine_part_t& p : parts)
    for (int k = 0; k < p.rows; ++k)
      for (int i = 0; i < p.pairs; ++i) {
        const int row = p.top + k * p.every, pair = p.left + k * p.slant + i;
        const bool inside = row < static_cast<int>(rows) && pair >= 0 && pair < static_cast<int>(pairs);
        EXPECT_TRUE(inside) << row << ", " << pair;
        if (inside) ++count[static_cast<unsigned>(row) * pairs + static_cast<unsigned>(pair)];
      }
  return count;
}

void expect_exact(const Spans& spans, unsigned pairs, const std::vector<engine_part_t>& parts) {
  const auto count = made(parts, pairs, spans.size());
  for (std::size_t v = 0; v < spans.size(); ++v)
    for (unsigned i = 0; i < pairs; ++i) {
      const bool is_in = i >= spans[v].first && i < spans[v].end;
      ASSERT_EQ(count[v * pairs + i] > 0, is_in) << "row " << v << ", pair " << i;
      ASSERT_LE(count[v * pairs + i], 2u) << "row " << v << ", pair " << i;
    }
}

/// The regions of a bird's-eye view in pixels, by its rule: seams at 45 degrees from the corners of the car.
/// 0 to 3: above, right, below, left; 4: the car.
std::vector<Spans> birds_eye(unsigned pairs, unsigned rows, int left, int top, int right, int bottom) {
  std::vector<Spans> regions(5, Spans(rows));
  const auto clipped = [&](int x) {
    return static_cast<std::uint16_t>(std::clamp((x + 1) / 2, 0, static_cast<int>(pairs)));
  };
  for (int v = 0; v < static_cast<int>(rows); ++v) {
    const int beyond = v < top ? top - v : v >= bottom ? v - bottom + 1 : 0;
    const std::uint16_t a = clipped(std::max(left - beyond, 0)), b = clipped(right + beyond);
    regions[3][static_cast<unsigned>(v)] = {0, a};
    regions[v < top ? 0 : v >= bottom ? 2 : 4][static_cast<unsigned>(v)] = {a, b};
    regions[1][static_cast<unsigned>(v)] = {b, static_cast<std::uint16_t>(pairs)};
  }
  return regions;
}

TEST(EngineParts, ARectangleIsOnePart) {
  Spans spans(20);
  for (unsigned v = 5; v < 15; ++v) spans[v] = {3, 9};
  const auto parts = cover(spans);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].pairs, 6u);
  EXPECT_EQ(parts[0].rows, 10u);
  EXPECT_EQ(parts[0].top, 5u);
  EXPECT_EQ(parts[0].left, 3u);
  EXPECT_EQ(parts[0].every, 1u);
  EXPECT_EQ(parts[0].slant, 0);
  expect_exact(spans, 12, parts);
  EXPECT_TRUE(cover(Spans(7)).empty());
  EXPECT_TRUE(cover({}).empty());
}

TEST(EngineParts, AParallelogramIsTwo) {
  Spans spans(31);
  for (unsigned v = 0; v < 31; ++v)
    spans[v] = {static_cast<std::uint16_t>(v / 2), static_cast<std::uint16_t>(v / 2 + 5)};
  const auto parts = cover(spans);
  EXPECT_EQ(parts.size(), 2u);
  expect_exact(spans, 20, parts);
}

TEST(EngineParts, TheRegionsOfABirdsEyeViewAreFewParts) {
  std::size_t parts = 0, words = 0;
  for (const Spans& spans : birds_eye(360, 576, 260, 200, 460, 376)) {
    const auto some = cover(spans);
    expect_exact(spans, 360, some);
    parts += some.size();
    for (const engine_part_t& p : some) words += std::size_t{p.pairs} * p.rows;
  }
  EXPECT_LE(parts, 60u);
  EXPECT_LE(words, 360u * 576 * 4 / 3);
}

TEST(EngineParts, AnyRegionIsCoveredExactly) {
  std::mt19937 random(1);
  const auto below = [&](unsigned n) { return static_cast<int>(random() % n); };
  for (unsigned n = 0; n < 300; ++n) {
    const unsigned pairs = 1 + random() % 90, rows = 1 + random() % 120;
    const int left = below(2 * pairs), top = below(rows);
    for (const Spans& s : birds_eye(pairs, rows, left, top, left + below(2 * pairs), top + below(rows)))
      expect_exact(s, pairs, cover(s));
    Spans spans(rows);  // nothing straight in it
    for (auto& s : spans) {
      s.first = static_cast<std::uint16_t>(random() % pairs);
      s.end = static_cast<std::uint16_t>(s.first + random() % (pairs - s.first + 1));
    }
    expect_exact(spans, pairs, cover(spans));
  }
}

TEST(EngineParts, TheSearchEndsWhereItIsTold) {
  unsigned calls = 0;
  const Spans spans(40, engine_span_t{0, 4});
  const auto stop = [](void* n, const engine_part_t*) { return ++*static_cast<unsigned*>(n), 7; };
  EXPECT_EQ(engine_parts_cover(spans.data(), 40, stop, &calls), 7);
  EXPECT_EQ(calls, 1u);
}

/// The golden model's job of a job window; fields as in the table of rtl/README.md.
rtl::Job golden(const remap_engine_job_t& j) {
  rtl::Job g;
  g.mode = static_cast<rtl::Mode>(j.mode & 3);
  g.pairs = j.size & 0xFFF;
  g.rows = j.size >> 16;
  g.src_pitch = j.src_pitch / 4;
  g.dst_base = j.dst_base / 4;
  g.dst_pitch = j.dst_pitch / 4;
  g.src_width = j.src_size & 0x1FFF;
  g.src_height = j.src_size >> 16;
  for (unsigned n = 0; n < 3; ++n) g.c[n] = static_cast<std::int32_t>(j.c[n]);
  return g;
}

TEST(EngineParts, TheirJobsMakeThePictureOfTheWholeTable) {
  constexpr unsigned kWidth = 80, kHeight = 48, kPairs = kWidth / 2, kPitch = 160, kBorder = 0x10801080;
  std::mt19937 random(2);
  std::vector<std::uint32_t> lut(kPairs * kHeight);
  for (auto& e : lut) e = random() % (kPitch * kHeight / 4 + 1) * 4;  // the last one is the black word
  std::vector<std::uint32_t> result(kPitch / 4 * kHeight, 0), expected(result);
  const auto regions = birds_eye(kPairs, kHeight, 30, 16, 50, 30);
  for (unsigned camera = 0; camera < regions.size(); ++camera) {
    const auto word = [&](std::uint32_t at) { return camera << 24 | at; };
    for (unsigned v = 0; v < kHeight; ++v)
      for (unsigned i = regions[camera][v].first; i < regions[camera][v].end; ++i) {
        const std::uint32_t e = lut[v * kPairs + i];
        expected[v * kPitch / 4 + i] = camera == 4 || e == kPitch * kHeight ? kBorder : word(e / 4);
      }
    for (const engine_part_t& p : cover(regions[camera])) {
      remap_engine_job_t job = remap_engine_part(&p, kWidth, kHeight, kPitch);
      std::vector<std::uint32_t> map(job.map_words + 1, 0x5A5A5A5A);
      remap_engine_part_map(&p, lut.data(), kWidth, map.data());
      EXPECT_EQ(map.back(), 0x5A5A5A5Au);
      map.pop_back();
      EXPECT_EQ(job.border, kBorder);
      if (camera == 4) {
        remap_engine_blacken(&job);
        EXPECT_EQ(job.map_words, 0u);
        map.clear();
      }
      const rtl::Job g = golden(job);
      ASSERT_TRUE(rtl::possible(g));
      ASSERT_EQ(rtl::map_words(g), map.size());
      const auto beats = rtl::addresses(g, map);
      const auto words = rtl::picture(g, map, kBorder, word);
      for (std::size_t n = 0; n < words.size(); ++n) result.at(beats[n].dst) = words[n];
    }
  }
  EXPECT_EQ(result, expected);
}

}  // namespace
}  // namespace fovea::engine
