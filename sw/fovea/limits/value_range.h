// The values of a numeric key between two ends, in steps.
#pragma once
#include <cstdint>
#include <string>

#include "model/common/param.h"

namespace fovea::limits {

struct UnitName;

class ValueRange {
 public:
  /// `text` is KEY=LOW..HIGH or KEY=LOW..HIGH:STEP, each with its unit. Without a step, counts and
  /// clock cycles go by one, other quantities by a 64th of the range (at least their smallest unit).
  /// @throws UserError if the key is unknown or has no numbers, or for an end that is not allowed
  ValueRange(const ParamSet& params, const std::string& text);

  const std::string& key() const { return key_; }
  /// Number of the last value; the first one is 0.
  std::uint64_t last() const { return last_; }
  /// A value as a parameter takes it.
  std::string text(std::uint64_t n) const;
  /// key=value.
  std::string setting(std::uint64_t n) const { return key_ + "=" + text(n); }
  /// The distance of two values.
  std::string step_text() const;

 private:
  std::string key_, unit_;
  bool whole_ = false;
  std::uint64_t low_ = 0, step_ = 1;          // whole numbers: in ps, bytes, Hz
  double real_low_ = 0, real_step_ = 0;
  std::uint64_t last_ = 0;
  std::string format(std::uint64_t whole, double real) const;
  /// @throws UserError that cites `text` if the ends are out of order or the step fits no value
  void set_whole(const std::string& text, const UnitName& unit, std::uint64_t low, std::uint64_t high,
                 const std::string& step);
  void set_real(const std::string& text, const std::string& unit, double low, double high,
                const std::string& step);
};

}  // namespace fovea::limits
