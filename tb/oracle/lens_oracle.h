// Independent oracle of the correction geometry, in double precision.
// Written from the text of the geometry (README of this folder), not from the lens library of the
// firmware; it shares no header with it or with the models.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fovea::oracle {

enum class Mapping {
  kNone,
  kRectilinear,
  kLinear,
  kOrthographic,
  kEquisolid,
  kStereographic,
  kTable,
  kKannalaBrandt
};

/// Which source pair an output pair takes: that of its first pixel's nearest source pixel (A, the
/// paper), or that of the position seen from the middle of the pair (B).
enum class PairMethod { kFirstPixel, kPairCentre };

/// Everything that decides the table. Lengths in pixels, angles in degrees unless said otherwise.
struct Geometry {
  Mapping mapping = Mapping::kEquisolid;
  PairMethod method = PairMethod::kFirstPixel;
  bool paper_literal_focal = false;  ///< equisolid only: f = W / (4 sin(FOV/2)), equation (10)
  unsigned width = 720, height = 576;
  std::uint32_t pitch_bytes = 1440;
  double fov_deg = 180;
  double focal_px = 0;                   ///< 0: from fov_deg
  double out_focal_px = 0;               ///< 0: as the lens
  double centre_x = 0, centre_y = 0;     ///< optical centre of the input, from the picture's centre
  double shift_x = 0, shift_y = 0;       ///< of the output view
  double in_aspect = 1, out_aspect = 1;  ///< y scale / x scale
  double theta_max = 0;         ///< radians, largest angle shown; 0: no limit (a table needs one)
  std::vector<double> table_r;  ///< kTable: x-pixels at i * theta_max / (size - 1)
  /// kKannalaBrandt: k1..k4 of R = focal_px theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 +
  /// k4 theta^8), the model of Kannala and Brandt (2006) as OpenCV's fisheye module writes it.
  std::array<double, 4> k{};
};

/// A position in the input picture, pixels, pixel centres at integers.
struct Position {
  double x = 0, y = 0;
};

/// @throws std::invalid_argument for a geometry that describes no lens
double lens_focal(const Geometry& g);
double output_focal(const Geometry& g);
/// R(theta) in x-pixels, theta in radians; nothing beyond theta_max.
std::optional<double> lens_radius(const Geometry& g, double theta);
/// Exact source of output position (u, v), which need not be whole; far away when it is invisible
/// (theta beyond theta_max).
Position source_position(const Geometry& g, double u, double v);

/// One entry as it has to be, and how firmly.
struct Expected {
  Position exact;
  std::uint32_t entry =
      0;                ///< byte offset of the source pair, or of the black pair behind the frame
  bool inside = false;  ///< in the picture and within theta_max
  /// Distance in pixels from the exact position to the nearest place where the entry changes.
  double margin = 0;
};
/// @param pair output column / 2
Expected expected_entry(const Geometry& g, unsigned pair, unsigned row);

struct WrongEntry {
  unsigned pair = 0, row = 0;
  std::uint32_t got = 0;
  Expected expected;
  std::string text() const;
};

struct LutCheck {
  std::size_t entries = 0;
  std::size_t wrong = 0;          ///< not what any position within the tolerance would give
  std::size_t near_boundary = 0;  ///< differs, but a position within the tolerance gives it
  std::size_t at_risk = 0;  ///< exact position within the tolerance of a boundary, equal or not
  std::optional<WrongEntry> first_wrong;
};
/// Compares a whole table, row by row, width / 2 entries each. A table of another size is wrong in
/// every entry missing or too many.
LutCheck check_lut(std::span<const std::uint32_t> lut, const Geometry& g,
                   double tolerance_px = 0.02);
/// The table as it has to be.
std::vector<std::uint32_t> build_lut(const Geometry& g);

}  // namespace fovea::oracle
