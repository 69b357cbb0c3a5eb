#include "model/mem/core/refresh_manager.h"

#include <algorithm>

namespace fovea::mem {
namespace {

constexpr unsigned kPostponedMost = 8;  // refreshes, JESD79-2
constexpr unsigned kForced = 4;         // in a row, after too long a gap

}  // namespace

void RefreshManager::set_interval(unsigned clocks, std::uint64_t now) {
  // Intervals that ended before are owed.
  if (next_expiry_ != 0 && now != 0 && next_expiry_ <= now - 1) count_expired(now - 1);
  if (clocks != interval_ || next_expiry_ == 0) next_expiry_ = clocks ? now + clocks : kNoClock;
  interval_ = clocks;
  update();
}

void RefreshManager::count_expired(std::uint64_t clock) {
  while (next_expiry_ <= clock) {
    ++owed_;
    ++gap_;
    next_expiry_ += interval_;
    stats_.refresh_backlog.note(owed_);
    if (owed_ > kPostponedMost)
      diagnostics_.guest(
          "more refreshes of the SDRAM are postponed than the 8 that JESD79-2 allows (most at once: "
          "ddr.refresh_backlog)");
  }
  if (owed_ > levels_.must) catching_up_ = true;
  update();
}

void RefreshManager::begin_cycle() {
  if (gap_ > levels_.gap && forced_ == 0) forced_ = kForced;
  begin_idle_cycle();
}

void RefreshManager::begin_idle_cycle() {
  cycle_begun_ = true;
  update();
}

void RefreshManager::refreshed() {
  ++stats_.refreshes;
  gap_ = 0;
  if (owed_) --owed_;
  if (forced_) --forced_;
  if (owed_ <= levels_.release) catching_up_ = false;
  cycle_begun_ = false;
  update();
}

void RefreshManager::pass_over(std::uint64_t intervals) {
  stats_.refreshes += intervals;
  next_expiry_ += intervals * interval_;
}

void RefreshManager::restart(std::uint64_t clock) {
  owed_ = gap_ = 0;
  if (interval_) next_expiry_ = clock + interval_;
  update();
}

void RefreshManager::update() {
  urgent_ = forced_ > 0 || cycle_begun_ || catching_up_ ||
            owed_ > std::min(levels_.must, levels_.need) || gap_ > levels_.gap;
  urgency_ = urgency_after(0);
}

RefreshManager::Urgency RefreshManager::urgency_after(std::uint64_t edge) const {
  unsigned expired = 0;
  if (interval_ && edge >= next_expiry_)
    expired = 1 + static_cast<unsigned>((edge - next_expiry_) / interval_);
  if (forced_ > 0 || cycle_begun_ || catching_up_ || owed_ + expired > levels_.must ||
      gap_ + expired > levels_.gap)
    return Urgency::kMust;
  return owed_ + expired > levels_.need ? Urgency::kNeed : Urgency::kMay;
}

}  // namespace fovea::mem
