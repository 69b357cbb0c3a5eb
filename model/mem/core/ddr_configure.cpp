// What the controller takes from its parameters, registers and clocks.
#include <algorithm>
#include <bit>
#include <tuple>

#include "model/common/check.h"
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {

DdrConfig idealised(DdrConfig c, const DdrParams& params) {
  // The smallest CL that a part of this kind has above 200 MHz (JESD79-2); it decides on WL too.
  constexpr unsigned kLeastLatency = 4;
  DdrTiming& t = c.timing;
  if (params.ideal.is("row_timing")) t.nRP = t.nRCD = t.nRAS = t.nRC = t.nRRD = t.nRTP = t.nWR = 1;
  if (params.ideal.is("cas_latency")) {
    t.CL = std::min(t.CL, kLeastLatency);
    c.read_latency = std::min(c.read_latency, kLeastLatency);
  }
  if (params.ideal.is("turnaround")) t.nWTR = 1;
  if (params.ideal.is("refresh")) c.refresh_interval = 0;
  return c;
}

DdrController::DdrController(const DdrParams& params, BackingStore& store, const DiagnosticsRef& diagnostics)
    : store_(store),
      size_(store.size()),
      fifo_entries_(params.command_fifo()),
      write_fifo_words_(static_cast<unsigned>(params.write_fifo() / 8)),
      request_latency_(static_cast<unsigned>(params.request_latency())),
      return_latency_(static_cast<unsigned>(params.return_latency())),
      retention_(params.retention()),
      refresh_({static_cast<unsigned>(params.refresh_release()), static_cast<unsigned>(params.refresh_need()),
                static_cast<unsigned>(params.refresh_must()), static_cast<unsigned>(params.refresh_gap())},
               stats, diagnostics),
      power_(static_cast<unsigned>(params.clock_restart()), stats),
      scheduler_(scheduler_of(params)),
      diagnostics_(diagnostics) {
  returns_.channel().set_fifo(static_cast<unsigned>(params.read_fifo()));
  with_scheduler([&]<Scheduler S>(S) {
    returns_.set_reorders(S::kReordersReads);
    rows_.close_after_access(S::kClosesRows);
  });
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
  if (scr_.running()) returns_.channel().start(scr_.edge_at_or_after(scr_.start()));
  if (on_change) on_change(at);
  plan_anew();
}

void DdrController::configure(const DdrConfig& config, Picoseconds at) {
  catch_up(at);
  const std::uint64_t now = ddr_.running() ? ddr_.edge_after(at) : 0;
  if (config.low_power != config_.low_power) sleep_changes(config.low_power, now);
  // Refresh keeps its phase when only timing changes.
  refresh_.set_interval(config.refresh_interval, now);
  rows_.set_limit(std::uint64_t{config.row_intervals} * config.refresh_interval);
  command_free_ = std::max(command_free_, now);
  config_ = config;
  columns_take_effect();
  device_.configure(config.timing);
  attribution_.set_write_clocks(config.timing.WL() + DdrTiming::kBurstClocks);
  returns_.channel().set_latency(std::max(config.read_latency, config.timing.CL) + return_latency_);
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
  update_deadlines();
  plan_anew();
}

void DdrController::call_hooks(Cmd cmd, unsigned bank, std::uint32_t row, std::uint64_t clock) {
  hooks_.each([&](const Hook& hook) { hook.call(hook.self, cmd, bank, row, clock); });
}

}  // namespace fovea::mem
