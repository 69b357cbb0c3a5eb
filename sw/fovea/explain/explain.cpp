#include "sw/fovea/explain/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "sw/fovea/explain/rules.h"
#include "sw/fovea/explain/words.h"
#include "sw/fovea/results/names.h"

namespace fovea::explain {
namespace {

constexpr std::string_view kStall = "cpu.stall.";

using Shares = std::vector<std::pair<std::string, double>>;

Shares sorted(const std::map<std::string, double>& sums) {
  Shares out;
  for (const auto& [name, clocks] : sums)
    if (clocks > 0) out.emplace_back(name, clocks);
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return out;
}

double as_double(const StatBase::Value& value) {
  return std::visit([](auto v) { return static_cast<double>(v); }, value);
}

}  // namespace

std::optional<double> Run::value(std::string_view name) const {
  const app::StatRow* row = app::find(inputs_.stats, name);
  if (!row) return std::nullopt;
  const double v = as_double(row->value);
  return std::isfinite(v) ? std::optional(v) : std::nullopt;
}

std::optional<double> Run::number(std::string_view key) const {
  const std::string text = parameter(key);
  double out = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc{} ? std::optional(out) : std::nullopt;
}

double Run::awake() const {
  const auto cycles = value(names::kCpuCycles);
  return cycles ? *cycles - value_or_zero(names::kCpuIdle) : 0;
}

Shares Run::stall_causes() const {
  std::map<std::string, double> sums;
  for (const auto& row : inputs_.stats) {
    if (!row.name.starts_with(kStall)) continue;
    const std::string cause = row.name.substr(kStall.size());
    if (cause.find('.') == std::string::npos) sums[cause] += as_double(row.value);
  }
  return sorted(sums);
}

Shares Run::culprits(std::string_view cause) const {
  std::map<std::string, double> sums;
  for (const auto& row : inputs_.stats) {
    if (!row.name.starts_with(kStall)) continue;
    const std::string_view rest = std::string_view(row.name).substr(kStall.size());
    const auto by = rest.find(".by.");
    if (by == rest.npos || (!cause.empty() && rest.substr(0, by) != cause)) continue;
    sums[std::string(rest.substr(by + 4))] += as_double(row.value);
  }
  return sorted(sums);
}

Shares Run::waits_of(std::string_view port) const {
  constexpr std::string_view kDdr = "ddr.", kWait = ".wait.";
  std::map<std::string, double> sums;
  for (const auto& row : inputs_.stats) {
    const auto wait = row.name.find(kWait);
    if (wait == row.name.npos || !row.name.starts_with(kDdr) || !row.name.substr(kDdr.size()).starts_with(port))
      continue;
    // Behind it comes read.CULPRIT or write.CULPRIT.
    const auto dot = row.name.find('.', wait + kWait.size());
    if (dot == row.name.npos) continue;
    const std::string culprit = row.name.substr(dot + 1);
    if (const double seconds = as_double(row.value); std::isfinite(seconds))
      sums[culprit.starts_with(port) ? "own" : culprit] += seconds;
  }
  return sorted(sums);
}

bool Run::loaded(std::string_view port) const {
  // As many loads as the chip's model has: their keys are `load` and `load.N`.
  for (unsigned n = 0;; ++n) {
    const std::string prefix = n == 0 ? "load" : fmt::format("load.{}", n);
    const auto outstanding = number(prefix + ".outstanding");
    if (!outstanding) return false;
    if (*outstanding > 0 && parameter(prefix + ".port").starts_with(port)) return true;
  }
}

Shares Run::regions(std::string_view cause) const {
  std::map<std::string, double> sums;
  for (const auto& row : inputs_.stalls)
    if (row.cause == cause) sums[row.region] += static_cast<double>(row.cycles);
  return sorted(sums);
}

bool Run::remaps_in_a_row() const {
  const double fresh = value_or_zero(names::kDisplayed) - value_or_zero(names::kRepeated);
  return fresh > 0 && 2 * value_or_zero(names::kRemapped) >= 3 * fresh;
}

double Run::frame_period() const {
  const auto window = value(names::kWindow), displayed = value(names::kDisplayed);
  return window && displayed && *displayed > 0 ? *window / *displayed : 0;
}

std::vector<Finding> explain(const Inputs& inputs) {
  const Run run(inputs);
  std::vector<Finding> out;
  for (const auto rule : {find_rate, find_budget, find_latency_parts, find_mover, find_largest_wait, find_function,
                          find_other_masters, find_rows, find_sdram_use})
    rule(run, out);
  return out;
}

std::vector<Finding> explain_difference(const Inputs& inputs_a, std::string_view name_a,
                                        const Inputs& inputs_b, std::string_view name_b) {
  const Run a(inputs_a), b(inputs_b);
  std::vector<Finding> out;
  const auto before = a.value(names::kRemapTimeMean), after = b.value(names::kRemapTimeMean);
  if (before && after && *before > 0) {
    const double change = *after - *before;
    // A tenth of the smallest change on which a reader would act.
    constexpr double kSame = 1e-3;
    out.push_back(
        {"remap_difference",
         std::abs(change) < kSame * *before
             ? fmt::format("The remap of {} takes as long as that of {}: {}.", name_b, name_a,
                           milliseconds(*after))
             : fmt::format("The remap of {} takes {} instead of the {} of {}: {} {}.", name_b,
                           milliseconds(*after), milliseconds(*before), name_a,
                           percent(std::abs(change) / *before), change < 0 ? "less" : "more"),
         {names::kRemapTimeMean}});
  }
  const double frames_a = a.value_or_zero(names::kRemapped),
               frames_b = b.value_or_zero(names::kRemapped);
  if (frames_a == 0 || frames_b == 0) return out;
  std::map<std::string, double> clocks;
  for (const auto& [cause, n] : b.stall_causes()) clocks[cause] += n / frames_b;
  for (const auto& [cause, n] : a.stall_causes()) clocks[cause] -= n / frames_a;
  clocks["issue"] =
      b.value_or_zero(names::kCpuIssue) / frames_b - a.value_or_zero(names::kCpuIssue) / frames_a;
  const auto largest = std::max_element(
      clocks.begin(), clocks.end(),
      [](const auto& x, const auto& y) { return std::abs(x.second) < std::abs(y.second); });
  const double size = std::abs(largest->second);
  // Less is not worth a sentence beside a frame of some millions of clocks.
  constexpr double kFewClocks = 1000;
  if (size >= kFewClocks)
    out.push_back(
        {"largest_difference",
         fmt::format("The largest difference in the core's clocks for each corrected "
                     "frame: {} spends {:.0f} thousand clocks {} {}.",
                     name_b, size / 1000, largest->second < 0 ? "less" : "more",
                     largest->first == "issue" ? std::string("on issuing instructions")
                                               : "on waiting for " + waits_for(largest->first)),
         {largest->first == "issue" ? names::kCpuIssue : "cpu.stall." + largest->first,
          names::kRemapped}});
  return out;
}

}  // namespace fovea::explain
