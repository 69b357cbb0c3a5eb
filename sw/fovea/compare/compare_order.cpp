// Which change of a figure matters most: the one that is the largest share of the time.
#include <algorithm>
#include <array>
#include <cmath>

#include "sw/fovea/compare/compare.h"
#include "sw/fovea/results/names.h"

namespace fovea::regression {
namespace {

bool begins(const std::string& name, std::initializer_list<const char*> parts) {
  return std::any_of(parts.begin(), parts.end(), [&](const char* p) { return name.starts_with(p); });
}

/// The frame period in seconds; 0: the result has no frames.
double frame_period(const RunFigures& run) {
  const double rate = run.value(names::kRate);
  return rate > 0 ? 1 / rate : 0;
}

/// The time that the figures cover.
double window_of(const RunFigures& run) {
  const double window = run.value(names::kWindow);
  return window > 0 ? window : run.value("replay.time");
}

/// What a change of `name` by 1 is a share of; 0: there is nothing.
double whole_of(const std::string& name, const std::string& unit, const RunFigures& run) {
  const double window = window_of(run), period = frame_period(run);
  if (unit == "cycles" || name == names::kCpuInstructions) return run.value(names::kCpuCycles);
  if (unit == "ratio") return 1;
  if (unit == "s") {
    const bool sum = name.find(".wait.") != name.npos || name.ends_with(".busy_time") || period == 0;
    return sum ? window : period;
  }
  if (const double busy = run.value(names::kDdrUtilisation); unit == "B" && busy > 0)
    return run.value(names::kDdrBusBytes) / busy;
  if (unit == "1/s" && begins(name, {"frame."})) return run.value(name);
  if (begins(name, {names::kDropped, names::kRepeated, names::kCaptureOverflows, names::kDisplayUnderflows}))
    return run.value(names::kDisplayed);
  return 0;
}

}  // namespace

std::vector<SharedChange> by_share_of_time(const Comparison& c) {
  std::vector<SharedChange> out;
  for (const MetricChange& m : c.changes) {
    SharedChange s{&m, std::nullopt};
    if (const auto d = m.difference())
      if (const double whole = whole_of(m.name, m.before->unit, *c.before); whole > 0) s.share = *d / whole;
    out.push_back(s);
  }
  const auto rank = [](const SharedChange& s) {
    const int group = s.share ? 0 : s.change->difference() ? 1 : 2;
    const double size = s.share.value_or(s.change->relative().value_or(INFINITY));
    return std::pair(group, group == 2 ? 0 : -std::abs(size));
  };
  std::stable_sort(out.begin(), out.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return out;
}

}  // namespace fovea::regression
