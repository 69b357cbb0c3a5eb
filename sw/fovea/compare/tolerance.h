// How far a figure may lie from another one.
#pragma once
#include <string>
#include <string_view>

namespace fovea::regression {

/// A deviation is allowed up to the larger of the two. Zero demands the same number.
struct Tolerance {
  double absolute = 0;  ///< in the unit of the figure
  double relative = 0;  ///< of the expected value

  /// The deviation that is allowed of `expected`.
  double allowed(double expected) const;
  /// "1 %", "0.5 MB/s", "1 % or 0.5 MB/s"; "none" for zero. `unit` is the figure's, if there is one.
  std::string text(const std::string& unit = "") const;
};

/// Reads "1%", "0.5" or "1% or 0.5". `where` begins the message. @throws UserError: not a number,
/// negative, infinite, or the same kind twice
Tolerance parse_tolerance(std::string_view text, const std::string& where);

enum class Deviation { kWithin, kHigher, kLower };
/// Compares a value with an expected one. At the limit it is still within; `whole` is true for two
/// counts, which are compared exactly, while the limit of other numbers has room for their rounding
/// to double precision (2^-51 of the larger one) unless the tolerance is zero.
Deviation deviation_of(double value, double expected, const Tolerance& tolerance, bool whole);

}  // namespace fovea::regression
