#include "sw/fovea/limits/value_range.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "sw/fovea/files/checked_file.h"

namespace fovea::limits {
namespace {

constexpr std::uint64_t kSteps = 64;

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
  throw UserError(fmt::format("--find '{}': {}", app::one_line(text), why));
}

/// A quantity of the same unit without limits, to read a step and to write values.
struct Quantity : ParamGroup {
  Quantity(IntParam::Unit unit)
      : ParamGroup("step"),
        whole(*this, "whole", unit, 0, 0, ~std::uint64_t{0}, "", Origin::kChoice, ""),
        real(*this, "real", "", 0, -1e300, 1e300, "", Origin::kChoice, "") {}
  IntParam whole;
  RealParam real;
};

}  // namespace

struct UnitName {
  const char* name;
  IntParam::Unit unit;
  const char* smallest;
};

namespace {

constexpr const char* kOrder = "the first end must be below the second one";
constexpr const char* kNoStep = "a step above 0 is needed";

template <class Param>
void read_step(const std::string& text, Param& value, const std::string& step) {
  try {
    value.set(step);
  } catch (const UserError& e) {
    refuse(text, fmt::format("step: {}", e.what()));
  }
}

constexpr UnitName kUnits[] = {{"count", IntParam::Unit::kCount, ""},
                               {"cycles", IntParam::Unit::kCycles, "cycles"},
                               {"bytes", IntParam::Unit::kBytes, "B"},
                               {"time", IntParam::Unit::kTime, "ps"},
                               {"frequency", IntParam::Unit::kHertz, "Hz"}};

const UnitName& unit_of(const std::string& name) {
  for (const UnitName& u : kUnits)
    if (name == u.name) return u;
  FOVEA_CHECK(false, "a unit that the table of units lacks: " + name);
}

}  // namespace

ValueRange::ValueRange(const ParamSet& params, const std::string& text) {
  const auto equals = text.find('='), dots = text.find("..", equals == text.npos ? 0 : equals);
  if (equals == text.npos || equals == 0 || dots == text.npos)
    refuse(text, "allowed: KEY=LOW..HIGH or KEY=LOW..HIGH:STEP");
  key_ = text.substr(0, equals);
  const std::string low = text.substr(equals + 1, dots - equals - 1);
  std::string high = text.substr(dots + 2), step;
  if (const auto colon = high.find(':'); colon != high.npos) {
    step = high.substr(colon + 1);
    high.resize(colon);
  }
  ParamBase* const param = params.find(key_);
  if (!param) {
    const std::string near = params.nearest(key_);
    refuse(text, "unknown key" + (near.empty() ? std::string("; 'fovea params' lists all keys")
                                               : "; did you mean '" + near + "'?"));
  }
  const auto* const whole = dynamic_cast<const IntParam*>(param);
  const auto* const real = dynamic_cast<const RealParam*>(param);
  if (!whole && !real)
    refuse(text, fmt::format("'{}' has no numbers but: {}; --over tries words", key_, param->allowed()));
  whole_ = whole != nullptr;
  const auto end = [&, before = param->text()](const std::string& value, auto& typed) {
    try {
      param->set(value);
    } catch (const UserError& e) {
      refuse(text, fmt::format("key '{}': {}", key_, e.what()));
    }
    const auto read = typed();
    param->set(before);
    return read;
  };
  if (whole_)
    set_whole(text, unit_of(param->unit()), end(low, *whole), end(high, *whole), step);
  else
    set_real(text, param->unit(), end(low, *real), end(high, *real), step);
  if (last_ == 0) refuse(text, "the step is larger than the range");
}

void ValueRange::set_whole(const std::string& text, const UnitName& unit, std::uint64_t low, std::uint64_t high,
                           const std::string& step) {
  if (!(low < high)) refuse(text, kOrder);
  unit_ = unit.smallest;
  low_ = low;
  const bool by_one = unit_.empty() || unit_ == "cycles";
  step_ = by_one ? 1 : std::max<std::uint64_t>(1, (high - low) / kSteps);
  if (!step.empty()) {
    Quantity q(unit.unit);
    read_step(text, q.whole, step);
    step_ = q.whole();
  }
  if (step_ == 0) refuse(text, kNoStep);
  last_ = (high - low) / step_;
}

void ValueRange::set_real(const std::string& text, const std::string& unit, double low, double high,
                          const std::string& step) {
  if (!(low < high)) refuse(text, kOrder);
  unit_ = unit;
  real_low_ = low;
  real_step_ = (high - low) / kSteps;
  if (!step.empty()) {
    if (!step.ends_with(unit_)) refuse(text, fmt::format("the step needs the unit '{}'", unit_));
    Quantity q(IntParam::Unit::kCount);
    read_step(text, q.real, step.substr(0, step.size() - unit_.size()));
    real_step_ = q.real();
  }
  if (!(real_step_ > 0)) refuse(text, kNoStep);
  const double steps = std::floor((high - low) / real_step_ * (1 + 1e-12));
  if (steps > 1e9) refuse(text, "more than 1e9 steps");
  last_ = static_cast<std::uint64_t>(steps);
}

std::string ValueRange::format(std::uint64_t whole, double real) const {
  if (!whole_) return fmt::format("{:.12g}{}", real, unit_);
  for (const UnitName& u : kUnits)
    if (unit_ == u.smallest) {
      Quantity q(u.unit);
      q.whole.set(fmt::format("{} {}", whole, unit_));
      return q.whole.text();
    }
  return "";
}

std::string ValueRange::text(std::uint64_t n) const {
  return format(low_ + n * step_, real_low_ + static_cast<double>(n) * real_step_);
}
std::string ValueRange::step_text() const { return format(step_, real_step_); }

}  // namespace fovea::limits
