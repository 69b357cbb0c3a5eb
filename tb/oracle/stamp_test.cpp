// The marks in camera pictures: readable, distinct for fields, and never read wrongly.
#include "model/video/scene/stamp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/common/check.h"

namespace fovea::video {
namespace {

const StampLayout kLayout = StampLayout::at(720, 576, 372.4, 298.0);
const CodeGrid kGrid{kLayout};

Picture stamped(std::uint64_t k) {
  Picture p(720, 576, 100, 90, 200);
  stamp(p, kLayout, k);
  return p;
}

Picture woven(const Picture& even_rows, const Picture& odd_rows) {
  Picture p = even_rows;
  for (unsigned y = 1; y < p.height; y += 2)
    std::copy(odd_rows.row(y), odd_rows.row(y) + p.row_bytes(), p.row(y));
  return p;
}

TEST(StampTest, CounterReadsBackForEveryBit) {
  for (unsigned k : {0u, 1u, 0x5555u, 0xaaaau, 0xffffu})
    EXPECT_EQ(decode_counter(stamped(k), kGrid), k);
  for (unsigned bit = 0; bit < 16; ++bit)
    EXPECT_EQ(decode_counter(stamped(1u << bit), kGrid), 1u << bit);
  EXPECT_EQ(decode_counter(stamped(65536 + 77), kGrid), 77);
}

TEST(StampTest, PicturesWithoutTheCodeAreNotRead) {
  EXPECT_FALSE(decode_counter(Picture(720, 576), kGrid));
  EXPECT_FALSE(decode_counter(Picture(720, 576, 235), kGrid));
  EXPECT_FALSE(decode_frame(Picture(720, 576), kGrid));
  EXPECT_FALSE(decode_frame(Picture(720, 576, 235), kGrid));
  EXPECT_FALSE(decode_counter(Picture(64, 64), kGrid));
}

TEST(StampTest, EveryDamagedCellIsNoticed) {
  for (unsigned k : {0u, 1234u, 65535u})
    for (unsigned cell = 0; cell < 24; ++cell) {
      Picture p = stamped(k);
      const unsigned x0 = kLayout.code_x + cell % 8 * StampLayout::kCellPixels;
      const unsigned y0 = kLayout.code_y + cell / 8 * StampLayout::kCellPixels;
      for (unsigned y = y0; y < y0 + StampLayout::kCellPixels; ++y)
        for (unsigned x = x0; x < x0 + StampLayout::kCellPixels; ++x) {
          std::uint8_t& luma = p.row(y)[2 * x + 1];
          luma = luma > 126 ? 32 : 220;
        }
      EXPECT_FALSE(decode_counter(p, kGrid)) << k << " cell " << cell;
    }
}

TEST(StampTest, AWovenFrameTellsBothFields) {
  const Picture frame = woven(stamped(2000), stamped(2001));
  EXPECT_EQ(decode_counter(frame, kGrid, Rows::kEven), 2000);
  EXPECT_EQ(decode_counter(frame, kGrid, Rows::kOdd), 2001);
  EXPECT_EQ(decode_frame(frame, kGrid), 1000);
  const Picture swapped = woven(stamped(2001), stamped(2000));
  EXPECT_EQ(decode_counter(swapped, kGrid, Rows::kEven), 2001);
}

TEST(StampTest, FieldsOfDifferentFramesWovenTogetherAreNotOneFrame) {
  for (unsigned n = 0; n < 1000; ++n)
    EXPECT_FALSE(decode_frame(woven(stamped(2 * n + 1), stamped(2 * n + 2)), kGrid)) << n;
}

TEST(StampTest, ARemapThatShrinksTheMiddleLeavesTheFrameReadable) {
  // Whole pairs, nearest row, output scale 0.6: what the correction does near the optical centre.
  const Picture frame = woven(stamped(4242), stamped(4243));
  Picture out(720, 576);
  for (double scale : {0.6, 0.8, 1.0, 1.5}) {
    for (unsigned y = 0; y < 576; ++y)
      for (unsigned x = 0; x < 720; x += 2) {
        const long sx = std::lround(359.5 + (x - 359.5) / scale) & ~1l;
        const long sy = std::lround(287.5 + (y - 287.5) / scale);
        if (sx < 0 || sy < 0 || sx >= 720 || sy >= 576) continue;
        std::copy_n(frame.row(static_cast<unsigned>(sy)) + sx * 2, 4, out.row(y) + x * 2);
      }
    // Pixel edges: x - 0.5 in pixel coordinates.
    const CodeGrid grid(360 + (kGrid.x - 360) * scale, 288 + (kGrid.y - 288) * scale,
                        kGrid.cell_width * scale, kGrid.cell_height * scale);
    EXPECT_EQ(decode_frame(out, grid), 2121) << scale;
  }
}

TEST(StampTest, TheMarkerIsWhereItIsSaidToBe) {
  for (std::uint64_t k : {0, 1, 7, 8, 47, 48, 1000}) {
    const Picture p = stamped(k);
    const MarkerPosition m = marker_position(kLayout, k);
    const unsigned last = StampLayout::kMarkerPixels - 1;
    const auto luma = [&](unsigned x, unsigned y) { return p.row(y)[2 * x + 1]; };
    EXPECT_EQ(luma(m.x, m.y), 220);
    EXPECT_EQ(luma(m.x + last, m.y + last), 220);
    EXPECT_EQ(luma(m.x - 1, m.y), 32);
    EXPECT_EQ(luma(m.x + last + 1, m.y + last), 32);
    EXPECT_EQ(luma(m.x, m.y - 1), 32);
    EXPECT_EQ(luma(m.x, m.y + last + 1), 32);
    EXPECT_EQ(luma(m.x - StampLayout::kMarkerBorder - 1, m.y), 100);
  }
}

TEST(StampTest, TheMarkerMovesFourPixelsPerFieldAndReturns) {
  const auto start = marker_position(kLayout, 0);
  EXPECT_EQ(marker_position(kLayout, 1).x, start.x + 4);
  EXPECT_EQ(marker_position(kLayout, 47).x, start.x + 188);
  EXPECT_EQ(marker_position(kLayout, 48).x, start.x);
  EXPECT_EQ(marker_position(kLayout, 8).y, start.y + 16);
  EXPECT_EQ(marker_position(kLayout, 9).y, start.y + 14);
  EXPECT_EQ(marker_position(kLayout, 16).y, start.y);
}

TEST(StampTest, LevelsAvoidTheReservedCodesAndNeighboursStayUntouched) {
  const Picture p = stamped(65535);
  for (std::uint8_t v : p.uyvy) ASSERT_TRUE(v > 0 && v < 255);
  EXPECT_EQ(p.row(0)[1], 100);
  EXPECT_EQ(p.row(575)[1439], 100);
}

// The expected pictures are painted from the description in stamp.h, byte by byte.
class Painter {
 public:
  explicit Painter(const Picture& background) : picture(background) {}
  void rectangle(unsigned x, unsigned y, unsigned width, unsigned height, std::uint8_t luma) {
    for (unsigned v = y; v < y + height; ++v)
      for (unsigned u = x; u < x + width; ++u) {
        picture.uyvy[(v * picture.width + u) * 2] = 128;
        picture.uyvy[(v * picture.width + u) * 2 + 1] = luma;
      }
  }
  void digit(unsigned x, unsigned y, unsigned value) {
    static constexpr const char* kShapes[10][7] = {
        {" ### ", "#   #", "#  ##", "# # #", "##  #", "#   #", " ### "},
        {"  #  ", " ##  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "},
        {" ### ", "#   #", "    #", "  ## ", " #   ", "#    ", "#####"},
        {"#####", "   # ", "  #  ", "   # ", "    #", "#   #", " ### "},
        {"   # ", "  ## ", " # # ", "#  # ", "#####", "   # ", "   # "},
        {"#####", "#    ", "#### ", "    #", "    #", "#   #", " ### "},
        {"  ## ", " #   ", "#    ", "#### ", "#   #", "#   #", " ### "},
        {"#####", "    #", "   # ", "  #  ", " #   ", " #   ", " #   "},
        {" ### ", "#   #", "#   #", " ### ", "#   #", "#   #", " ### "},
        {" ### ", "#   #", "#   #", " ####", "    #", "   # ", " ##  "}};
    for (unsigned row = 0; row < 7; ++row)
      for (unsigned column = 0; column < 5; ++column)
        if (kShapes[value][row][column] == '#') rectangle(x + 3 * column, y + 3 * row, 3, 3, 220);
  }
  Picture picture;
};

/// The cells of field k, the first one in bit 23: the check bits are the remainder of the 15 bits
/// of the frame number and a start value of 0x5a, divided by x^7 + x^3 + 1.
unsigned cells_of(std::uint64_t k) {
  const auto number = static_cast<unsigned>(k % 65536);
  unsigned rest = (number >> 1) << 7 ^ 0x5au << 15;
  for (int bit = 21; bit >= 7; --bit)
    if (rest >> bit & 1) rest ^= 0x89u << (bit - 7);
  return number << 8 | rest << 1 | (number % 2 ? 0u : 1u);
}

TEST(StampTest, EveryPixelIsAsDescribed) {
  // Optical centre 372.4, 298.0: a code of 96x36 pixels and digits of 108x21 are centred above it,
  // 6 pixels apart and the lower 14 above it; the square's path of 192 pixels begins 60 below it.
  EXPECT_EQ(kLayout.code_x, 324u);
  EXPECT_EQ(kLayout.code_y, 220u);
  EXPECT_EQ(kLayout.digits_x, 318u);
  EXPECT_EQ(kLayout.digits_y, 262u);
  EXPECT_EQ(kLayout.marker_x, 268u);
  EXPECT_EQ(kLayout.marker_y, 358u);
  for (const std::uint64_t k : {0ull, 1ull, 9ull, 2469ull, 13579ull, 65535ull, 65536ull, 1975308ull,
                                1999999ull, 2000001ull}) {
    Painter expected(Picture(720, 576, 100, 90, 200));
    expected.rectangle(312, 214, 120, 75, 32);
    for (unsigned cell = 0; cell < 24; ++cell)
      if (cells_of(k) >> (23 - cell) & 1)
        expected.rectangle(324 + cell % 8 * 12, 220 + cell / 8 * 12, 12, 12, 220);
    std::uint64_t number = k / 2 % 1'000'000;
    for (unsigned place = 6; place-- > 0; number /= 10)
      expected.digit(318 + place * 18, 262, static_cast<unsigned>(number % 10));
    const auto x = static_cast<unsigned>(268 + k % 48 * 4);
    const auto down = static_cast<unsigned>(k % 16);
    const unsigned y = 358 + 2 * (down < 8 ? down : 16 - down);
    expected.rectangle(x - 6, y - 6, 28, 28, 32);
    expected.rectangle(x, y, 16, 16, 220);
    EXPECT_TRUE(stamped(k).uyvy == expected.picture.uyvy) << k;
  }
}

TEST(StampTest, ACellIsReadWithinAQuarterOfItsLevel) {
  // 32 and 220: up to 79 is dark, from 173 on is bright, and nothing between them is read.
  const auto with = [](unsigned cell, std::uint8_t luma) {
    Picture p = stamped(1234);
    for (unsigned y = 0; y < 12; ++y)
      for (unsigned x = 0; x < 12; ++x)
        p.row(kLayout.code_y + cell / 8 * 12 + y)[2 * (kLayout.code_x + cell % 8 * 12 + x) + 1] = luma;
    return p;
  };
  for (unsigned cell = 0; cell < 24; ++cell) {
    const bool bright = cells_of(1234) >> (23 - cell) & 1;
    EXPECT_EQ(decode_counter(with(cell, bright ? 173 : 79), kGrid), 1234) << cell;
    EXPECT_FALSE(decode_counter(with(cell, bright ? 172 : 80), kGrid)) << cell;
    const bool field = cell == 15 || cell == 23;
    EXPECT_EQ(decode_frame(with(cell, bright ? 173 : 79), kGrid), 617) << cell;
    EXPECT_EQ(decode_frame(with(cell, bright ? 172 : 80), kGrid).has_value(), field) << cell;
  }
}

TEST(StampTest, OnlyTheMiddleHalfOfACellIsRead) {
  // Pixels 3 to 8 of a cell's 12: what is outside does not count, each of these does.
  const Picture whole = stamped(1234);
  for (unsigned at = 0; at < 12; ++at) {
    Picture columns = whole, rows = whole;
    for (unsigned y = 0; y < 36; ++y)
      for (unsigned x = 0; x < 96; ++x) {
        const std::size_t luma = ((kLayout.code_y + y) * 720 + kLayout.code_x + x) * 2 + 1;
        // So bright or dark that the mean of six pixels leaves its quarter.
        const auto wrong = static_cast<std::uint8_t>(whole.uyvy[luma] > 126 ? 0 : 255);
        if (x % 12 == at) columns.uyvy[luma] = wrong;
        if (y % 12 == at) rows.uyvy[luma] = wrong;
      }
    const bool read = at >= 3 && at <= 8;
    // Five of 220 and one of 0 are 183, still bright; five of 32 and one of 255 are 69, still dark.
    EXPECT_EQ(decode_counter(columns, kGrid), 1234) << at;
    EXPECT_EQ(decode_counter(rows, kGrid), 1234) << at;
    if (at == 11) continue;
    for (unsigned y = 0; y < 36; ++y)
      for (unsigned x = 0; x < 96; ++x) {
        const std::size_t luma = ((kLayout.code_y + y) * 720 + kLayout.code_x + x) * 2 + 1;
        const auto wrong = static_cast<std::uint8_t>(whole.uyvy[luma] > 126 ? 0 : 255);
        if (x % 12 == at + 1) columns.uyvy[luma] = wrong;
        if (y % 12 == at + 1) rows.uyvy[luma] = wrong;
      }
    // Two of six: 146 and 106, which are neither. One of the two outside: as above.
    const bool both = read && at + 1 <= 8;
    EXPECT_EQ(decode_counter(columns, kGrid).has_value(), !both) << at;
    EXPECT_EQ(decode_counter(rows, kGrid).has_value(), !both) << at;
  }
}

TEST(StampTest, AGridBeyondThePictureIsNotRead) {
  const Picture whole = stamped(1234);
  Picture code(96, 36);
  for (unsigned y = 0; y < 36; ++y)
    std::copy_n(whole.row(kLayout.code_y + y) + 2 * kLayout.code_x, 192, code.row(y));
  // The middle half of a cell begins 2.5 pixel centres behind its edge.
  for (const double to : {-3.4, 3.4}) {
    EXPECT_EQ(decode_counter(code, CodeGrid(to, 0, 12, 12)), 1234) << to;
    EXPECT_EQ(decode_counter(code, CodeGrid(0, to, 12, 12)), 1234) << to;
  }
  for (const double to : {-3.5, 3.5}) {
    EXPECT_FALSE(decode_counter(code, CodeGrid(to, 0, 12, 12))) << to;
    EXPECT_FALSE(decode_counter(code, CodeGrid(0, to, 12, 12))) << to;
  }
}

TEST(StampTest, ACellWithoutARowOfTheFieldIsNotRead) {
  Picture code(8, 3);
  for (unsigned cell = 0; cell < 24; ++cell)
    code.row(cell / 8)[2 * (cell % 8) + 1] = cells_of(1234) >> (23 - cell) & 1 ? 220 : 32;
  const CodeGrid grid(0, 0, 1, 1);
  EXPECT_EQ(decode_counter(code, grid), 1234);
  EXPECT_FALSE(decode_counter(code, grid, Rows::kEven));
  EXPECT_FALSE(decode_counter(code, grid, Rows::kOdd));
}

// To each side of the centre half of the square's path and its border, 110 pixels; above it 6 to the
// picture's edge, the box of 75 without its lower border, and 14; below it 98 to the square's border.
// At the right and at the bottom two more, as positions are even.
TEST(StampTest, TheCentreMayBeAsCloseToAnEdgeAsTheMarksAllow) {
  const auto fits = [](double x, double y) {
    try {
      const StampLayout layout = StampLayout::at(640, 480, x, y);
      Picture p(640, 480);
      for (const std::uint64_t k : {0, 8, 47}) stamp(p, layout, k);
      return true;
    } catch (const UserError&) {
      return false;
    }
  };
  EXPECT_TRUE(fits(110, 240) && fits(528, 240));
  EXPECT_FALSE(fits(109.9, 240) || fits(528.1, 240));
  EXPECT_TRUE(fits(320, 83) && fits(320, 380));
  EXPECT_FALSE(fits(320, 82.9) || fits(320, 380.1));
  EXPECT_THROW(StampLayout::at(641, 480, 320, 240), UserError);
}

TEST(StampTest, SmallPicturesAreRefused) {
  EXPECT_THROW(StampLayout::at(160, 120, 80, 60), UserError);
  EXPECT_NO_THROW(StampLayout::at(640, 480, 319.5, 239.5));
  EXPECT_THROW(StampLayout::at(640, 480, 20, 239.5), UserError);
}

}  // namespace
}  // namespace fovea::video
