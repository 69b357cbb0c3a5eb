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

TEST(StampTest, SmallPicturesAreRefused) {
  EXPECT_THROW(StampLayout::at(160, 120, 80, 60), UserError);
  EXPECT_NO_THROW(StampLayout::at(640, 480, 319.5, 239.5));
  EXPECT_THROW(StampLayout::at(640, 480, 20, 239.5), UserError);
}

}  // namespace
}  // namespace fovea::video
