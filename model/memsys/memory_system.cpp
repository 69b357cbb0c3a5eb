#include "model/memsys/memory_system.h"

#include <algorithm>
#include <utility>

#include "model/mem/core/ddr_plan.h"

namespace fovea::memsys {

using bus::Slave;

MemorySystem::MemorySystem(const bus::CrossbarParams& crossbar, const mem::DdrParams& ddr, const AddressMap& map,
                           MemoryHost& host, const DiagnosticsRef& diagnostics, Route route)
    : map_(map), host_(host), store_(ddr.size_bytes()), crossbar_(crossbar), controller_(ddr, store_, diagnostics) {
  crossbar_.set_teller(*this);
  if (route != Route::kBypass) return;
  bypass_.emplace(crossbar.timeline_interval());
  controller_.leave_out_return_channel();
}

Slave MemorySystem::slave_of(const MemRequest& r) const {
  if (r.address >= map_.ddr_base) return Slave::kDdr;
  const bool in_ram = r.address - map_.ram_base < map_.ram_size;
  return in_ram && !is_core(r.master) ? Slave::kInternalRam : Slave::kConfig;
}

void MemorySystem::submit(MemRequest& r) {
  FOVEA_CHECK(r.bytes > 0 && r.bytes <= kMaxBurstBytes, "bad memory request");
  r.no_side_effects &= trusting_;
  if (bypass_) [[unlikely]] {
    undecided_ += !r.no_side_effects;
    r.in_path.priority = crossbar_.priority(r.master);
    return send_directly(r, r.issued);
  }
  const Slave slave = slave_of(r);
  if (slave == Slave::kInternalRam) r.no_side_effects = false;  // the core sees what it does
  undecided_ += !r.no_side_effects;
  crossbar_.submit(r, slave);
}

inline void MemorySystem::step_controller() {
  event_time_ = last_command_ = controller_.next_decision();
  controller_.take_decision();
  if (controller_.news().any) handle_news();
}

[[gnu::noinline]] void MemorySystem::step_passive() {
  event_time_ = std::exchange(passive_next_, kNever);
  passive_->act_ahead(event_time_);
}

[[gnu::noinline]] bool MemorySystem::advance(Picoseconds limit) {
  const std::uint64_t calls = host_calls_;
  for (;;) {
    const Picoseconds crossbar = crossbar_.next_decision(), controller = controller_.next_decision();
    const Picoseconds own = std::min(crossbar, controller);
    if (std::min(own, passive_next_) >= limit) return false;
    // At equal times the order of the two does not matter: each sees the other's acts strictly later. The slave sees
    // all of its instant.
    if (passive_next_ < own) {
      step_passive();
    } else if (crossbar < controller) {
      event_time_ = crossbar;
      Link link{*this};
      crossbar_.step(link);
    } else {
      step_controller();
      if (bypass_ && bypass_->input_freed) [[unlikely]]
        send_waiting();
    }
    if (host_calls_ != calls) return true;
  }
}

MemorySystem::Attempt MemorySystem::try_complete(MemRequest& r, Picoseconds limit) {
  return r.write ? try_grant<true>(r, limit) : try_grant<false>(r, limit);
}

/// Only the controller has events of its own meanwhile: the passive slave's next act is a limit as well. Those up to
/// the grant come first, since they may free a queue entry. If one completes a request, the caller's limit may have
/// changed, so the fast path is given up.
template <bool kWrite>
[[gnu::noinline]] MemorySystem::Attempt MemorySystem::try_grant(MemRequest& r, Picoseconds limit) {
  const bus::Crossbar::UncontendedGrant grant = crossbar_.uncontended_grant(r);
  limit = std::min(limit, passive_next_);
  if (grant.at >= limit) return Attempt::kNotSubmitted;
  const std::uint64_t calls = host_calls_;
  while (controller_.next_decision() <= grant.at) {
    step_controller();
    if (host_calls_ != calls) return Attempt::kNotSubmitted;
  }
  FOVEA_CHECK(r.bytes > 0 && r.bytes <= kMaxBurstBytes, "bad memory request");
  undecided_ += !r.no_side_effects;
  event_time_ = grant.at;
  Link link{*this};
  if (crossbar_.grant_uncontended<kWrite>(link, r, grant)) {
    undecided_ -= !r.no_side_effects;
    count_decided();
    return Attempt::kCompleted;
  }
  while (host_calls_ == calls &&
         controller_.next_decision() < std::min(limit, crossbar_.next_decision()))
    step_controller();
  return Attempt::kUnderWay;
}

inline Taken MemorySystem::forward(MemRequest& r, Picoseconds arrival) {
  const auto slave = static_cast<Slave>(r.in_path.slave);
  if (slave == Slave::kDdr) [[likely]]
    return arrive(r, arrival);
  ++host_calls_;
  return host_.deliver(r, slave, arrival);
}

inline Taken MemorySystem::arrive(MemRequest& r, Picoseconds at) {
  const std::uint32_t offset = r.address - map_.ddr_base;
  const bool outside = std::uint64_t{offset} + r.bytes > store_.size();
  if (!direct_ || outside || controller_.input_blocked()) [[unlikely]]
    return arrive_slowly(r, at);
  return controller_.submit_inside(r, offset, at) ? Taken::kYes : Taken::kWaits;
}

/// The SDRAM is closed or its input blocked, the request is not inside the part, or there is an observer of arrivals.
[[gnu::noinline]] Taken MemorySystem::arrive_slowly(MemRequest& r, Picoseconds at) {
  const std::uint32_t offset = r.address - map_.ddr_base;
  const bool in_question = !open_ || std::uint64_t{offset} + r.bytes > store_.size();
  if (in_question && admission_ && !admission_->admit(offset, r.bytes)) return refuse_in_order(r, at);
  FOVEA_CHECK(admission_ || std::uint64_t{offset} + r.bytes <= store_.size(),
              "request outside the SDRAM");
  FOVEA_CHECK(controller_.running(), "request to a DDR controller without a clock");
  FOVEA_CHECK(!controller_.input_blocked(), "a request while the controller's input is taken");
  arrivals_.each([&](ArrivalObserver* o) { o->arrived(r, at); });
  const auto inside = offset & static_cast<std::uint32_t>(store_.size() - 1);
  return controller_.submit_inside(r, inside, at) ? Taken::kYes : Taken::kWaits;
}

/// A refusal takes no time here, so it waits for the older reads of its master: a master's reads end in
/// their order.
Taken MemorySystem::refuse_in_order(MemRequest& r, Picoseconds at) {
  const MemRequest* older = r.write ? nullptr : controller_.newest_read(r.master);
  if (!older) return Taken::kRefused;
  refused_.push_back({&r, older, at});
  return Taken::kYes;
}

[[gnu::noinline]] void MemorySystem::refuse_after(const MemRequest* read, Picoseconds last) {
  const auto begin = std::stable_partition(
      refused_.begin(), refused_.end(), [&](const Refused& r) { return r.behind != read; });
  const std::vector<Refused> now(begin, refused_.end());
  refused_.erase(begin, refused_.end());
  Link link{*this};
  for (const Refused& refused : now) {
    const Picoseconds at = std::max(refused.at, last);
    crossbar_.slave_done(link, *refused.request, {at, at, 0, true});
  }
}

void MemorySystem::respond(MemRequest& r) {
  ++host_calls_;
  undecided_ -= !r.no_side_effects;
  if (r.in_path.slave == static_cast<std::uint8_t>(Slave::kDdr)) count_decided();
  host_.completed(r);
}

void MemorySystem::slave_accepted(MemRequest& r, Picoseconds at) {
  event_time_ = at;
  Link link{*this};
  crossbar_.slave_accepted(link, r, at, r.master);
}

void MemorySystem::slave_done(MemRequest& r, Picoseconds at, bool error) {
  event_time_ = at;
  Link link{*this};
  crossbar_.slave_done(link, r, {at, at, 0, error});
}

/// What the controller's step decided for masters. The calls below may submit requests, but never to the
/// controller itself, so the news do not change meanwhile.
void MemorySystem::handle_news() {
  mem::DdrController::News& news = controller_.news();
  for (const auto& read : news.reads) handle_read(read);
  if (news.accepted) handle_acceptance(*news.accepted);
  news.clear();
}

inline void MemorySystem::handle_read(const mem::DdrController::ReadOutcome& read) {
  if (bypass_) [[unlikely]]
    return respond_directly(*read.request, read.first, read.last);
  Link link{*this};
  read_ = &read;
  crossbar_.slave_done(link, *read.request, {read.first, read.last, read.attributed, false});
  read_ = nullptr;
  if (!refused_.empty()) [[unlikely]]
    refuse_after(read.request, read.last);
}

void MemorySystem::tell(SlowRequest& s) const {
  controller_.tell_place(s.address - map_.ddr_base, s);
  if (read_) controller_.tell_waits(*read_, s);
}

void MemorySystem::handle_acceptance(const mem::DdrController::Acceptance& accepted) {
  const auto [request, at, unblocked_by] = accepted;
  if (!bypass_) [[likely]] {
    Link link{*this};
    return crossbar_.slave_accepted(link, *request, at, unblocked_by);
  }
  bypass_->input_taken = false;
  bypass_->input_freed = true;  // the next one goes when the news are handled
  bypass_->freed_at = at;
  if (request->write) respond_directly(*request, at, at);
}

unsigned MemorySystem::debug_access(const MemRequest& r) {
  const std::uint32_t offset = r.address - map_.ddr_base;
  if (offset >= map_.ddr_window) return 0;
  const auto inside = static_cast<std::uint32_t>(offset & (store_.size() - 1));
  const auto n = static_cast<unsigned>(std::min<std::uint64_t>(r.bytes, store_.size() - inside));
  if (r.write)
    controller_.debug_write(inside, r.data, n);
  else
    controller_.debug_read(inside, r.data, n);
  return n;
}

void MemorySystem::respond_directly(MemRequest& r, Picoseconds first, Picoseconds last) {
  ++host_calls_;
  undecided_ -= !r.no_side_effects;
  count_decided();
  r.first = first;
  r.last = last;
  if (crossbar_.count_latency(r, first)) crossbar_.note_slowest(r);
  host_.completed(r);
}

void MemorySystem::send_directly(MemRequest& r, Picoseconds at) {
  if (bypass_->input_taken) return bypass_->wait(r);
  bypass_->count(r, at);
  const bool taken = controller_.submit_inside(r, r.address - map_.ddr_base, at);
  bypass_->input_taken = !taken;
  if (taken && r.write) respond_directly(r, at, at);
}

void MemorySystem::send_waiting() {
  bypass_->input_freed = false;
  while (!bypass_->input_taken && bypass_->any_waits()) {
    MemRequest& r = bypass_->next();
    send_directly(r, std::max(r.issued, bypass_->freed_at));
  }
}

}  // namespace fovea::memsys
