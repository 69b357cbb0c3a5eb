#include "model/video/scene/stamp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "model/common/check.h"

namespace fovea::video {
namespace {

constexpr std::uint8_t kDark = 32;
constexpr std::uint8_t kBright = 220;
/// Cells with a level between these belong to two fields at once, or are damaged.
constexpr int kSurelyDark = kDark + (kBright - kDark) / 4;
constexpr int kSurelyBright = kBright - (kBright - kDark) / 4;
constexpr std::uint8_t kNeutral = 128;
constexpr unsigned kQuiet = 6;  ///< dark border around code and digits, in pixels
constexpr unsigned kCells = StampLayout::kCodeColumns * StampLayout::kCodeRows;
constexpr unsigned kAllCells = (1u << kCells) - 1;
constexpr unsigned kFieldCells = 1u << 8 | 1u;  ///< bit 0 of the number and its complement
constexpr unsigned kCodeWidth = StampLayout::kCodeColumns * StampLayout::kCellPixels;
constexpr unsigned kCodeHeight = StampLayout::kCodeRows * StampLayout::kCellPixels;
constexpr unsigned kDigitPitch = 6 * StampLayout::kDigitScale;
constexpr unsigned kDigitHeight = 7 * StampLayout::kDigitScale;
constexpr unsigned kDigitsWidth = StampLayout::kDigits * kDigitPitch;
constexpr unsigned kBoxWidth = std::max(kCodeWidth, kDigitsWidth);
constexpr unsigned kMarkerRise = 16;  ///< vertical range of the marker, in pixels

/// 5x7 digits, one byte for each row, bit 4 is leftmost.
constexpr std::array<std::array<std::uint8_t, 7>, 10> kFont = {{
    {0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e},
    {0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e},
    {0x0e, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1f},
    {0x1f, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0e},
    {0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02},
    {0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e},
    {0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e},
    {0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08},
    {0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e},
    {0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c},
}};

/// CRC-7 (x^7 + x^3 + 1) over 15 bits; because of the start value, an all-dark picture is not a
/// code.
unsigned check_bits(unsigned frame) {
  unsigned crc = 0x5a;
  for (int bit = 14; bit >= 0; --bit) {
    const unsigned feedback = (crc >> 6 ^ frame >> bit) & 1;
    crc = (crc << 1 & 0x7f) ^ (feedback ? 0x09 : 0);
  }
  return crc;
}

/// What the check bits of a camera differ in from those of camera 0: sums modulo 2 of three patterns,
/// none of which, nor any sum of them, is what a single wrong cell changes in the check bits. Of the
/// 231 pairs of wrong cells, 7 turn a code into that of another camera.
unsigned camera_bits(unsigned camera) {
  return (camera & 1 ? 0x03u : 0) ^ (camera & 2 ? 0x34u : 0) ^ (camera & 4 ? 0x5Cu : 0);
}

/// The cells as a word, the first cell in bit 23.
unsigned code_word(std::uint16_t counter, unsigned camera) {
  return unsigned{counter} << 8 | (check_bits(counter >> 1) ^ camera_bits(camera)) << 1 |
         (~counter & 1u);
}

/// Fills a rectangle without colour; each pixel sets the chroma sample that is stored with it.
void fill(Picture& p, unsigned x, unsigned y, unsigned width, unsigned height, std::uint8_t luma) {
  for (unsigned row = y; row < y + height; ++row) {
    std::uint8_t* out = p.row(row) + std::size_t{x} * 2;
    for (unsigned i = 0; i < width; ++i, out += 2) {
      out[0] = kNeutral;
      out[1] = luma;
    }
  }
}

void draw_digits(Picture& picture, unsigned x, unsigned y, std::uint64_t number) {
  for (unsigned i = StampLayout::kDigits; i-- > 0; number /= 10) {
    const auto& glyph = kFont[number % 10];
    for (unsigned row = 0; row < 7; ++row)
      for (unsigned column = 0; column < 5; ++column)
        if (glyph[row] >> (4 - column) & 1)
          fill(picture, x + i * kDigitPitch + column * StampLayout::kDigitScale,
               y + row * StampLayout::kDigitScale, StampLayout::kDigitScale,
               StampLayout::kDigitScale, kBright);
  }
}

/// Mean luma of the middle part of a cell over the rows of a parity; -1 if it is outside the
/// picture or
/// contains no such row.
int cell_luma(const Picture& picture, const CodeGrid& grid, unsigned cell, Rows rows) {
  const double x0 = grid.x + (cell % StampLayout::kCodeColumns) * grid.cell_width;
  const double y0 = grid.y + (cell / StampLayout::kCodeColumns) * grid.cell_height;
  // Corner coordinates are pixel edges: pixel i covers i to i + 1. The middle half is read.
  const int left = static_cast<int>(std::ceil(x0 + grid.cell_width * 0.25 - 0.5));
  const int right = static_cast<int>(std::floor(x0 + grid.cell_width * 0.75 - 0.5));
  const int top = static_cast<int>(std::ceil(y0 + grid.cell_height * 0.25 - 0.5));
  const int bottom = static_cast<int>(std::floor(y0 + grid.cell_height * 0.75 - 0.5));
  if (left < 0 || top < 0 || right >= static_cast<int>(picture.width) ||
      bottom >= static_cast<int>(picture.height))
    return -1;
  int sum = 0, count = 0;
  for (int y = top; y <= bottom; ++y) {
    if (rows != Rows::kAll && (y & 1) != (rows == Rows::kOdd)) continue;
    for (int x = left; x <= right; ++x, ++count) sum += picture.row(y)[2 * x + 1];
  }
  return count ? sum / count : -1;
}

/// Reads the cells into a word; bits outside `needed` are not read and 0.
std::optional<unsigned> read_cells(const Picture& picture, const CodeGrid& grid, Rows rows,
                                   unsigned needed) {
  unsigned word = 0;
  for (unsigned cell = 0; cell < kCells; ++cell) {
    const unsigned bit = 1u << (kCells - 1 - cell);
    if (!(needed & bit)) continue;
    const int luma = cell_luma(picture, grid, cell, rows);
    if (luma < 0 || (luma > kSurelyDark && luma < kSurelyBright)) return std::nullopt;
    if (luma >= kSurelyBright) word |= bit;
  }
  return word;
}

unsigned even(double v) { return static_cast<unsigned>(v < 0 ? 0 : v) & ~1u; }

}  // namespace

StampLayout StampLayout::at(unsigned width, unsigned height, double centre_x, double centre_y) {
  const double total_height = kCodeHeight + kQuiet + kDigitHeight;
  const double top = centre_y - 8 - kQuiet - total_height;
  const double bottom = centre_y + 60 + kMarkerRise + kMarkerPixels + kMarkerBorder;
  const double left = centre_x - (kMarkerSpan + kMarkerPixels) / 2.0 - kMarkerBorder;
  const double right = centre_x + (kMarkerSpan + kMarkerPixels) / 2.0 + kMarkerBorder;
  if (top < kQuiet || bottom + 2 > height || left < 0 || right + 2 > width || width % 2 != 0)
    throw UserError(
        "the lens centre (" + std::to_string(std::lround(centre_x)) + ", " +
        std::to_string(std::lround(centre_y)) + ") is too close to the edge of the " +
        std::to_string(width) + "x" + std::to_string(height) +
        " raster for the frame counter, which needs an even width and 112 px to each "
        "side, 84 above, 100 below: does the lens (camera.kb, camera.calibration) belong "
        "to this picture? camera.stamp=false leaves the counter out");
  StampLayout s;
  s.code_x = even(centre_x + 0.5 - kCodeWidth / 2.0);
  s.code_y = even(top);
  s.digits_x = even(centre_x + 0.5 - kDigitsWidth / 2.0);
  s.digits_y = s.code_y + kCodeHeight + kQuiet;
  s.marker_x = even(left + kMarkerBorder);
  s.marker_y = even(centre_y + 60);
  return s;
}

MarkerPosition marker_position(const StampLayout& layout, std::uint64_t k) {
  const unsigned across =
      static_cast<unsigned>(k % (StampLayout::kMarkerSpan / StampLayout::kMarkerStep));
  const unsigned phase = static_cast<unsigned>(k % 16);
  const unsigned down = phase < 8 ? phase : 16 - phase;
  return {layout.marker_x + across * StampLayout::kMarkerStep, layout.marker_y + down * 2};
}

void stamp(Picture& picture, const StampLayout& layout, std::uint64_t k, unsigned camera) {
  FOVEA_CHECK(camera < kStampCameras, "a stamp has room for eight cameras");
  fill(picture, std::min(layout.code_x, layout.digits_x) - kQuiet, layout.code_y - kQuiet,
       kBoxWidth + 2 * kQuiet, kCodeHeight + 3 * kQuiet + kDigitHeight, kDark);
  const unsigned word = code_word(static_cast<std::uint16_t>(k), camera);
  for (unsigned cell = 0; cell < kCells; ++cell) {
    if (!(word >> (kCells - 1 - cell) & 1)) continue;
    fill(picture, layout.code_x + cell % StampLayout::kCodeColumns * StampLayout::kCellPixels,
         layout.code_y + cell / StampLayout::kCodeColumns * StampLayout::kCellPixels,
         StampLayout::kCellPixels, StampLayout::kCellPixels, kBright);
  }
  constexpr std::uint64_t kCameraDigit = 100'000;
  draw_digits(picture, layout.digits_x, layout.digits_y, k / 2 + camera * kCameraDigit);

  const MarkerPosition m = marker_position(layout, k);
  constexpr unsigned kBorder = StampLayout::kMarkerBorder;
  fill(picture, m.x - kBorder, m.y - kBorder, StampLayout::kMarkerPixels + 2 * kBorder,
       StampLayout::kMarkerPixels + 2 * kBorder, kDark);
  fill(picture, m.x, m.y, StampLayout::kMarkerPixels, StampLayout::kMarkerPixels, kBright);
}

CodeGrid::CodeGrid(const StampLayout& layout)
    : x(layout.code_x),
      y(layout.code_y),
      cell_width(StampLayout::kCellPixels),
      cell_height(StampLayout::kCellPixels) {}

std::optional<StampCode> decode_stamp(const Picture& picture, const CodeGrid& grid, Rows rows) {
  const auto word = read_cells(picture, grid, rows, kAllCells);
  if (!word) return std::nullopt;
  StampCode code{static_cast<std::uint16_t>(*word >> 8), 0};
  for (; code.camera < kStampCameras; ++code.camera)
    if (code_word(code.field, code.camera) == *word) return code;
  return std::nullopt;
}

std::optional<std::uint16_t> decode_counter(const Picture& picture, const CodeGrid& grid,
                                            Rows rows) {
  const auto code = decode_stamp(picture, grid, rows);
  return code && code->camera == 0 ? std::optional(code->field) : std::nullopt;
}

std::optional<std::uint16_t> decode_frame(const Picture& picture, const CodeGrid& grid) {
  const auto word = read_cells(picture, grid, Rows::kAll, kAllCells & ~kFieldCells);
  if (!word) return std::nullopt;
  const unsigned frame = *word >> 9;
  if (check_bits(frame) != (*word >> 1 & 0x7f)) return std::nullopt;
  return static_cast<std::uint16_t>(frame);
}

}  // namespace fovea::video
