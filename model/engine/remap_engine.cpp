#include "model/engine/remap_engine.h"

#include <algorithm>

namespace fovea::engine {
namespace {

constexpr unsigned kTagBits = 48;

/// A bit for each byte of which a bit is set.
unsigned strobes_of(std::uint32_t lanes) {
  unsigned strobes = 0;
  for (unsigned n = 0; n < 4; ++n)
    if (lanes >> 8 * n & 0xFF) strobes |= 1u << n;
  return strobes;
}

}  // namespace

RemapEngine::RemapEngine(sc_core::sc_module_name name, const EngineParams& params)
    : BusTarget(name, regs),
      backend_(make_backend(params, clock_, *this, comparison())),
      memory_("memory", Master::kRemapEngine, kSlots,
              backend_->takes_answers_ahead() ? BurstMaster::Report::kFirstBeatWhenDecided
                                              : BurstMaster::Report::kAtFirstBeat),
      ahead_(backend_->takes_answers_ahead()) {
  add_clock(clk);
  add_interrupt("remapint", interrupt_line.out);
  add_statistics(stats);
  if (params.compares()) add_statistics(pair.emplace());
  add_master(Master::kRemapEngine, memory_.socket, kSlots);
  memory_.on_done = [this](const BurstMaster::Completion& c) { answered(c); };
  for (Reg* reg : regs.regs()) connect(*reg);
  SC_METHOD(call);
  sensitive << call_.event();
  dont_initialize();
  SC_METHOD(slot_free);
  sensitive << slot_free_.event();
  dont_initialize();
  SC_METHOD(report_errors);
  sensitive << failed_.event();
  dont_initialize();
  SC_METHOD(clock_changed);
  sensitive << clk;
}

Comparison RemapEngine::comparison() {
  return {.on_equal = [this](std::int64_t lag) { pair->note(lag); },
          .on_skipped = [this](std::uint64_t requests) { pair->skipped += requests; },
          .on_difference =
              [this](const std::string& what) {
                difference_ = what;
                sc_core::sc_pause();
              }};
}

/// The values are the backend's.
void RemapEngine::connect(Reg& reg) {
  reg.on_read([this, &reg] {
    const Picoseconds now = kernel_time();
    backend_->run(now);
    reg.set(backend_->read(reg.offset(), now));
    if (&reg == &regs.ended) count_jobs(reg.get());
    go_on();
  });
  reg.on_write([this, &reg](std::uint32_t word) {
    const Picoseconds now = kernel_time();
    backend_->run(now);
    backend_->write(reg.offset(), word, strobes_of(reg.written_lanes()), now);
    go_on();
  });
}

void RemapEngine::go_on() {
  const Picoseconds now = kernel_time(), next = backend_->run(now);
  if (next != next_call_) call_.move_to(next_call_ = next);
  const bool busy = backend_->busy();
  if (was_busy_ && !busy) count_jobs(backend_->read(regs.ended.offset(), now));
  was_busy_ = busy;
}

void RemapEngine::call() {
  next_call_ = kNever;
  go_on();
}

void RemapEngine::count_jobs(std::uint32_t ended) {
  const auto count = static_cast<std::uint16_t>(ended >> 16);
  stats.jobs += static_cast<std::uint16_t>(count - ended_);
  ended_ = count;
}

void RemapEngine::clock_changed() {
  if (clk.read() == clock_.frequency()) return;
  const Picoseconds now = kernel_time();
  backend_->run(now);
  clock_.restart(clk.read(), now);
  go_on();
}

/// Requests under way are still answered, but the engine no longer waits for the answers.
void RemapEngine::on_reset(ResetKind) {
  ++resets_;
  waiting_.clear();
  failures_.clear();
  backend_->reset();
  call_.cancel();
  next_call_ = kNever;
  was_busy_ = false;
  ended_ = 0;
}

void RemapEngine::interrupt(bool level) {
  if (!level) return;
  ++stats.interrupts;
  interrupt_line.raise();
}

/// With kSlots or fewer under way there is always a free slot; bursts with gaps are more requests.
void RemapEngine::issue(const Burst& burst, Picoseconds at) {
  if (waiting_.empty() && memory_.free_from() <= at) return put(burst, at);
  waiting_.push_back({burst, {burst.data.begin(), burst.data.end()}, at});
}

/// Ahead of its time it is not certain which slot is free first.
void RemapEngine::issue_waiting() {
  if (waiting_.empty()) return;
  if (ahead_) return slot_free_.at(memory_.free_from());
  while (!waiting_.empty() && memory_.free_from() != kNever) issue_first_waiting();
}

void RemapEngine::slot_free() {
  while (!waiting_.empty() && memory_.can_issue()) issue_first_waiting();
  issue_waiting();
}

void RemapEngine::issue_first_waiting() {
  Waiting w = std::move(waiting_.front());
  waiting_.pop_front();
  w.burst.data = w.data;
  put(w.burst, std::max({w.at, memory_.free_from(), kernel_time()}));
}

void RemapEngine::put(const Burst& burst, Picoseconds at) {
  FOVEA_CHECK(burst.tag >> kTagBits == 0, "a tag that is too long");
  const std::uint64_t tag = burst.tag | resets_ << kTagBits;
  if (burst.write) {
    stats.writes.add(at, 1);
    stats.write_bytes.add(at, burst.bytes);
    return memory_.write(burst.address, burst.data, tag, at, false);
  }
  const bool map = burst.id == kMapReads;
  (map ? stats.map_reads : stats.source_reads).add(at, 1);
  (map ? stats.map_bytes : stats.source_bytes).add(at, burst.bytes);
  memory_.read(burst.address, burst.bytes, tag, at, false);
}

void RemapEngine::answered(const BurstMaster::Completion& c) {
  if (c.tag >> kTagBits != resets_) return issue_waiting();  // from before a reset: only its slot matters
  if (c.error) {
    failures_.emplace_back(c.write ? c.last : c.first, c.write);
    failed_.at(failures_.front().first);
  }
  backend_->answer({c.tag & ((std::uint64_t{1} << kTagBits) - 1), c.write, c.error, c.data, c.first, c.last});
  issue_waiting();
  go_on();
}

void RemapEngine::report_errors() {
  for (; !failures_.empty() && failures_.front().first <= kernel_time(); failures_.pop_front()) {
    ++stats.errors;
    diagnostics().guest(failures_.front().second ? "remap engine: a write that nobody answers (bus error)"
                                                 : "remap engine: a read that nobody answers (bus error)");
  }
  if (!failures_.empty()) failed_.at(failures_.front().first);
}

}  // namespace fovea::engine
