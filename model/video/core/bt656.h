// ITU-R BT.656: the lines and fields of both standards as data, timing reference codes, whole
// lines.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "model/common/units.h"

namespace fovea::video {

inline constexpr unsigned kActiveBytes = 1440;  ///< 720 Y, 360 Cb, 360 Cr
inline constexpr unsigned kActivePixels = 720;
inline constexpr unsigned kCodeBytes = 4;  ///< FF 00 00 XY
inline constexpr unsigned kMaxActiveBytes = 1600;  ///< of all rasters here
inline constexpr unsigned kMaxLineBytes = 2112;
/// The byte clock of both television standards, 27 MHz [ITU-R BT.656].
inline constexpr Frequency kByteClock{27'000'000};

/// The raster of a standard. Lines are numbered from 1, as in the standard. A line starts with its
/// EAV, so its active samples are its last active_bytes(). Source of the interlaced ones: TI SPRU629
/// table 4-2, ITU-R BT.601.
struct Standard {
  struct Lines {
    unsigned first, last;
    bool f, v;
  };
  std::string_view name;
  unsigned lines;                        ///< per frame
  unsigned line_bytes;                   ///< periods of the byte clock per line
  std::array<Lines, 6> fv;               ///< ranges of lines with equal F and V
  std::array<unsigned, 2> field_start;   ///< lines at which F becomes 0 and 1
  std::array<unsigned, 2> active_first;  ///< first line with V = 0, for F = 0 and 1
  std::array<unsigned, 2> active_count;  ///< number of lines with V = 0, for F = 0 and 1
  unsigned rows;                         ///< rows of the usual picture (576 or 480)
  unsigned sync_line[2];                 ///< first line after the start of the vertical sync, for F
                                         ///< = 0 and 1
  unsigned active_pixels = kActivePixels;  ///< of a line
  bool progressive = false;  ///< each frame is one field, with F = 0 (as in ITU-R BT.1358)
  Frequency clock = kByteClock;  ///< nominal byte clock

  constexpr unsigned active_bytes() const { return 2 * active_pixels; }
  constexpr unsigned active_offset() const { return line_bytes - active_bytes(); }
  /// The line in the middle of a field's active lines.
  constexpr unsigned middle(bool f) const { return active_first[f] + active_count[f] / 2; }
  constexpr unsigned frame_bytes() const { return lines * line_bytes; }
  /// At the nominal byte clock: 25 Hz or 30000/1001 Hz.
  constexpr Frequency frame_rate() const { return clock / frame_bytes(); }
  /// F and V of a line (1 to `lines`).
  constexpr const Lines& at(unsigned line) const {
    for (const Lines& l : fv)
      if (line >= l.first && line <= l.last) return l;
    return fv.back();
  }
};

inline constexpr Standard k625{"625/50",
                               625,
                               1728,
                               {{{1, 22, false, true},
                                 {23, 310, false, false},
                                 {311, 312, false, true},
                                 {313, 335, true, true},
                                 {336, 623, true, false},
                                 {624, 625, true, true}}},
                               {1, 313},
                               {23, 336},
                               {288, 288},
                               576,
                               {1, 314}};
inline constexpr Standard k525{"525/60",
                               525,
                               1716,
                               {{{1, 3, true, true},
                                 {4, 19, false, true},
                                 {20, 263, false, false},
                                 {264, 265, false, true},
                                 {266, 282, true, true},
                                 {283, 525, true, false}}},
                               {4, 266},
                               {20, 283},
                               {244, 243},
                               480,
                               {4, 267}};

/// Progressive cameras with embedded timing codes, at the digital port. The 480 rows are the last ones of the
/// 483 active lines of a 525-line progressive raster (ITU-R BT.1358, 858 x 525 samples of luma), which is sent at
/// half that standard's rate, so that 27 MHz are enough. 800 x 600 has the totals of VESA's DMT (1056 x 628, four
/// lines of sync, 23 and 1 blank) and the clock that gives 25 frames/s. Which raster and clock a sensor has is set in
/// its registers: these two are assumed, and the clock is a parameter.
inline constexpr Standard k480p{"640x480 progressive",
                                525,
                                1716,
                                {{{1, 45, false, true}, {46, 525, false, false}}},
                                {1, 1},
                                {46, 46},
                                {480, 480},
                                480,
                                {1, 1},
                                640,
                                true,
                                kByteClock};
inline constexpr Standard k600p{"800x600 progressive",
                                628,
                                2112,
                                {{{1, 27, false, true}, {28, 627, false, false}, {628, 628, false, true}}},
                                {1, 1},
                                {28, 28},
                                {600, 600},
                                600,
                                {1, 1},
                                800,
                                true,
                                Frequency(33'158'400)};

/// The standard that a register value or a picture height selects.
constexpr const Standard& standard_of(bool is_625) { return is_625 ? k625 : k525; }

/// Fourth byte of a timing reference code: 1 F V H P3 P2 P1 P0.
constexpr std::uint8_t encode_xy(bool f, bool v, bool h) {
  return static_cast<std::uint8_t>(0x80 | f << 6 | v << 5 | h << 4 | (v != h) << 3 | (f != h) << 2 |
                                   (f != v) << 1 | ((f != v) != h));
}

struct XyCode {
  enum class Quality { kGood, kCorrected, kBad } quality;
  bool f, v, h;
};
/// Decodes the byte and corrects any single wrong bit. Two wrong bits give kBad, with F, V, H as
/// received.
XyCode decode_xy(std::uint8_t byte);

/// Position of a line that is counted continuously from the start of a field 1 (F = 0).
struct LinePosition {
  std::uint64_t field;  ///< consecutive number; interlaced: even fields have F = 0
  unsigned line;        ///< number in the standard, 1 to `lines`
};
constexpr LinePosition locate(const Standard& s, std::uint64_t n) {
  const unsigned pos = static_cast<unsigned>(n % s.lines);
  if (s.progressive) return {n / s.lines, pos + 1};
  const unsigned first_field = s.field_start[1] - s.field_start[0];
  return {2 * (n / s.lines) + (pos >= first_field), (s.field_start[0] - 1 + pos) % s.lines + 1};
}
/// Index of the first line of the field with a consecutive number.
constexpr std::uint64_t first_line_of_field(const Standard& s, std::uint64_t field) {
  if (s.progressive) return field * s.lines;
  return field / 2 * s.lines + (field % 2 ? s.field_start[1] - s.field_start[0] : 0);
}

/// Assigns rows of a picture to lines: line first_line[F] + i carries row first_row[F] + 2 i.
struct Placement {
  std::array<unsigned, 2> first_line, first_row;
  unsigned rows;
  /// The row on a line of field F, or -1 if the line carries none.
  constexpr int row(bool f, unsigned line) const {
    if (line < first_line[f]) return -1;
    const unsigned r = first_row[f] + 2 * (line - first_line[f]);
    return r < rows ? static_cast<int>(r) : -1;
  }
};
/// 625/50: row 0 on line 23, row 1 on line 336.
inline constexpr Placement kPlacement625{{23, 336}, {0, 1}, 576};
/// 525/60 from the first active line of each field: row 0 on line 20, row 1 on line 283. A capture
/// with equal first lines (SLV0 = SLV1) interleaves the fields in this way.
inline constexpr Placement kPlacement525{{20, 283}, {0, 1}, 480};
/// The same with 486 rows: all lines of the second field that are not blanked, and as many of the first one.
inline constexpr Placement kPlacement525All{{20, 283}, {0, 1}, 486};
/// 525/60, the 480 lines of studio practice: row 0 on line 285 (field 2), row 1 on line 23, so the
/// field that is first in time holds the odd rows.
inline constexpr Placement kPlacement525Studio{{23, 285}, {1, 0}, 480};

/// Writes a whole line to `out` (standard.line_bytes bytes): EAV, blanking 80 10, SAV, then
/// `active` (standard.active_bytes() bytes), or blanking if `active` is null.
void compose_line(const Standard& standard, std::uint8_t eav_xy, std::uint8_t sav_xy,
                  const std::uint8_t* active, std::span<std::uint8_t> out);

}  // namespace fovea::video
