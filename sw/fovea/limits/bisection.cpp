#include "sw/fovea/limits/bisection.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <tuple>

#include "model/common/check.h"

namespace fovea::limits {

Bisection::Bisection(std::uint64_t last, unsigned probes) : last_(last), probes_(probes) {}

bool Bisection::upwards() const { return tried_.at(0); }

std::optional<std::pair<std::uint64_t, std::uint64_t>> Bisection::edge() const {
  const auto find = [](auto begin, auto end) -> std::optional<std::pair<std::uint64_t, std::uint64_t>> {
    for (auto i = begin; i != end && std::next(i) != end; ++i)
      if (i->second && !std::next(i)->second) return std::pair(i->first, std::next(i)->first);
    return std::nullopt;
  };
  if (!tried_.at(0) && !tried_.at(last_)) return std::nullopt;
  return upwards() ? find(tried_.begin(), tried_.end()) : find(tried_.rbegin(), tried_.rend());
}

unsigned Bisection::changes() const {
  unsigned n = 0;
  for (auto i = tried_.begin(); i != tried_.end() && std::next(i) != tried_.end(); ++i)
    n += i->second != std::next(i)->second;
  return n;
}

unsigned Bisection::budget() const {
  const unsigned expected = tried_.at(0) == tried_.at(last_) ? 0 : 1;
  return probes_ && changes() > expected ? probes_ + kMore : probes_;
}

/// The middle of the largest gap between tried values of which neither is the edge's.
std::optional<std::uint64_t> Bisection::probe() const {
  std::uint64_t widest = 1, middle = 0;
  for (auto i = tried_.begin(); std::next(i) != tried_.end(); ++i) {
    const std::uint64_t gap = std::next(i)->first - i->first;
    if (gap > widest) {
      widest = gap;
      middle = i->first + gap / 2;
    }
  }
  return widest > 1 ? std::optional(middle) : std::nullopt;
}

std::optional<std::uint64_t> Bisection::next() const {
  if (!tried_.contains(0)) return 0;
  if (!tried_.contains(last_)) return last_;
  if (const auto e = edge()) {
    const std::uint64_t low = std::min(e->first, e->second), high = std::max(e->first, e->second);
    if (high - low > 1) return low + (high - low) / 2;
  }
  return probed_ < budget() ? probe() : std::nullopt;
}

void Bisection::tell(std::uint64_t value, bool good) {
  const bool ends = tried_.contains(0) && tried_.contains(last_);
  const auto e = ends ? edge() : std::nullopt;
  const bool halves = e && std::max(e->first, e->second) - std::min(e->first, e->second) > 1;
  FOVEA_CHECK(value <= last_ && tried_.emplace(value, good).second, "a value that was not asked for");
  if (ends && !halves) ++probed_;
}

std::size_t Bisection::at_most_left() const {
  if (!next()) return 0;
  const bool ends = tried_.contains(0) && tried_.contains(last_);
  const std::size_t probes = ends ? budget() - probed_ : probes_;
  const auto halvings = [](std::uint64_t gap) { return static_cast<std::size_t>(std::bit_width(gap - 1)); };
  if (!ends) return (last_ ? 2 - tried_.size() : 1) + (last_ > 1 ? halvings(last_) + probes : 0);
  const auto e = edge();
  return probes + (e ? halvings(std::max(e->first, e->second) - std::min(e->first, e->second)) : 0);
}

Bisection::Outcome Bisection::outcome() const {
  if (next()) return {};
  Outcome out;
  const auto e = edge();
  if (!e) {
    out.answer = tried_.begin()->second ? Answer::kAll : Answer::kNone;
    // Bad at both ends, but perhaps not between them.
    for (const auto& [value, good] : tried_)
      if (out.answer == Answer::kNone && good) {
        out.answer = Answer::kBetween;
        out.monotonic = false;
        out.good = out.odd = value;
      }
    return out;
  }
  out.answer = upwards() ? Answer::kLargest : Answer::kSmallest;
  std::tie(out.good, out.bad) = *e;
  const auto look = [&](std::uint64_t value, bool good) {
    const bool beyond = upwards() ? value > out.bad : value < out.bad;
    if (beyond && good && out.monotonic) {
      out.monotonic = false;
      out.odd = value;
    }
  };
  if (upwards())
    for (auto i = tried_.begin(); i != tried_.end(); ++i) look(i->first, i->second);
  else
    for (auto i = tried_.rbegin(); i != tried_.rend(); ++i) look(i->first, i->second);
  return out;
}

}  // namespace fovea::limits
