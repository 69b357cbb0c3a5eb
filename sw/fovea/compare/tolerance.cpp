#include "sw/fovea/compare/tolerance.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::regression {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

}  // namespace

double Tolerance::allowed(double expected) const {
  return std::max(absolute, relative * std::abs(expected));
}

std::string Tolerance::text(const std::string& unit) const {
  if (absolute == 0 && relative == 0) return "none";
  std::string out;
  if (relative != 0) out = fmt::format("{} %", app::number_text(100 * relative));
  if (absolute != 0) {
    const bool plain = unit.empty() || unit == "1" || unit == "ratio";
    out += (out.empty() ? "" : " or ") + app::number_text(absolute) + (plain ? "" : " " + unit);
  }
  return out;
}

Tolerance parse_tolerance(std::string_view text, const std::string& where) {
  constexpr std::string_view kOr = " or ";
  Tolerance out;
  bool absolute = false, relative = false;
  const auto wrong = [&] {
    throw UserError(fmt::format("{}: '{}' is not a tolerance; allowed: a share such as 1%, a number "
                                "in the figure's unit, or both: '1% or 2'",
                                where, app::one_line(text, 60)));
  };
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = rest.find(kOr);
    std::string_view part = trimmed(rest.substr(0, end));
    rest = end == rest.npos ? std::string_view() : rest.substr(end + kOr.size());
    const bool share = part.ends_with('%');
    if (share) part = trimmed(part.substr(0, part.size() - 1));
    double value = 0;
    const auto [last, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc{} || last != part.data() + part.size() || !std::isfinite(value) ||
        value < 0 || (share ? relative : absolute))
      wrong();
    (share ? out.relative : out.absolute) = share ? value / 100 : value;
    (share ? relative : absolute) = true;
  }
  if (!absolute && !relative) wrong();
  return out;
}

Deviation deviation_of(double value, double expected, const Tolerance& tolerance, bool whole) {
  const double limit = tolerance.allowed(expected);
  const double difference = value - expected;
  const double rounding =
      whole || limit == 0 ? 0 : std::ldexp(std::max(std::abs(value), std::abs(expected)), -51);
  if (difference > limit + rounding) return Deviation::kHigher;
  if (-difference > limit + rounding) return Deviation::kLower;
  return Deviation::kWithin;
}

}  // namespace fovea::regression
