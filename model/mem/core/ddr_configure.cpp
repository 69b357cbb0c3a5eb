// What the controller takes from its parameters, registers and clocks.
#include <bit>
#include <tuple>

#include "model/common/check.h"
#include "model/mem/core/ddr_controller.h"
#include "model/mem/core/scheduler/policies.h"

namespace fovea::mem {

DdrController::DdrController(const DdrParams& params, BackingStore& store)
    : store_(store),
      size_(store.size()),
      fifo_entries_(params.command_fifo()),
      write_fifo_words_(static_cast<unsigned>(params.write_fifo() / 8)),
      request_latency_(static_cast<unsigned>(params.request_latency())),
      return_latency_(static_cast<unsigned>(params.return_latency())),
      clock_restart_(static_cast<unsigned>(params.clock_restart())),
      retention_(params.retention()),
      release_(static_cast<unsigned>(params.refresh_release())),
      need_(static_cast<unsigned>(params.refresh_need())),
      must_(static_cast<unsigned>(params.refresh_must())),
      gap_limit_(static_cast<unsigned>(params.refresh_gap())),
      policy_(scheduler_policy(params)) {
  return_channel_.set_fifo(static_cast<unsigned>(params.read_fifo()));
  configure(DdrConfig{}, 0);
}

void DdrController::set_clocks(Frequency ddr, Frequency scr, Picoseconds at) {
  catch_up(at);
  if (!(ddr == ddr_.frequency())) {
    ddr_.restart(ddr, at);
    if (ddr_.running()) first_edge_ = ddr_.edge_at_or_after(at);
    attribution_.restart_clock(first_edge_);
  }
  if (!(scr == scr_.frequency())) scr_.restart(scr, at);
  running_ = ddr_.running() && scr_.running();
  input_blocked_ = !running_ || input_taken_;
  if (ddr_.running()) command_free_ = std::max(command_free_, ddr_.edge_after(at));
  if (scr_.running()) return_channel_.start(scr_.edge_at_or_after(scr_.start()));
  if (on_change) on_change(at);
  plan_anew();
}

void DdrController::configure(const DdrConfig& config, Picoseconds at) {
  catch_up(at);
  const std::uint64_t now = ddr_.running() ? ddr_.edge_after(at) : 0;
  if (config.low_power != config_.low_power) sleep_changes(config.low_power, now);
  // Refresh keeps its phase when only timing changes; a new interval starts to count now, and those
  // that ran out before are owed.
  if (next_expiry_ != 0 && now != 0) count_owed(now - 1);
  if (config.refresh_interval != config_.refresh_interval || next_expiry_ == 0)
    next_expiry_ = config.refresh_interval ? now + config.refresh_interval : kNoClock;
  command_free_ = std::max(command_free_, now);
  config_ = config;
  device_.configure(config.timing);
  attribution_.set_write_clocks(config.timing.WL() + DdrTiming::kBurstClocks);
  return_channel_.set_latency(std::max(config.read_latency, config.timing.CL) + return_latency_);
  const unsigned bank_bits = static_cast<unsigned>(std::bit_width(config.timing.banks)) - 1;
  bank_mask_ = config.timing.banks - 1;
  if (config.bank_on_top) {
    bank_shift_ = static_cast<unsigned>(std::bit_width(store_.size())) - 1 - bank_bits;
    row_shift_ = config.page_log2;
    row_mask_ = (1u << bank_shift_) - 1;
  } else {
    bank_shift_ = config.page_log2;
    row_shift_ = config.page_log2 + bank_bits;
    row_mask_ = ~0u;
  }
  if (on_change) on_change(at);
  urgency_changed();
  plan_anew();
}

void DdrController::set_command_hook(CommandHook hook, void* self) {
  std::erase_if(listeners_, [&](const auto& l) { return l.second == self; });
  if (hook) listeners_.emplace_back(hook, self);
  hook_ = nullptr;
  hook_self_ = this;
  if (listeners_.size() == 1) std::tie(hook_, hook_self_) = listeners_.front();
  if (listeners_.size() < 2) return;
  hook_ = [](void* all, Cmd cmd, unsigned bank, std::uint32_t row, std::uint64_t clock) {
    for (const auto& [one, its_self] : static_cast<DdrController*>(all)->listeners_)
      one(its_self, cmd, bank, row, clock);
  };
}

}  // namespace fovea::mem
