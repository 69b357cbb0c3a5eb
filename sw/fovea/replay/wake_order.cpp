#include "sw/fovea/replay/wake_order.h"

#include <algorithm>
#include <utility>

namespace fovea::app {

bool WakeOrder::read(Numbered& out) {
  at_end_ = at_end_ || !source_.next(stream_, out.record);
  if (at_end_) return false;
  out.number = numbers_++;
  if (wakes(out.record) && by_transfer(out.record))
    latest_transfer_ = std::max(latest_transfer_, info_.interrupts[out.record.event].at);
  return true;
}

bool WakeOrder::next(Numbered& out) {
  if (!running_.empty()) {
    out = std::move(running_.front());
    running_.pop_front();
    return true;
  }
  if (!std::exchange(more_, false) || !read(out)) return false;
  more_ = !wakes(out.record);
  if (more_) return true;
  ahead_.push_back({std::move(out)});
  ++records_ahead_;
  return false;
}

std::size_t WakeOrder::first(bool transfer) const {
  const auto found = std::find_if(ahead_.begin(), ahead_.end(),
                                  [&](const Block& b) { return by_transfer(b.front().record) == transfer; });
  return static_cast<std::size_t>(found - ahead_.begin());
}

void WakeOrder::read_ahead() {
  Numbered n;
  while ((first(false) == ahead_.size() || first(true) == ahead_.size()) && records_ahead_ < kMostAhead && read(n)) {
    if (wakes(n.record)) ahead_.emplace_back();
    ahead_.back().push_back(std::move(n));
    ++records_ahead_;
  }
}

WakeOrder::Choice WakeOrder::choose(const Time& time) {
  read_ahead();
  const std::size_t timed = first(false), behind = first(true);
  const auto choice = [&](std::size_t n) { return Choice{.first = ahead_[chosen_ = n].front()}; };
  if (timed == ahead_.size() || behind == ahead_.size()) return choice(0);
  const trace::Record& transfer = ahead_[behind].front().record;
  const Picoseconds at = time(ahead_[timed].front().record), ended = time(transfer);
  if (ended != kNever) return choice(ended < at || (ended == at && behind < timed) ? behind : timed);
  Choice out = choice(timed);
  out.settled = false;
  out.awaited = info_.interrupts[transfer.event].source;
  return out;
}

void WakeOrder::take() {
  more_ = chosen_ + 1 == ahead_.size() && !at_end_;
  running_ = std::move(ahead_[chosen_]);
  ahead_.erase(ahead_.begin() + static_cast<std::ptrdiff_t>(chosen_));
  records_ahead_ -= running_.size();
  running_.pop_front();
}

}  // namespace fovea::app
