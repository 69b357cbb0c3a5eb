// Refresh of the SDRAM device, and its low-power modes while no request is queued.
#include "model/mem/core/ddr_plan.h"
#include "model/mem/core/partial_refresh.h"

namespace fovea::mem {

/// What falls into the time without requests: at the "may" level each refresh is done as soon as it
/// is owed; then the part goes to sleep, if software allows it. The PREA belongs to the REF: once it is
/// issued, a request that comes waits for both. This cannot cause anything but later row misses and
/// waiting, so it is caught up lazily.
[[gnu::noinline]] void DdrController::idle(std::uint64_t until) {
  for (;;) {
    if (refreshes_itself(power_.mode())) return;
    if (power_.mode() == LowPower::kPowerDown) {
      const std::uint64_t at = std::max(refresh_.next_expiry(), power_.cke_free());
      if (at >= until) return;
      wake(at);
    }
    std::uint64_t from = command_free_;
    if (refresh_.owed() == 0 && !refresh_.cycle_begun()) {
      if (config_.low_power != LowPower::kOff &&
          fall_asleep(std::min(until, refresh_.next_expiry())))
        continue;
      pass_over_refreshes(until);
      if (refresh_.next_expiry() >= until) return;
      from = std::max(command_free_, refresh_.next_expiry());
      if (from >= until) return;
      count_owed(from);
    }
    // Refreshes may be owed from before refresh was switched off.
    if (!refresh_.interval() && !refresh_.cycle_begun()) return;
    if (!device_.all_closed()) {
      const std::uint64_t at = std::max(from, device_.earliest_pre_all());
      if (at >= until) return;
      issue<Cmd::kPreAll>(0, 0, at, ddr_.edge(at));
      refresh_.begin_idle_cycle();
      update_deadlines();
      from = at + 1;
    }
    const std::uint64_t at = std::max(from, device_.earliest_refresh());
    if (at >= until) return;
    count_owed(at);
    issue_refresh(at, ddr_.edge(at));
  }
}

/// What is queued has only been announced: the crossbar says at the grant when the last beat will be
/// here. Nothing else comes before that.
[[gnu::noinline]] void DdrController::idle_until_arrival(std::uint64_t clock) {
  const std::uint64_t arrives = queue_.entry(0).ready - request_latency_;
  count_queued(clock + 1);
  queued_since_ = arrives;
  if (idle_calm_ >= arrives) return;
  idle(arrives);
  wake(arrives);
}

/// Of a long time without requests only the last refreshes are carried out one by one: all those before
/// come as they fall due, one an interval, and leave nothing but their number.
void DdrController::pass_over_refreshes(std::uint64_t until) {
  const std::uint64_t interval = refresh_.interval(), expiry = refresh_.next_expiry();
  if (!hooks_.empty() || interval <= config_.timing.nRFC || config_.low_power != LowPower::kOff) return;
  if (until < expiry || until - expiry < 2 * WaitAttribution::kHistory * interval) return;
  if (!device_.all_closed() || expiry < std::max(command_free_, device_.earliest_refresh()))
    return;
  refresh_.pass_over((until - expiry) / interval - WaitAttribution::kHistory);
}

void DdrController::begin_refresh() {
  refresh_.begin_cycle();
  update_deadlines();
}

void DdrController::issue_refresh(std::uint64_t clock, Picoseconds at) {
  issue<Cmd::kRef>(0, 0, clock, at);
  refresh_.refreshed();
  update_deadlines();
}

[[gnu::noinline]] void DdrController::count_expired(std::uint64_t clock) {
  refresh_.count_expired(clock);
  update_deadlines();
}

Picoseconds DdrController::interval_start(Picoseconds t) const {
  const std::uint64_t interval = refresh_.interval(), expiry = refresh_.next_expiry();
  if (!running_ || interval == 0 || expiry == kNoClock) return 0;
  std::uint64_t begin = expiry;
  while (begin > interval && (begin == expiry || ddr_.edge(begin - 1) > t)) begin -= interval;
  return begin > 0 && ddr_.edge(begin - 1) <= t ? ddr_.edge(begin - 1) : 0;
}

/// Entry with the last data over, before `until`. Power-down leaves rows open; self-refresh needs
/// them closed. Entry at once, rather than after some time without requests, is assumed.
bool DdrController::fall_asleep(std::uint64_t until) {
  const bool self_refresh = refreshes_itself(config_.low_power);
  if (self_refresh && !device_.all_closed()) {
    const std::uint64_t at = std::max(command_free_, device_.earliest_pre_all());
    if (at >= until) return false;
    issue<Cmd::kPreAll>(0, 0, at, ddr_.edge(at));
  }
  std::uint64_t at = std::max({command_free_, device_.quiet(), power_.cke_free()});
  if (self_refresh) at = std::max(at, device_.earliest_refresh());
  if (at >= until) return false;
  power_.enter(config_.low_power, at, ddr_.edge(at), config_.timing.nCKE);
  mark(self_refresh ? Cmd::kSre : Cmd::kPde, at);
  return true;
}

/// CKE rises for what comes at `clock`; commands follow tXP later, or tXSNR and for reads tXSRD.
[[gnu::noinline]] void DdrController::wake(std::uint64_t clock) {
  if (!power_.asleep()) return;
  const DdrTiming& t = config_.timing;
  const bool self_refresh = refreshes_itself(power_.mode());
  const std::uint64_t at = power_.exit_clock(clock);
  power_.leave(at, device_.all_closed(), t.nCKE);
  mark(self_refresh ? Cmd::kSrx : Cmd::kPdx, at);
  command_free_ = at + (self_refresh ? t.nXSNR : t.nXP);
  if (!self_refresh) return;
  lose_unrefreshed(config_, ddr_.edge(at) - power_.entered(), retention_, store_, diagnostics_);
  device_.put_off_reads(at + t.nXSRD);
  refresh_.restart(at);
  // A mobile part gets a REF before anything else (SPRUH82C 14.2.8). For DDR2 TI's manuals name none, though the part
  // wants one before it sleeps again (JESD79-2): that there is none is assumed, and the data sheet's checker says so.
  if (t.mobile) refresh_.begin_idle_cycle();
  update_deadlines();
}

/// Another low-power mode. Between self-refresh with and without the memory's clock the part sleeps
/// on; all else wakes it.
void DdrController::sleep_changes(LowPower to, std::uint64_t clock) {
  if (!refreshes_itself(power_.mode()) || !refreshes_itself(to)) return wake(clock);
  power_.change(to, clock);
}

/// CKE moves.
void DdrController::mark(Cmd cmd, std::uint64_t clock) {
  command_free_ = std::max(command_free_, clock + 1);
  IssuedCommand& g = attribution_.add(clock, ddr_.edge(clock));
  g.cmd = cmd;
  g.cause = WaitAttribution::kAsleep;
  call_hook(cmd, 0, 0, clock);
}

}  // namespace fovea::mem
