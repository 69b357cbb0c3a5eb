#include "model/dma/edma_cc.h"

#include <algorithm>
#include <utility>

namespace fovea::dma {

EdmaCc::EdmaCc(sc_core::sc_module_name name, const EdmaParams& params)
    : WithRegs(static_cast<unsigned>(params.reset_priority())),
      BusTarget(name, regs),
      core_(regs, *this),
      params_(params) {
  add_clock(clk);
  add_power_gate(lpsc);
  add_interrupt("ccint0", completion.out);
  add_interrupt("ccerrint", error.out);
  add_statistics(stats);
  for (Reg* r : {static_cast<Reg*>(&regs.quetcmap), static_cast<Reg*>(&regs.quepri)})
    r->on_write([this](std::uint32_t) {
      written_.soon();
      work_arrived();
    });
  // What waits for room in a queue, or for a transfer controller, may have another one now.
  for (auto& r : regs.dmaqnum) r->on_write([this](std::uint32_t) { work_arrived(); });
  regs.qdmaqnum.on_write([this](std::uint32_t) { work_arrived(); });
  SC_METHOD(update_priorities);
  sensitive << written_.event();
  SC_METHOD(work);
  sensitive << wake_.event();
  dont_initialize();
  SC_METHOD(clock_changed);
  sensitive << clk << lpsc;
}

void EdmaCc::update_priorities() {
  std::array<std::uint32_t, kTransferControllers> level;
  level.fill(7);
  for (unsigned q = 0; q < kQueues; ++q) {
    const std::uint32_t tc = regs.quetcmap.queue[q]->get();
    if (tc >= kTransferControllers) {
      diagnostics().guest("QUETCMAP names a transfer controller that is not there");
      continue;
    }
    level[tc] = std::min(level[tc], regs.quepri.queue[q]->get());
  }
  for (unsigned tc = 0; tc < kTransferControllers; ++tc) priority[tc].write(level[tc]);
}

/// The edge `clocks` after the first one behind t.
Picoseconds EdmaCc::edge(Picoseconds t, std::uint64_t clocks) const {
  return clock_.edge(clock_.edge_after(t) + clocks);
}

void EdmaCc::clock_changed() {
  const Frequency f = clk.read();
  if (f != clock_.frequency()) clock_.restart(f, kernel_time());
  work_arrived();
}

/// Events, requests and completion codes under way are lost.
void EdmaCc::on_reset(ResetKind) {
  in_reset_ = true;
  core_.reset();
  events_.clear();
  completions_ = {};
  next_request_ = 0;
  waits_for_clock_ = 0;
  wake_.cancel();
  written_.soon();
}

void EdmaCc::leave_reset() { in_reset_ = false; }

void EdmaCc::event(unsigned channel) {
  if (!has_clock() && (regs.global.eer.get() >> channel & 1))
    warn("event " + std::to_string(channel) + " is lost: the channel controller has no clock");
  if (!running()) return;  // nothing is latched
  events_.push_back({kernel_time(), static_cast<std::uint8_t>(channel)});
  work_arrived();
}

void EdmaCc::completed(const TransferRequest& request, Picoseconds ended) {
  if (in_reset_) return;
  if (!request.interrupt && !request.chain) return;
  const auto clocks = static_cast<std::uint64_t>(params_.completion_clocks()) - 1;
  const Picoseconds at = running() ? edge(ended, clocks) : ended;
  completions_.push({at, ended, ++completion_count_, request});
  wake_.at(at);
}

void EdmaCc::dropped(const TransferRequest& request) {
  core_.dropped(request);
  work_arrived();
}

void EdmaCc::work_arrived() {
  if (running()) wake_.at(edge(kernel_time(), 0));
}

/// One edge: what has arrived since the last one is latched, then at most one event enters a queue and
/// at most one request leaves.
void EdmaCc::work() {
  if (!running()) return;  // clock_changed() continues
  const Picoseconds now = kernel_time();
  if (const Picoseconds at = clock_.next_edge_at_or_after(now); at != now) return wake_.at(at);
  const auto first_new = std::find_if(events_.begin(), events_.end(),
                                      [&](const Latched& e) { return e.at >= now; });
  std::vector<Latched> latched(events_.begin(), first_new);
  events_.erase(events_.begin(), first_new);
  for (const Latched& e : latched) core_.event(e.channel, e.at);
  while (!completions_.empty() && completions_.top().at <= now) {
    const Completion c = completions_.top();
    completions_.pop();
    core_.completed(c.request, c.ended);
  }
  const bool queued =
      core_.prioritise(edge(now, static_cast<std::uint64_t>(params_.event_clocks()) - 1));
  const bool requested = now >= next_request_ && core_.process(now);
  if (requested)
    next_request_ = edge(now, static_cast<std::uint64_t>(params_.request_clocks()) - 1);
  if (queued || requested || !events_.empty()) wake_.at(edge(now, 0));
  if (!completions_.empty()) wake_.at(completions_.top().at);
  for (const Picoseconds turn : {core_.next_turn(), core_.next_turn_after(now)})
    if (turn != kNever && std::max(turn, next_request_) > now) wake_.at(std::max(turn, next_request_));
  if (core_.next_turn() != kNever) wait_for_controllers(now);
  count();
}

/// A queue has entries: works again when a program register becomes free. One that is free from a known
/// time on has said so already, but an earlier wake-up may have taken the place of that one.
void EdmaCc::wait_for_controllers(Picoseconds now) {
  for (const TransferPort* port : controllers_)
    if (port)
      if (const Picoseconds free = port->program_free(); free != kNever && free >= now)
        wake_.at(free + 1);
}

void EdmaCc::count() {
  const ChannelController::Counts& c = core_.counts();
  stats.events += c.events - std::exchange(reported_.events, c.events);
  stats.requests += c.requests - std::exchange(reported_.requests, c.requests);
  stats.missed += c.missed - std::exchange(reported_.missed, c.missed);
  stats.links += c.links - std::exchange(reported_.links, c.links);
}

bool EdmaCc::can_submit(unsigned controller) const {
  const TransferPort* const port = controllers_[controller];
  if (port && !port->has_clock() && !(waits_for_clock_ >> controller & 1)) {
    waits_for_clock_ |= 1u << controller;
    diagnostics().guest("EDMA: a request waits for transfer controller " + std::to_string(controller) +
                        ", which has no clock");
  }
  return port && port->program_free() < kernel_time();
}

void EdmaCc::submit(unsigned controller, const TransferRequest& request) {
  waits_for_clock_ &= ~(1u << controller);
  controllers_[controller]->submit(request);
}

TransferTrigger EdmaCc::trigger() const {
  return {.kind = TransferTrigger::Kind::kWrite, .writer = accessing(), .at = kernel_time()};
}

void EdmaCc::trigger_written() {
  if (observers_.empty()) return;
  observers_.each([&](TransferObserver* o) { o->trigger_written(accessing(), kernel_time()); });
}

void EdmaCc::requested(const TransferRequest& request, const TransferTrigger& by, Picoseconds ready) {
  if (observers_.empty()) return;
  const unsigned burst = controllers_[request.controller]->burst();
  observers_.each([&](TransferObserver* o) { o->requested(request, by, burst, ready, kernel_time()); });
}

void EdmaCc::coded(const TransferTrigger& by) {
  if (observers_.empty()) return;
  observers_.each([&](TransferObserver* o) { o->coded(by, kernel_time()); });
}

/// Only region 0 has an interrupt of the ARM. Where the others' lead to is in no public list.
void EdmaCc::pulse_completion(unsigned region) {
  if (region != 0) {
    warn("the interrupt of shadow region " + std::to_string(region) + " is not connected on this chip");
    return;
  }
  ++stats.interrupts;
  observers_.each([&](TransferObserver* o) { o->completion_pulsed(kernel_time()); });
  completion.raise();
}

void EdmaCc::pulse_error() {
  ++stats.errors;
  error.raise();
}

void EdmaCc::events_enabled(std::uint64_t events) {
  if (on_events_enabled) on_events_enabled(events);
}

void EdmaCc::warn(const std::string& what) { diagnostics().guest("EDMA: " + what); }

}  // namespace fovea::dma
