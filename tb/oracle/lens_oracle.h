// Independent oracle of the correction geometry, in double precision. Written from the description
// in this folder's README and not from the firmware's lens library; it shares no header with that
// or the models.
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

/// Source of an output pair: the pair that contains the source pixel nearest to that of its first
/// pixel (A, the paper), or to that of the pair's centre (B).
enum class PairMethod { kFirstPixel, kPairCentre };

/// Everything that determines the table. Lengths in pixels, angles in degrees unless stated
/// otherwise.
struct Geometry {
  Mapping mapping = Mapping::kEquisolid;
  PairMethod method = PairMethod::kFirstPixel;
  bool paper_literal_focal = false;  ///< equisolid only: f = W / (4 sin(FOV/2)), equation (10)
  unsigned width = 720, height = 576;                ///< of the result
  unsigned source_width = 0, source_height = 0;      ///< of the camera's picture; 0: those of the result
  std::uint32_t pitch_bytes = 1440;                  ///< of both
  double fov_deg = 180;
  double focal_px = 0;                   ///< 0: from fov_deg
  double out_focal_px = 0;               ///< 0: that of the lens
  double centre_x = 0, centre_y = 0;     ///< optical centre of the input, relative to the picture's
                                         ///< centre
  double shift_x = 0, shift_y = 0;       ///< shift of the output view
  double in_aspect = 1, out_aspect = 1;  ///< y scale / x scale
  double theta_max = 0;         ///< radians, largest angle shown; 0: no limit (a table needs one)
  std::vector<double> table_r;  ///< kTable: x-pixels at i * theta_max / (size - 1)
  /// kKannalaBrandt: k1..k4 of R = focal_px theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 +
  /// k4 theta^8), the model of Kannala and Brandt (2006) as OpenCV's fisheye module writes it.
  std::array<double, 4> k{};
};

/// A position in the input picture in pixels, with pixel centres at integers.
struct Position {
  double x = 0, y = 0;
};

/// Focal length in px. @throws std::invalid_argument for a geometry that is not a lens
double lens_focal(const Geometry& g);
double output_focal(const Geometry& g);
/// R(theta) in x-pixels, theta in radians; empty beyond theta_max.
std::optional<double> lens_radius(const Geometry& g, double theta);
/// Exact source of the output position (u, v), which may be fractional; far outside if it is
/// invisible (theta beyond theta_max).
Position source_position(const Geometry& g, double u, double v);

/// The expected value of an entry, and how far it is from changing.
struct Expected {
  Position exact;
  std::uint32_t entry =
      0;                ///< byte offset of the source pair, or of the black pair behind the frame
  bool inside = false;  ///< in the picture and within theta_max
  /// Distance in pixels from the exact position to the nearest one at which the entry changes.
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
  std::size_t wrong = 0;          ///< not the value of any position within the tolerance
  std::size_t near_boundary = 0;  ///< different, but the value of a position within the tolerance
  std::size_t at_risk = 0;  ///< exact position within the tolerance of a boundary, whether equal or
                            ///< not
  std::optional<WrongEntry> first_wrong;
};
/// Compares a whole table, row by row, width / 2 entries per row. In a table of another size, every
/// missing or additional entry is wrong.
LutCheck check_lut(std::span<const std::uint32_t> lut, const Geometry& g,
                   double tolerance_px = 0.02);
/// The expected table.
std::vector<std::uint32_t> build_lut(const Geometry& g);

}  // namespace fovea::oracle
