#include "sw/fovea/limits/judge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "model/common/check.h"
#include "sw/fovea/checked_file.h"

namespace fovea::limits {
namespace {

std::string number(double value) { return fmt::format("{:.6g}", value); }

std::string failed_words(const Condition& c, const std::string& name, double value) {
  if (c.words.empty() || c.bound != 0)
    return fmt::format("{} is {}, allowed: {} {}", name, number(value),
                       c.at_least ? "at least" : "at most", number(c.bound));
  const std::string whose = name == c.metric ? "" : " (" + name + ")";
  return fmt::format("{} {}{}{}", number(value), c.words, value == 1 ? "" : "s", whose);
}

/// Remaps follow one another, so one that takes longer than a frame period on average leads to a dropped frame sooner
/// or later, even if buffers have hidden it in a short window. Empty: it does not, or the run does not say.
std::string slow_remaps(const points::PointResult& r) {
  const auto rate = r.stat("frame.rate"), mean = r.stat("frame.remap_time.mean");
  if (!rate || !mean || *rate * *mean <= 1) return "";
  return fmt::format("a remap takes {:.1f} % more than a frame period on average, so that frames will be dropped",
                     100 * (*rate * *mean - 1));
}

}  // namespace

std::vector<Condition> default_conditions() {
  return {{"frame.dropped", false, 0, "dropped frame"},
          {"frame.repeated", false, 0, "repeated frame", "frame.repeated_relock"},
          {"capture.overflows", false, 0, "capture overflow"},
          {"display.underflows", false, 0, "display underflow"}};
}

std::vector<Condition> conditions_with(const std::vector<std::string>& required) {
  std::vector<Condition> own;
  for (const std::string& text : required) {
    const auto at = text.find_first_of("<>");
    Condition c;
    bool good = at != text.npos && at > 0 && at + 2 < text.size() && text[at + 1] == '=';
    if (good) {
      c.metric = text.substr(0, at);
      c.at_least = text[at] == '>';
      const char* const end = text.data() + text.size();
      const auto read = std::from_chars(text.data() + at + 2, end, c.bound);
      good = read.ec == std::errc() && read.ptr == end && std::isfinite(c.bound);
    }
    if (!good)
      throw UserError(fmt::format("--require '{}': allowed: METRIC<=NUMBER or METRIC>=NUMBER",
                                  app::one_line(text)));
    own.push_back(c);
  }
  std::vector<Condition> out;
  for (const Condition& d : default_conditions())
    if (std::none_of(own.begin(), own.end(), [&](const auto& o) { return o.metric == d.metric; }))
      out.push_back(d);
  out.insert(out.end(), own.begin(), own.end());
  return out;
}

std::string text_of(const Condition& c) {
  return fmt::format("{}{} {} {}", c.metric, c.without.empty() ? "" : " - " + c.without, c.at_least ? ">=" : "<=",
                     number(c.bound));
}

Verdict judge(const points::PointResult& result, const std::vector<Condition>& conditions) {
  using Kind = Verdict::Kind;
  if (result.status == 3) return {Kind::kBad, result.message};
  if (result.status != 0)
    return {Kind::kUnknown,
            fmt::format("a run ended with status {}: {}", result.status, result.message), result.status};
  std::vector<std::string> failed;
  for (const Condition& c : conditions) {
    bool found = false;
    for (const auto& [name, figure] : result.stats) {
      if (name != c.metric && !(name.starts_with("camera.") && name.ends_with("." + c.metric)))
        continue;
      found = true;
      const double value = name == c.metric ? figure - result.stat(c.without).value_or(0) : figure;
      if (c.at_least ? value < c.bound : value > c.bound)
        failed.push_back(failed_words(c, name, value));
    }
    if (found) continue;
    if (!result.units.contains(c.metric))
      return {Kind::kUnknown,
              fmt::format("the run has no figure '{}'; those that it has are in {}",
                          app::one_line(c.metric),
                          app::one_line((result.folder / "run/stats.json").string()))};
    // A figure without a value: a rate or a mean of nothing.
    failed.push_back(c.metric + " has no value");
  }
  if (failed.empty())
    if (std::string slow = slow_remaps(result); !slow.empty()) failed.push_back(std::move(slow));
  return {failed.empty() ? Kind::kGood : Kind::kBad, fmt::format("{}", fmt::join(failed, ", "))};
}

}  // namespace fovea::limits
