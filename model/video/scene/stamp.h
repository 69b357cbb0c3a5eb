// Marks drawn into every camera picture, from whose pixels the order, repetition and parity of
// fields can be read: a block code, the frame number as digits, and a moving square.
#pragma once
#include <cstdint>
#include <optional>

#include "model/video/core/picture.h"

namespace fovea::video {

/// The rows of a picture that are read. An interlaced frame holds two fields, one for each parity.
enum class Rows { kAll, kEven, kOdd };

/// Positions of the marks. The block code has kCodeRows x kCodeColumns cells: the 16 bits of the
/// field number (most significant first, row by row), 7 check bits, and the complement of bit 0.
/// The check bits cover only bits 15 to 1, so the fields 2n and 2n+1 of a frame differ only in the
/// two cells of bit 0, and the frame number n can be read even after a remap that mixes the rows of
/// both.
///
/// The check bits also name the camera: those of cameras 1 to 7 differ from camera 0's in a pattern
/// of their own. One wrong cell never turns a code into another one, of whatever camera. The first
/// of the digits is the camera's number too.
struct StampLayout {
  static constexpr unsigned kCodeColumns = 8;
  static constexpr unsigned kCodeRows = 3;
  static constexpr unsigned kCellPixels = 12;    ///< width and height of a cell
  static constexpr unsigned kDigits = 6;         ///< decimal digits of field number / 2
  static constexpr unsigned kDigitScale = 3;     ///< magnification of the 5x7 font
  static constexpr unsigned kMarkerPixels = 16;  ///< the bright square, without its border
  static constexpr unsigned kMarkerBorder = 6;
  static constexpr unsigned kMarkerStep = 4;    ///< movement to the right per field, in pixels
  static constexpr unsigned kMarkerSpan = 192;  ///< pixels until it starts again

  unsigned code_x = 0, code_y = 0;      ///< top left corner of the first cell; even
  unsigned digits_x = 0, digits_y = 0;  ///< top left corner of the first digit; even
  unsigned marker_x = 0, marker_y = 0;  ///< top left corner of the square in field 0; even

  /// Places the code above the optical centre, the digits below it, and the square's path below the
  /// centre. @throws UserError if the marks do not fit (pictures smaller than about 240x200)
  static StampLayout at(unsigned width, unsigned height, double centre_x, double centre_y);
};

struct MarkerPosition {
  unsigned x = 0, y = 0;  ///< top left corner of the bright square
};

/// Position of the moving square in field k: 4 pixels to the right per field for 192 pixels, then
/// again from the start; 2 pixels down per field for 8 fields, then up again.
MarkerPosition marker_position(const StampLayout& layout, std::uint64_t k);

/// Number of cameras that a stamp can tell apart.
inline constexpr unsigned kStampCameras = 8;

/// Draws the marks of field k, with luma levels 32 and 220 and without colour. `camera` is less than
/// kStampCameras.
void stamp(Picture& picture, const StampLayout& layout, std::uint64_t k, unsigned camera = 0);

/// Where to read the block code in a picture: the top left corner of the first cell and the size of
/// a cell in pixels. Near the optical centre a remap only shifts and scales, so the code remains a
/// grid.
struct CodeGrid {
  double x = 0, y = 0, cell_width = 0, cell_height = 0;
  explicit CodeGrid(const StampLayout& layout);
  CodeGrid(double x0, double y0, double w, double h)
      : x(x0), y(y0), cell_width(w), cell_height(h) {}
};

/// What a block code says.
struct StampCode {
  std::uint16_t field = 0;  ///< number modulo 65536
  unsigned camera = 0;
};

/// Reads the code from the given rows. Empty if it is missing or damaged, or if the rows belong to
/// two fields.
std::optional<StampCode> decode_stamp(const Picture& picture, const CodeGrid& grid,
                                      Rows rows = Rows::kAll);

/// The field number of such a code of camera 0; empty for other cameras too.
std::optional<std::uint16_t> decode_counter(const Picture& picture, const CodeGrid& grid,
                                            Rows rows = Rows::kAll);

/// Reads field number / 2 without the cells of bit 0, for pictures made of fields 2n and 2n+1, even
/// after a remap. Empty if the code is missing or damaged.
std::optional<std::uint16_t> decode_frame(const Picture& picture, const CodeGrid& grid);

}  // namespace fovea::video
