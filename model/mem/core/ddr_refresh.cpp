// How many refreshes are owed, and how urgent they are.
#include "model/common/check.h"
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {
namespace {

constexpr unsigned kPostponedMost = 8;  // refreshes, JESD79-2

}  // namespace

/// Too long without a refresh: four in a row before anything new.
void DdrController::begin_refresh() {
  if (gap_ > gap_limit_ && forced_ == 0) forced_ = 4;
  closing_ = true;
  urgency_changed();
}

void DdrController::urgency_changed() {
  const bool urgent = forced_ > 0 || closing_ || catching_up_ ||
                      owed_ > std::min(must_, need_) || gap_ > gap_limit_;
  urgency_ = refresh_urgency_after(0);
  all_in_time_until_ = std::min(next_expiry_, first_overdue());
  calm_until_ = urgent ? 0 : all_in_time_until_;
  idle_calm_ = owed_ || config_.low_power != LowPower::kOff ? 0 : next_expiry_;
}

Picoseconds DdrController::interval_start(Picoseconds t) const {
  const std::uint64_t interval = config_.refresh_interval;
  if (!running_ || interval == 0 || next_expiry_ == kNoClock) return 0;
  std::uint64_t begin = next_expiry_;
  while (begin > interval && (begin == next_expiry_ || ddr_.edge(begin - 1) > t)) begin -= interval;
  return begin > 0 && ddr_.edge(begin - 1) <= t ? ddr_.edge(begin - 1) : 0;
}

/// Refresh intervals have run out.
[[gnu::noinline]] void DdrController::count_expired(std::uint64_t clock) {
  while (next_expiry_ <= clock) {
    ++owed_;
    ++gap_;
    next_expiry_ += config_.refresh_interval;
    stats.refresh_backlog.note(owed_);
    if (owed_ > kPostponedMost)
      Diagnostics::instance().guest(
          "more refreshes of the SDRAM are postponed than the 8 that JESD79-2 allows (most at once: "
          "ddr.refresh_backlog)");
  }
  if (owed_ > must_) catching_up_ = true;
  urgency_changed();
}

/// Of a long time without requests only the last refreshes are carried out one by one: all those before
/// come as they fall due, one an interval, and leave nothing but their number.
void DdrController::pass_over_refreshes(std::uint64_t until) {
  const std::uint64_t interval = config_.refresh_interval;
  if (hook_ || interval <= config_.timing.nRFC || config_.low_power != LowPower::kOff) return;
  if (until < next_expiry_ || until - next_expiry_ < 2 * WaitAttribution::kHistory * interval) return;
  if (!device_.all_closed() || next_expiry_ < std::max(command_free_, device_.earliest_refresh()))
    return;
  const std::uint64_t passed = (until - next_expiry_) / interval - WaitAttribution::kHistory;
  stats.refreshes += passed;
  next_expiry_ += passed * interval;
}

/// The REF that follows a PREA does not wait until the requests behind it have come through the pipeline.
void DdrController::plan_refresh() {
  plain_ = false;
  choose_refresh(command_free_);
  next_ = ddr_.edge(choice_.at);
}

/// At an edge after which an interval may have run out.
DdrController::Urgency DdrController::refresh_urgency_after(std::uint64_t edge) const {
  unsigned expired = 0;
  if (config_.refresh_interval && edge >= next_expiry_)
    expired = 1 + static_cast<unsigned>((edge - next_expiry_) / config_.refresh_interval);
  if (forced_ > 0 || closing_ || catching_up_ || owed_ + expired > must_ || gap_ + expired > gap_limit_)
    return Urgency::kMust;
  return owed_ + expired > need_ ? Urgency::kNeed : Urgency::kMay;
}

}  // namespace fovea::mem
