// Marks drawn into every camera picture, so that order, repeats and field parity can be read back
// from pixels alone: a block code, the frame number as digits, and a moving square.
#pragma once
#include <cstdint>
#include <optional>

#include "model/video/core/picture.h"

namespace fovea::video {

/// Which rows of a picture a reader looks at. A woven frame holds two fields: one per parity.
enum class Rows { kAll, kEven, kOdd };

/// Where the marks are. The block code is kCodeRows x kCodeColumns cells: the 16 bits of the field
/// number (most significant first, row by row), 7 check bits, and the complement of bit 0. The
/// check covers bits 15..1 only, so that the two fields 2n and 2n+1 of one frame differ in no cell
/// but the two of bit 0: the frame number n also survives a remap that mixes the rows of both.
struct StampLayout {
  static constexpr unsigned kCodeColumns = 8;
  static constexpr unsigned kCodeRows = 3;
  static constexpr unsigned kCellPixels = 12;    ///< width and height of a cell
  static constexpr unsigned kDigits = 6;         ///< decimal, of field number / 2
  static constexpr unsigned kDigitScale = 3;     ///< of the 5x7 font
  static constexpr unsigned kMarkerPixels = 16;  ///< the bright square, without its border
  static constexpr unsigned kMarkerBorder = 6;
  static constexpr unsigned kMarkerStep = 4;    ///< pixels to the right per field
  static constexpr unsigned kMarkerSpan = 192;  ///< then it starts again

  unsigned code_x = 0, code_y = 0;      ///< top left cell corner; even
  unsigned digits_x = 0, digits_y = 0;  ///< top left corner of the first digit; even
  unsigned marker_x = 0, marker_y = 0;  ///< the square's top left corner in field 0; even

  /// Code centred above the optical centre, digits under it, marker path below the centre.
  /// @throws UserError when the marks do not fit (pictures under about 240x200)
  static StampLayout at(unsigned width, unsigned height, double centre_x, double centre_y);
};

struct MarkerPosition {
  unsigned x = 0, y = 0;  ///< top left corner of the bright square
};

/// Where the moving square is in field k: 4 px to the right per field, 192 px then back to the
/// start; 2 px down per field for 8 fields, then up again.
MarkerPosition marker_position(const StampLayout& layout, std::uint64_t k);

/// Draws the marks of field k. Levels 32 and 220 luma, no colour.
void stamp(Picture& picture, const StampLayout& layout, std::uint64_t k);

/// The block code in any picture: x, y of the top left cell's corner and the size of a cell in
/// pixels. Near the optical centre a remap only shifts and scales, so the code stays a grid.
struct CodeGrid {
  double x = 0, y = 0, cell_width = 0, cell_height = 0;
  explicit CodeGrid(const StampLayout& layout);
  CodeGrid(double x0, double y0, double w, double h)
      : x(x0), y(y0), cell_width(w), cell_height(h) {}
};

/// Reads the field number modulo 65536 from the rows given. Nothing when the code is not there,
/// damaged, or when the rows hold two fields.
std::optional<std::uint16_t> decode_counter(const Picture& picture, const CodeGrid& grid,
                                            Rows rows = Rows::kAll);

/// Reads field number / 2, without looking at bit 0: for pictures woven from fields 2n and 2n+1,
/// also after a remap. Nothing when the code is not there or damaged.
std::optional<std::uint16_t> decode_frame(const Picture& picture, const CodeGrid& grid);

}  // namespace fovea::video
