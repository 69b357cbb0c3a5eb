#include "sw/fovea/probes/perfetto_functions.h"

#include <fmt/format.h>

#include <algorithm>

namespace fovea::app {

void PerfettoFunctions::ran(std::span<const std::uint32_t> functions, std::size_t same, std::uint64_t begin,
                            std::uint64_t end) {
  // The clock may be another one by the time of the next stretch.
  const Picoseconds at = last_ ? *last_ : time_(begin);
  last_ = time_(end);
  told_ = end;
  same = std::min(same, active_.size());  // the first call may come in the middle
  while (same < functions.size() && same < active_.size() && active_[same].function == functions[same]) ++same;
  if (same == functions.size() && same == active_.size()) return;
  for (; active_.size() > same; active_.pop_back()) {
    const Active& a = active_.back();
    if (at > from_ && at >= a.since + kShortest) over_.push_back({a.function, active_.size() - 1, a.since, at});
  }
  for (std::size_t k = same; k < functions.size(); ++k) active_.push_back({functions[k], at});
}

void PerfettoFunctions::write(const Slice& s, Picoseconds until) {
  const Picoseconds begin = std::max(s.begin, from_), end = std::min(s.end, until);
  if (begin >= end || s.depth >= kDeepest) return;
  while (tracks_.size() <= s.depth)
    tracks_.push_back(file_.track("firmware", fmt::format("functions {:02}", tracks_.size() + 1),
                                  PerfettoFile::Events::kMany));
  std::string& name = names_[s.function];
  if (name.empty()) name = name_(s.function);
  file_.slice(tracks_[s.depth], name, begin, end);
}

void PerfettoFunctions::flush(Picoseconds until) {
  for (; !over_.empty() && over_.front().end <= until; over_.pop_front()) write(over_.front(), until);
}

void PerfettoFunctions::finish(Picoseconds until) {
  // What was active up to the last branch may have ended with it.
  if (last_) settle_(told_);
  for (const Slice& s : over_) write(s, until);
  over_.clear();
  for (std::size_t k = active_.size(); k-- > 0;)
    if (const Active& a = active_[k]; a.since + kShortest <= until) write({a.function, k, a.since, until}, until);
  from_ = kNever;
}

}  // namespace fovea::app
