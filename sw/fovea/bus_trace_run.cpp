#include "sw/fovea/bus_trace_run.h"

#include <map>

#include "sw/fovea/replay_params.h"

namespace fovea::app {

BusTraceRun::BusTraceRun(const std::filesystem::path& file, const ParamSet& params,
                         board::Board& board)
    : file_(file), params_(params), board_(board), recorder_(board.dm365.make_recorder()) {
  const auto pins = board.dm365.gpio.on_output;
  board.dm365.gpio.on_output = [this, pins](unsigned bank, std::uint32_t out, Picoseconds at) {
    pins(bank, out, at);
    if (bank == 2) recorder_->mark(out, at);
  };
  board.dm365.ddr.controller().set_command_hook(&BusTraceRun::command, this);
}

void BusTraceRun::command(void* self, mem::Cmd cmd, unsigned, std::uint32_t, std::uint64_t clock) {
  auto& run = *static_cast<BusTraceRun*>(self);
  if (cmd == mem::Cmd::kRef && !run.opened_)
    run.refreshes_[run.refresh_count_++ % run.refreshes_.size()] = clock;
}

/// Refreshes come when an interval ends, or later when the memory is busy: the phase that most of
/// the last ones share is the interval's.
Picoseconds BusTraceRun::refresh_phase() const {
  const std::uint64_t interval = board_.dm365.ddr.programmed().refresh_interval;
  if (interval == 0 || refresh_count_ < refreshes_.size()) return 0;
  std::map<std::uint64_t, unsigned> shared;
  std::uint64_t best = refreshes_[0];
  for (const std::uint64_t clock : refreshes_) {
    const unsigned n = ++shared[clock % interval];
    if (n >= shared[best % interval]) best = clock;
  }
  return board_.dm365.ddr.controller().ddr_clock().edge(best);
}

BusTraceRun::~BusTraceRun() {
  board_.dm365.scr.crossbar().observe(nullptr);
  board_.dm365.tap.attach(nullptr);
  board_.dm365.ddr.controller().set_command_hook(nullptr, this);
  if (complete_) return;
  std::error_code ignored;
  std::filesystem::remove(file_.path(), ignored);
}

void BusTraceRun::open() {
  const trace::BusTap& tap = board_.dm365.tap;
  core_ = tap.core();
  scr_ = tap.scr();
  ddr_ = tap.ddr();
  refresh_ = refresh_phase();
  recorder_->open(kernel_time(), core_.frequency, core_.start);
  opened_ = true;
}

void BusTraceRun::close() {
  const trace::BusTap& tap = board_.dm365.tap;
  if (!(core_ == tap.core() && scr_ == tap.scr() && ddr_ == tap.ddr()))
    Diagnostics::instance().not_modelled("a clock that changes inside a bus trace");
  recorder_->close(kernel_time());
  closed_ = true;
}

void BusTraceRun::finish() {
  if (!opened_ || !closed_) return;
  trace::TraceInfo info;
  info.scr = scr_;
  info.ddr = ddr_;
  info.refresh = refresh_;
  info.params = replay_keys(params_, board_.dm365.ddr.programmed(), scr_.frequency,
                            ddr_.frequency);
  recorder_->finish(std::move(info), [this](std::string_view bytes) { file_.write(bytes); });
  file_.close();
  complete_ = true;
}

}  // namespace fovea::app
