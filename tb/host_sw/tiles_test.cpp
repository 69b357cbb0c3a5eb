// The table of the staged remap: an interpreter that knows only tiles.h's description copies windows, follows
// codes, and must end with the picture of the look-up table.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

#include "sw/lens/lens.h"
#include "sw/remap/tiles.h"

namespace {

constexpr std::uint32_t kPlaceOffset = 0x10000;
constexpr std::uint32_t kRoom = 10'368;  // of the firmware's banks

struct Picture {
  unsigned width, height;
  unsigned pitch() const { return (2 * width + 31) / 32 * 32; }
  std::vector<std::uint32_t> lut;
  remap_picture_t view() const { return {width / 2, height, pitch(), lut.data(), height}; }
  std::uint32_t black() const { return pitch() * height; }
  std::uint32_t entry(unsigned pair, unsigned row) const { return lut[row * (width / 2) + pair]; }
};

Picture picture(const lens_view_t& view, unsigned width, unsigned height) {
  Picture p{width, height, {}};
  lens_t lens;
  EXPECT_EQ(lens_init(&lens, &view, width, height), LENS_OK);
  p.lut.resize(lens_lut_entries(width, height));
  lens_build_lut(&lens, p.lut.data(), p.pitch());
  return p;
}

lens_view_t view_of(std::uint32_t mapping, double fov_deg) {
  lens_view_t view;
  lens_view_default(&view);
  view.mapping = mapping;
  view.fov_deg = fov_deg;
  return view;
}

/// Each pair of the result from the same place of the source.
Picture identity(unsigned width, unsigned height) {
  Picture p{width, height, {}};
  for (unsigned v = 0; v < height; ++v)
    for (unsigned i = 0; i < width / 2; ++i) p.lut.push_back(v * p.pitch() + 4 * i);
  return p;
}

struct Table {
  tile_table_t t{};
  std::vector<tile_window_t> windows;
  std::vector<tile_pattern_t> patterns;
  std::vector<tile_stream_t> streams;
  const char* refusal = nullptr;

  explicit Table(const Picture& p, std::uint32_t room = kRoom) {
    t.picture = p.view();
    t.bank[0] = {0x1780, 0x1780 + room};
    t.bank[1] = {0x4780, 0x4780 + room};
    t.place_offset = kPlaceOffset;
    windows.resize(tiles_count(&t.picture));
    refusal = tiles_layout(&t, windows.data());
    if (refusal) return;
    patterns.resize(std::size_t{t.strips} * t.patterns_max);
    streams.resize(t.tiles);
    tile_work_t work;
    std::memset(&work, 0xA5, sizeof work);
    refusal = tiles_encode(&t, windows.data(), patterns.data(), streams.data(), &work);
  }
  std::string why() const { return refusal ? refusal : ""; }
};

/// A memory in which only what was copied since the last clearing may be read.
class FastMemory {
 public:
  void copy(const tile_part_t& part, unsigned source_pitch, unsigned pitch, unsigned source_bytes,
            const tile_bank_t& bank) {
    const unsigned bytes = part.counts & 0xFFFF, rows = part.counts >> 16;
    EXPECT_EQ(part.source % 32 | bytes % 32, 0u);
    for (unsigned r = 0; r < rows; ++r)
      for (unsigned i = 0; i < bytes; i += 4) {
        const unsigned from = part.source + r * source_pitch + i;
        const unsigned to = part.place - kPlaceOffset + r * pitch + i;
        ASSERT_LT(from, source_bytes);
        ASSERT_GE(to, bank.start);
        ASSERT_LT(to, bank.end);
        word_[to] = from;
      }
  }
  void clear(const tile_bank_t& bank) {
    std::fill(word_.begin() + bank.start, word_.begin() + bank.end, kNothing);
  }
  std::uint32_t at(std::uint32_t address) const { return word_.at(address); }
  static constexpr std::uint32_t kNothing = ~0u;

 private:
  std::vector<std::uint32_t> word_ = std::vector<std::uint32_t>(65536, kNothing);
};

/// Interprets a table: the source offset of each pair of the result.
std::vector<std::uint32_t> interpret(const Table& table, const Picture& p) {
  const tile_table_t& t = table.t;
  FastMemory memory;
  std::vector<std::uint32_t> result(p.pitch() / 4 * p.height, FastMemory::kNothing);
  for (unsigned n = 0; n < t.tiles; ++n) {
    const tile_bank_t& bank = t.bank[n % 2];
    const tile_stream_t& s = table.streams[n];
    const tile_part_t* parts = n < 2 ? table.windows[n].part : table.streams[n - 2].next;
    memory.clear(bank);
    for (unsigned part = 0; part < TILE_PARTS; ++part)
      memory.copy(parts[part], p.pitch(), t.window_pitch, p.pitch() * p.height, bank);
    const auto* patterns = &table.patterns[std::size_t{n / t.strip_tiles} * t.patterns_max];
    const std::uint16_t* code = s.code;
    for (unsigned y = 0; y < TILE_ROWS; y += 2) {
      // The order of a pair of rows: upper 0, two bases, upper 1, then lower and upper by turns.
      std::vector<std::uint16_t> of[2];
      of[0].push_back(*code++);
      std::uint32_t base[2] = {code[0], code[1]};
      code += 2;
      of[0].push_back(*code++);
      for (unsigned turn = 1; turn < 2 * TILE_ROW_CODES / 2; ++turn)
        for (unsigned k = 0; k < 2; ++k) of[turn % 2].push_back(*code++);
      for (unsigned i = 0; i < 2; ++i) {
        std::uint32_t* out = &result.at(s.destination / 4 + (y + i) * (p.pitch() / 4));
        for (const std::uint16_t c : of[i]) {
          EXPECT_EQ((c - bank.start) % 16, 0u);
          const unsigned number = (c - bank.start) / 16;
          EXPECT_LT(number, t.patterns);
          const std::uint32_t from = base[i];
          for (const std::int32_t step : patterns[number].step)
            *out++ = memory.at(base[i] = from + static_cast<std::uint32_t>(step));
        }
      }
    }
    EXPECT_EQ(code, s.code + std::size(s.code));
    EXPECT_EQ(s.number, n + 1);
    // The patterns are brought for the first tile of a strip in each bank.
    if (n + 2 < t.tiles) {
      EXPECT_EQ(s.next_patterns, (n + 2) % t.strip_tiles < 2 ? 1u : 0u) << n;
    }
  }
  return result;
}

void expect_exact(const Picture& p, const std::string& what) {
  const Table table(p);
  ASSERT_EQ(table.why(), "") << what;
  EXPECT_LE(table.t.patterns * 16 + table.t.window_bytes, kRoom) << what;
  const auto result = interpret(table, p);
  unsigned wrong = 0;
  for (unsigned v = 0; v < p.height; ++v)
    for (unsigned i = 0; i < p.width / 2; ++i)
      wrong += p.entry(i, v) != p.black() && result[v * (p.pitch() / 4) + i] != p.entry(i, v);
  EXPECT_EQ(wrong, 0u) << what;
  EXPECT_EQ(std::count(result.begin(), result.end(), FastMemory::kNothing), 0) << what;
  // Pairs where tiles overlap count twice.
  const auto black = static_cast<std::uint32_t>(std::count(p.lut.begin(), p.lut.end(), p.black()));
  EXPECT_GE(table.t.black, black) << what;
  EXPECT_EQ(table.t.black > 0, black > 0) << what;
}

TEST(TilesTest, LensesAndSizesDecodeToTheirTable) {
  const std::pair<unsigned, unsigned> sizes[] = {{720, 576}, {720, 480}, {640, 480}, {320, 240},
                                                 {716, 572}, {84, 52},   {68, 28},   {160, 48}};
  unsigned exact = 0, refused = 0;
  for (const std::uint32_t mapping :
       {LENS_RECTILINEAR, LENS_LINEAR, LENS_ORTHOGRAPHIC, LENS_EQUISOLID, LENS_STEREOGRAPHIC})
    for (const double fov : {100.0, 140.0, 178.0})
      for (const auto& [width, height] : sizes) {
        if (mapping == LENS_RECTILINEAR && fov > 120) continue;
        lens_view_t view = view_of(mapping, fov);
        view.shift_x = fov > 120 ? 9 : 0;
        view.pair_method = fov > 150;
        const Picture p = picture(view, width, height);
        const std::string what = std::to_string(mapping) + " at " + std::to_string(fov) + ", " +
                                 std::to_string(width) + "x" + std::to_string(height);
        if (!Table(p).why().empty()) {
          ++refused;
          continue;
        }
        expect_exact(p, what);
        ++exact;
      }
  std::printf("%u tables exact, %u refused\n", exact, refused);
  EXPECT_GE(exact, 40u);
}

TEST(TilesTest, TheSmallestPicturesAreOneTileWideAndTwoHigh) {
  const auto count = [](unsigned width, unsigned height) {
    const remap_picture_t p = {width / 2, height, (2 * width + 31) / 32 * 32, nullptr, height};
    return tiles_count(&p);
  };
  EXPECT_EQ(count(80, 25), 2u);
  EXPECT_EQ(count(80, 24), 0u);
  EXPECT_EQ(count(66, 28), 2u);  // rounded up to whole groups
  EXPECT_EQ(count(64, 28), 0u);
  EXPECT_EQ(count(720, 576), 216u);
  EXPECT_EQ(count(724, 577), 250u);
  EXPECT_EQ(Table(identity(64, 28)).why(), "the picture is smaller than two tiles of 80 x 24 pixels");
  expect_exact(identity(80, 28), "80x28");
  expect_exact(identity(68, 28), "68x28");
}

// Straight copies need patterns with steps of 4 only: one, and the window is the tile itself.
TEST(TilesTest, ACopyHasOnePatternAndTheSmallestWindow) {
  const Table table(identity(160, 48));
  ASSERT_EQ(table.why(), "");
  EXPECT_EQ(table.t.patterns, 1u);
  EXPECT_EQ(table.t.window_pitch, 160u);
  EXPECT_EQ(table.t.window_bytes, 160u * 24);
  EXPECT_EQ(table.t.strips, 2u);
  EXPECT_EQ(table.t.strip_tiles, 2u);
  EXPECT_EQ(table.patterns[0].step[0], 4);
  EXPECT_EQ(table.patterns[0].step[3], 16);
}

// The window of a copy has 3,840 bytes; with one pattern it needs 16 more.
TEST(TilesTest, AWindowThatFillsTheBankIsRefused) {
  EXPECT_EQ(Table(identity(160, 48), 3'904).why(), "");
  EXPECT_EQ(Table(identity(160, 48), 3'840).why(), "a tile's window does not fit into internal RAM");
}

/// A copy in which row 0 of the first tile has `changed` groups that are like no other.
Picture with_patterns(unsigned changed) {
  Picture p = identity(160, 48);
  for (unsigned g = 0; g < changed; ++g) {
    // The first pair of group g + 1 comes from further down: two new patterns with the one behind it, but the
    // last pair is where it was, so the next group is as before.
    const unsigned row = 2 * (g / 4), group = 2 + 2 * (g % 4);
    p.lut[row * 80 + 4 * group] += (1 + g) * p.pitch() - 4 * 0;
  }
  return p;
}

TEST(TilesTest, PatternsFillTheBankExactly) {
  // 24 rows of 160 bytes, and room for four patterns.
  EXPECT_EQ(Table(with_patterns(3), 3'904).t.patterns, 4u);
  EXPECT_EQ(Table(with_patterns(3), 3'904).why(), "");
  EXPECT_EQ(Table(with_patterns(4), 3'904).why(),
            "a strip has more patterns than fit into internal RAM beside the windows");
}

// Black pairs, rows and tiles read some other pair of the source, and leave the others as they are.
TEST(TilesTest, BlackPairsDisturbNoOther) {
  for (const auto& [first, count] : {std::pair{0u, 1u}, {79u, 2u}, {80u * 47 + 79, 1u}, {40u, 200u},
                                     {0u, 80u * 24}, {0u, 80u * 48}}) {
    Picture p = identity(160, 48);
    std::fill_n(p.lut.begin() + first, count, p.black());
    expect_exact(p, std::to_string(count) + " from " + std::to_string(first));
    EXPECT_EQ(Table(p).t.black, count);
  }
  // A black tile adds nothing to the windows of the others.
  Picture p = identity(160, 48);
  for (unsigned v = 0; v < 24; ++v) std::fill_n(p.lut.begin() + v * 80, 40, p.black());
  EXPECT_EQ(Table(p).t.window_bytes, 160u * 24);
}

// A slanted tile: its halves lie on different rows, and one rectangle around them would be nearly twice as large.
TEST(TilesTest, TwoPartsAreSmallerThanOneRectangle) {
  Picture p = identity(160, 96);
  for (unsigned v = 0; v < 48; ++v)
    for (unsigned i = 16; i < 40; ++i) p.lut[v * 80 + i] += 24 * p.pitch();
  const Table table(p);
  ASSERT_EQ(table.why(), "");
  const tile_window_t& w = table.windows[0];
  EXPECT_EQ(w.part[0].counts, 64u | 24u << 16);
  EXPECT_EQ(w.part[1].counts, 96u | 24u << 16);
  EXPECT_EQ(w.part[0].source, 0u);
  EXPECT_EQ(w.part[1].source, 24u * 320 + 64);
  EXPECT_EQ(table.t.window_bytes, 160u * 48);
  expect_exact(p, "slanted");
}

}  // namespace
