#include "sw/fovea/limits/judge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/safe_json.h"
#include "sw/fovea/limits/figure_names.h"
#include "sw/fovea/results/names.h"

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

/// What the firmware was told to do with each frame (firmware.repeat).
double remaps_per_frame(const points::PointResult& r) {
  const std::filesystem::path file = r.folder / "run" / "config.json";
  std::error_code error;
  if (r.folder.empty() || !std::filesystem::exists(file, error)) return 1;
  const auto json = app::read_json(file);
  const auto& key = app::json_member(app::json_member(json, "params"), "firmware.repeat");
  const std::string repeat = app::json_text(key, "value");
  return std::max(1.0, std::strtod(repeat.c_str(), nullptr));
}

/// Remaps follow one another, so one that takes longer than a frame period on average leads to a dropped frame sooner
/// or later, even if buffers have hidden it in a short window. Empty: it does not, or the run does not say.
std::string slow_remaps(const points::PointResult& r) {
  const auto rate = steady_rate(r), mean = r.stat(names::kRemapTimeMean);
  const double remaps = remaps_per_frame(r);
  if (!rate || !mean || *rate * remaps * *mean <= 1) return "";
  if (remaps > 1)
    return fmt::format("the {:.0f} remaps of a frame take {:.1f} % more than its period on average, so that frames "
                       "will be dropped", remaps, 100 * (*rate * remaps * *mean - 1));
  return fmt::format("a remap takes {:.1f} % more than a frame period on average, so that frames will be dropped",
                     100 * (*rate * *mean - 1));
}

/// Frames shown again for which the decoder's search for syncs is no reason.
std::optional<double> late_frames(const points::PointResult& r) {
  const auto repeated = r.stat(names::kRepeated);
  if (!repeated) return std::nullopt;
  return *repeated - r.stat(names::kRepeatedRelock).value_or(0);
}

}  // namespace

std::vector<Condition> default_conditions() {
  return {{names::kDropped, false, 0, "dropped frame", "", "no frame is dropped"},
          {names::kRepeated, false, 0, "repeated frame", names::kRepeatedRelock,
           "none is shown twice, but by a loop that slips once or while the decoder looks for a camera's syncs", true},
          {names::kCaptureOverflows, false, 0, "capture overflow", "", "no capture overflows"},
          {names::kDisplayUnderflows, false, 0, "display underflow", "", "no display underflows"}};
}

std::optional<double> steady_rate(const points::PointResult& r) {
  const auto rate = r.stat(names::kRate), shown = r.stat(names::kDisplayed), repeated = r.stat(names::kRepeated);
  if (!rate || !shown || late_frames(r) != 1.0) return rate;
  const double fresh = *shown - *repeated;
  return fresh > 0 ? *rate * (fresh + 1) / fresh : *rate;
}

std::optional<double> slack(const points::PointResult& r) {
  const auto rate = steady_rate(r), longest = r.stat(names::kRemapTimeMax);
  if (!rate || !longest || *rate <= 0) return std::nullopt;
  return 1 - *longest * remaps_per_frame(r) * *rate;
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
  if (!c.sentence.empty()) return c.sentence;
  return fmt::format("{}{} {} {}", c.metric, c.without.empty() ? "" : " - " + c.without, c.at_least ? ">=" : "<=",
                     number(c.bound));
}

Verdict judge(const points::PointResult& result, const std::vector<Condition>& conditions, unsigned slips) {
  using Kind = Verdict::Kind;
  if (result.status == 3) return {Kind::kBad, result.message};
  if (result.status != 0)
    return {Kind::kUnknown,
            fmt::format("a run ended with status {}: {}", result.status, result.message), result.status};
  std::vector<std::string> failed;
  bool once = false;
  const bool may_slip = std::any_of(conditions.begin(), conditions.end(), [](const auto& c) { return c.slip; });
  for (const Condition& c : conditions) {
    bool found = false;
    for (const auto& [name, figure] : result.stats) {
      if (name != c.metric && !(name.starts_with("camera.") && name.ends_with("." + c.metric)))
        continue;
      found = true;
      double value = name == c.metric ? figure - result.stat(c.without).value_or(0) : figure;
      // A slip in the window takes a frame off its rate, one before the window does not.
      if (may_slip && name == names::kRate) value = steady_rate(result).value_or(value);
      const double bound = c.bound + (c.slip ? slips : 0u);
      if (!(c.at_least ? value < bound : value > bound)) continue;
      once = once || (c.slip && value == bound + 1);
      failed.push_back(failed_words(c, name, value));
    }
    if (found) continue;
    if (!result.units.contains(c.metric))
      return {Kind::kUnknown,
              fmt::format("the run has no figure '{}'{}", app::one_line(c.metric), names_hint(c.metric, result))};
    // A figure without a value: a rate or a mean of nothing.
    failed.push_back(c.metric + " has no value");
  }
  const std::string slow = slow_remaps(result);
  once = once && failed.size() == 1 && slow.empty();
  if (failed.empty() && !slow.empty()) failed.push_back(slow);
  const bool near = failed.empty() && slack(result).value_or(0) < 0;
  return {failed.empty() ? Kind::kGood : Kind::kBad, fmt::format("{}", fmt::join(failed, ", ")), 2, once || near};
}

}  // namespace fovea::limits
