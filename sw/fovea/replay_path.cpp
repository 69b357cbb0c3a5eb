#include "sw/fovea/replay_path.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "model/board/frame_log.h"
#include "model/board/clock_presets.h"

namespace fovea::app {
namespace {

constexpr Picoseconds kLatest = 7200 * kPsPerSecond;

/// An edge of the clock less than `den` seconds before t, which is exact: nothing needs to be played
/// from power-up.
Picoseconds start_near(const trace::ClockInfo& c, Picoseconds t) {
  const Picoseconds whole = c.frequency.den * kPsPerSecond;
  return t > c.start ? c.start + (t - c.start) / whole * whole : c.start;
}

}  // namespace

ReplayPath::ReplayPath(std::string name, const trace::TraceInfo& info, trace::RecordSource& source,
                       const ReplayParams& params, bool memory_only)
    : name_(std::move(name)),
      info_(info),
      source_(source),
      memory_only_(memory_only),
      start_(info.start),
      last_(info.start),
      memory_(params.crossbar, params.ddr, {.ddr_base = 0}, *this,
              memory_only ? memsys::Route::kBypass : memsys::Route::kCrossbar),
      check_(params.ddr, memory_.controller()) {
  set_up_memory(params);
  set_up_streams();
  set_up_masters();
  time_.fill(kNever);
  waits_for_.fill(trace::kInterrupt);
  for (unsigned i = 0; i < streams_.size(); ++i) fetch(i);
  find_next();
}

/// Clocks and registers as they are at the start of the trace, or as the parameters have them.
void ReplayPath::set_up_memory(const ReplayParams& params) {
  // The file's clock is exact, a parameter's in whole hertz: it counts only if it was changed.
  const auto clock = [](const trace::ClockInfo& file, const IntParam& param) {
    const Frequency wanted(param());
    const bool same = !file.frequency.stopped() &&
                      std::abs(file.frequency.hertz() - wanted.hertz()) < 1.0;
    return same ? file.frequency : wanted;
  };
  const Frequency ddr_clock = clock(info_.ddr, params.registers.clock);
  Frequency scr = clock(info_.scr, params.clocks.clock);
  // Half of the SDRAM's clock is so exactly, whatever whole hertz its key has.
  const bool of_one_pll = std::abs(2 * scr.hertz() - ddr_clock.hertz()) < 2.0;
  if (of_one_pll && !(scr == info_.scr.frequency)) scr = board::ClockSetting::half(ddr_clock);
  const bool other = !info_.ddr.frequency.stopped() && !(ddr_clock == info_.ddr.frequency);
  const bool both = other && !(scr == info_.scr.frequency);
  const Picoseconds scr_start = start_near(info_.scr, info_.start);
  // Both clocks come from one PLL (SYSCLK7 = 2 x SYSCLK4): another clock of the SDRAM starts with an
  // edge of the crossbar's. That has the edges that it would have if the PLL had been programmed so
  // when it was started; what it is to the core's clock on the board is not known.
  Picoseconds begins = info_.start;
  if (!memory_only_) begins = Clock(scr, scr_start).next_edge_at_or_after(begins);
  mem::DdrController& controller = memory_.controller();
  memory_.crossbar().set_clock(scr, both ? begins : scr_start);
  const Frequency scr_before = both ? info_.scr.frequency : scr;
  controller.set_clocks({}, scr_before, scr_start);
  controller.set_clocks(other ? info_.ddr.frequency : ddr_clock, scr_before, start_near(info_.ddr, info_.start));
  mem::DdrConfig config = params.config();
  const unsigned interval = std::exchange(config.refresh_interval, 0);
  controller.configure(config, 0);
  config.refresh_interval = interval;  // counts from here
  controller.configure(config, info_.refresh ? info_.refresh : info_.start);
  controller.catch_up(info_.start);  // the refreshes before
  if (other) controller.set_clocks(ddr_clock, scr, begins);
  controller.stats.reset();
  memory_.timeline().begin(info_.start);
}

void ReplayPath::set_up_streams() {
  streams_.resize(info_.streams.size());
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    const trace::StreamInfo& from = info_.streams[i];
    streams_[i].clock = Clock(from.clock, from.clock_start);
    streams_[i].align = from.align;
    streams_[i].phase = from.phase;
    streams_[i].earliest = info_.start;
    streams_[i].history.resize(kHistory);
  }
}

void ReplayPath::set_up_masters() {
  for (const trace::MasterInfo& from : info_.masters) {
    MasterState& m = masters_[index(from.id)];
    m.label = from.label;
    m.stream = from.stream;
    m.slots = std::vector<Slot>(from.shared ? from.reads : from.reads + from.writes);
    m.read_slots_to = from.reads;
    m.write_slots_from = from.shared ? 0 : from.reads;
    m.in_turn = !from.shared && !memory_only_;
    m.turn = {0, from.reads};
    for (Slot& s : m.slots) {
      s.owner = &m;
      s.master = from.id;
      s.data = s.bytes_.data();
    }
  }
  for (const std::string& label : labels()) {
    std::vector<bus::PortLatencies*> ports;
    for (std::size_t i = 0; i < kMasterCount; ++i)
      if (masters_[i].label == label) ports.push_back(&memory_.crossbar().latencies[i]);
    const auto stats = std::make_shared<bus::LatencyStats>(label, std::move(ports));
    for (MasterState& m : masters_)
      if (m.label == label) m.latency = stats;
  }
}

std::vector<std::string> ReplayPath::labels() const {
  std::vector<std::string> out;
  for (const MasterState& m : masters_)
    if (!m.label.empty() && std::find(out.begin(), out.end(), m.label) == out.end())
      out.push_back(m.label);
  return out;
}

void ReplayPath::check(const trace::Record& r, const Stream& s) {
  const auto refuse = [&](const std::string& why) {
    std::string where = source_.place(static_cast<unsigned>(&s - streams_.data()));
    if (where.empty()) where = fmt::format("record {}", s.number);
    throw UserError(fmt::format("trace '{}': {} of {}: {} bytes at 0x{:08x}: {}", name_, where,
                                masters_[index(r.master)].label, r.bytes, r.address, why));
  };
  const std::uint64_t size = memory_.store().size();
  if (std::uint64_t{r.address} + r.bytes > size)
    refuse(fmt::format("outside the SDRAM of {} MiB (ddr.part)", size >> 20));
  if (r.address % 1024 + r.bytes > 1024) refuse("a burst stays inside 1024 aligned bytes (AHB)");
}

/// Takes the stream's next record; marks are noted on the way.
void ReplayPath::fetch(unsigned stream) {
  Stream& s = streams_[stream];
  s.valid = source_.next(stream, s.record);
  if (s.valid && !s.record.mark) check(s.record, s);
  prepare(stream);
}

/// The slot that is free first.
inline ReplayPath::Slot* ReplayPath::place(MasterState& m, bool write) {
  if (m.in_turn) return &m.slots[m.turn[write]];
  const std::size_t from = write ? m.write_slots_from : 0;
  const std::size_t to = write ? m.slots.size() : m.read_slots_to;
  Slot* best = &m.slots[from];
  for (std::size_t i = from + 1; i < to; ++i)
    if (m.slots[i].free < best->free) best = &m.slots[i];
  return best;
}

/// When what a record waits for outside its stream comes; kNever while that is not known.
Picoseconds ReplayPath::event(const trace::Record& r) const {
  if (r.source == trace::kInterrupt) return info_.interrupts[r.event];
  const Stream& other = streams_[r.source];
  if (r.event >= other.number) return kNever;
  if (r.event + kHistory <= other.number) return start_;  // long done
  return other.history[r.event % kHistory].last;
}

/// The first edge of the stream's bus clock at or after one of its clock.
inline std::uint64_t ReplayPath::aligned(const Stream& s, std::uint64_t edge) {
  return edge + (s.align + s.phase - edge % s.align) % s.align;
}

/// When the record's release lets it go; kNever while that is not known.
inline Picoseconds ReplayPath::released(const Stream& s) const {
  const trace::Record& r = s.record;
  if (r.release == trace::Release::kAt) return r.at;
  Picoseconds from = start_;
  if (r.back != 0) {
    const Outcome& o = s.history[(s.number - r.back) % kHistory];
    from = r.from_first ? o.first : o.last;
    if (from == kNever) return kNever;
  }
  std::uint64_t edge = s.clock.edge_at_or_after(from) + r.gap;
  if (r.release == trace::Release::kWhen) {
    const Picoseconds risen = event(r);
    if (risen == kNever) return kNever;
    edge = std::max(edge, s.clock.edge_at_or_after(risen)) + r.wake_gap;
  }
  if (r.room != 0) {
    const Picoseconds ended = s.history[(s.number - r.room) % kHistory].last;
    if (ended == kNever) return kNever;
    edge = std::max(edge, aligned(s, s.clock.edge_at_or_after(ended)));
  }
  return s.clock.edge(edge);
}

/// The time of the stream's next request, if it is known.
void ReplayPath::prepare(unsigned stream) {
  Stream& s = streams_[stream];
  set_time(stream, kNever);
  for (;;) {
    if (!s.valid) return;
    if (!s.record.mark) {
      s.slot = place(masters_[index(s.record.master)], s.record.write);
      if (s.slot->free == kNever) return;
    }
    Picoseconds at = released(s);
    waits_for_[stream] = at == kNever && s.record.release == trace::Release::kWhen
                             ? s.record.source
                             : trace::kInterrupt;
    cross_ |= waits_for_[stream] != trace::kInterrupt;
    if (at == kNever) return;
    s.came = at;
    bool off_edge = s.align > 1 && s.record.release != trace::Release::kAt;
    if (!s.record.mark && s.slot->free > at) {
      at = s.slot->free;
      off_edge = s.align > 1;
    }
    if (off_edge) at = s.clock.edge(aligned(s, s.clock.edge_at_or_after(at)));
    at = std::max(at, s.earliest);
    if (at > kLatest) throw UserError(fmt::format("trace '{}': it goes on for hours", name_));
    if (!s.record.mark) {
      set_time(stream, at);
      return;
    }
    marks_.push_back({s.record.address, at});
    if (on_issue) on_issue(stream, at);
    s.history[s.number++ % kHistory] = {at, at};
    s.valid = source_.next(stream, s.record);
    if (s.valid && !s.record.mark) check(s.record, s);
  }
}

void ReplayPath::find_next() {
  next_time_ = kNever;
  for (std::uint32_t set = due_; set; set &= set - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(set));
    if (time_[i] < next_time_) {
      next_stream_ = i;
      next_time_ = time_[i];
    }
  }
}

void ReplayPath::issue() {
  const unsigned stream = next_stream_;
  Stream& s = streams_[stream];
  const trace::Record& r = s.record;
  Slot& slot = *s.slot;
  MasterState& m = masters_[index(r.master)];
  if (m.in_turn) {
    unsigned& turn = m.turn[r.write];
    if (++turn == (r.write ? m.slots.size() : m.read_slots_to))
      turn = r.write ? m.write_slots_from : 0;
  }
  slot.free = kNever;
  slot.number = s.number;
  slot.address = r.address;
  slot.critical = r.critical;
  slot.issued = next_time_;
  slot.write = r.write;
  slot.locked = r.locked;
  slot.bytes = r.bytes;
  slot.came = s.came;
  s.history[s.number++ % kHistory] = {r.write ? s.came : kNever, kNever};
  s.earliest = next_time_;
  if (on_issue) [[unlikely]]
    on_issue(stream, next_time_);
  ++requests_;
  ++m.transactions;
  m.at_recorded_time += r.release == trace::Release::kAt && s.number > 1;
  bytes_ += r.bytes;
  (r.write ? m.write_bytes : m.read_bytes) += r.bytes;
  if (m.priority != r.priority) {
    m.priority = r.priority;
    memory_.crossbar().set_priority(r.master, r.priority);
  }
  memory_.submit(slot);
  fetch(stream);
  find_next();
}

bool ReplayPath::run_before(Picoseconds until) {
  for (;;) {
    if (next_time_ <= memory_.next_event()) {
      if (next_time_ >= until) break;
      issue();
    } else if (!memory_.advance(std::min(next_time_, until)) && until <= next_time_) {
      break;
    }
  }
  if (std::min(next_time_, memory_.next_event()) != kNever) return false;
  for (const Stream& s : streams_)
    if (s.valid)  // a locked read without its write keeps all others out
      throw UserError(fmt::format("trace '{}': it stops before its end", name_));
  return true;
}

Picoseconds ReplayPath::end() const {
  const Clock& clock = ddr().ddr_clock();
  const Picoseconds stepped = memory_.last_command_time();
  if (stepped == 0 || !clock.running()) return last_;
  const std::uint64_t data = ddr().config().timing.WL() + mem::DdrTiming::kBurstClocks;
  return std::max(last_, clock.edge(clock.edge_at_or_after(stepped) + data));
}

std::vector<Picoseconds> ReplayPath::remap_times() const {
  std::vector<Picoseconds> out;
  const auto phase = [](const Mark& m) { return board::phase_of(m.value); };
  const Mark* begun = nullptr;
  for (const Mark& m : marks_) {
    if (phase(m) == board::Phase::kRemapStart) begun = &m;
    if (phase(m) != board::Phase::kRemapEnd || !begun) continue;
    if (PHASE_SEQUENCE(m.value) == PHASE_SEQUENCE(begun->value)) out.push_back(m.at - begun->at);
    begun = nullptr;
  }
  return out;
}

/// The outcome is in the slot.
void ReplayPath::complete(Slot& slot) {
  MasterState& m = *static_cast<MasterState*>(slot.owner);
  last_ = std::max(last_, slot.last);
  slot.free = slot.last;
  streams_[m.stream].history[slot.number % kHistory] = {slot.write ? slot.came : slot.first,
                                                          slot.last};
  if (time_[m.stream] == kNever) wake(m.stream);
  if (cross_) [[unlikely]]
    for (unsigned i = 0; i < streams_.size(); ++i)
      if (waits_for_[i] == m.stream) wake(i);
}

void ReplayPath::wake(unsigned stream) {
  prepare(stream);
  if (time_[stream] < next_time_) {
    next_stream_ = stream;
    next_time_ = time_[stream];
  }
}

}  // namespace fovea::app
