#include "sw/fovea/replay/replay_path.h"

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
      slaves_(info.edma),
      ram_(info.edma),
      start_(info.start),
      last_(info.start),
      memory_(params.crossbar, params.ddr, {.ram_size = INTERNAL_RAM_BYTES}, *this, DiagnosticsRef::current(),
              memory_only ? memsys::Route::kBypass : memsys::Route::kCrossbar),
      check_(params.ddr, memory_.controller(), DiagnosticsRef::current()) {
  set_up_memory(params);
  set_up_streams();
  set_up_masters();
  set_up_transfers();
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
  scr_ = Clock(scr, both ? begins : scr_start);
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
  const bool of_transfers = std::any_of(info_.interrupts.begin(), info_.interrupts.end(),
                                        [](const trace::Interrupt& i) { return i.source != trace::kInterrupt; });
  if (of_transfers && !streams_.empty()) wake_order_.emplace(source_, 0, info_);
}

void ReplayPath::set_up_masters() {
  for (const trace::MasterInfo& from : info_.masters) {
    MasterState& m = masters_[index(from.id)];
    m.label = from.label;
    m.stream = from.stream;
    m.bursts = from.reads;
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

void ReplayPath::set_up_transfers() {
  const trace::EdmaInfo& edma = info_.edma;
  if (edma.request_clocks == 0) return;
  for (unsigned n = 0; n < kTransferControllers; ++n) {
    const MasterState &read = masters_[index(edma_read(n))], &write = masters_[index(edma_write(n))];
    if (read.label.empty() || write.label.empty() || read.stream != write.stream) continue;
    const unsigned stream = read.stream;
    streams_[stream].controller = n;
    streams_[stream].clock = scr_;
    pipes_[n] = std::make_unique<ReplayPipe>(
        edma_read(n), edma_write(n), read.bursts, dma::TransferController::Sizes{64, edma.fifo, edma.depth}, scr_,
        ReplayPipe::Events{
            .submit = [this](ReplayPipe::Burst& b) { send(b); },
            .ended =
                [this, stream](std::uint64_t number, Picoseconds at, Picoseconds delivered) {
                  Outcome& o = streams_[stream].history[number % kHistory];
                  o.last = at;
                  o.delivered = delivered;
                  if (time_[stream] == kNever) wake(stream);
                  wake_those_behind(stream);
                },
            .program_free = [this, stream] { wake(stream); }});
  }
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
  next_record(stream);
  prepare(stream);
}

void ReplayPath::next_record(unsigned stream) {
  Stream& s = streams_[stream];
  if (stream == 0 && wake_order_) return next_in_wake_order();
  s.number = s.played;
  s.valid = source_.next(stream, s.record);
  if (s.valid && s.record.kind == trace::Kind::kRequest) check(s.record, s);
  if (stream == 0 && !s.valid) note_end_of_core();
}

/// The trace has no more records of the core: it has ended when the last ones have gone out.
void ReplayPath::note_end_of_core() {
  if (ready_.empty())
    core_has_ended(info_.core_until);
  else
    ended_in_trace_ = true;
}

/// While the core sleeps, what goes on is chosen when its time is asked for.
void ReplayPath::next_in_wake_order() {
  Stream& s = streams_[0];
  asleep_ = false;
  if (std::exchange(chosen_, false)) wake_order_->take();
  WakeOrder::Numbered n;
  if (wake_order_->next(n)) return set_core_record(n);
  s.valid = asleep_ = wake_order_->asleep();
  settled_ = false;
  if (!s.valid) note_end_of_core();
}

void ReplayPath::end_with_window() {
  end_with_window_ = info_.core_until != 0;
  if (end_with_window_) stop_ = info_.end;
}

/// The core has done all that it did until `recorded`, at most, when the trace was recorded.
void ReplayPath::core_has_ended(Picoseconds recorded) {
  // A core that slept for longer before the window's end had done all it had to do by then.
  constexpr Picoseconds kAtWork = 20;
  const Picoseconds rest = info_.end - recorded;
  if (end_with_window_ && rest <= (info_.end - info_.start) / kAtWork) stop_ = std::min(stop_, core_last_ + rest);
}

void ReplayPath::set_core_record(WakeOrder::Numbered& n) {
  Stream& s = streams_[0];
  s.record = std::move(n.record);
  s.number = n.number;
  s.valid = true;
  if (s.record.kind == trace::Kind::kRequest) check(s.record, s);
}

/// @return a stream that may still wake the core earlier than what was chosen; kInterrupt: none
std::uint8_t ReplayPath::wake_core() {
  if (!asleep_ || settled_) return trace::kInterrupt;
  WakeOrder::Choice choice = wake_order_->choose([this](const trace::Record& r) { return event(r); });
  // Only interrupts at recorded times will wake it any more.
  if (!std::exchange(transfers_done_, wake_order_->transfers_done()) && transfers_done_)
    core_has_ended(wake_order_->latest_transfer());
  set_core_record(choice.first);
  chosen_ = true;
  settled_ = choice.settled;
  return choice.awaited;
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
  if (r.source != trace::kInterrupt) return moment(r.source, r.event, r.point);
  const trace::Interrupt& i = info_.interrupts[r.event];
  if (i.source == trace::kInterrupt) return i.at;
  const Picoseconds cause = moment(i.source, i.event, i.point);
  return cause == kNever ? kNever : cause + i.after;
}

Picoseconds ReplayPath::moment(std::uint8_t stream, std::uint64_t number, trace::Point point) const {
  const Stream& other = streams_[stream];
  const Outcome& o = other.history[number % kHistory];
  if (o.number != number) return number + kHistory <= other.played ? start_ : kNever;  // long done, or not yet
  switch (point) {
    case trace::Point::kEnd: return o.last;
    case trace::Point::kSubmitted: return o.first;
    case trace::Point::kDelivered: return o.delivered;
  }
  return kNever;
}

/// Of the stream's record, which has been played.
inline void ReplayPath::note_outcome(Stream& s, Picoseconds first, Picoseconds last) {
  s.history[s.number % kHistory] = {s.number, first, last, last};
  s.played = std::max(s.played, s.number + 1);
}

/// The first edge of the stream's bus clock at or after one of its clock.
inline std::uint64_t ReplayPath::aligned(const Stream& s, std::uint64_t edge) {
  return edge + (s.align + s.phase - edge % s.align) % s.align;
}

/// When the record's release lets it go; kNever while that is not known.
inline Picoseconds ReplayPath::released(const Stream& s) {
  const trace::Record& r = s.record;
  if (r.release == trace::Release::kAt) return r.at;
  Picoseconds from = start_;
  if (r.back != 0) {
    const std::uint64_t before = s.number - r.back;
    const Outcome& o = s.history[before % kHistory];
    from = o.number != before ? start_ : r.from_first ? o.first : o.last;
    if (from == kNever) return kNever;
  }
  std::uint64_t edge = s.clock.edge_at_or_after(from) + r.gap;
  const bool of_core = ram_.played() && &s == streams_.data();
  if (of_core) edge += wait_in_gap(r, edge - r.gap);
  if (r.release == trace::Release::kWhen) {
    const Picoseconds risen = event(r);
    if (risen == kNever) return kNever;
    edge = std::max(edge, s.clock.edge_at_or_after(risen)) + r.wake_gap;
    if (of_core && r.look_clocks != 0) {
      ram_.looks_until(edge);
      ram_.follow();
      note_ram_over();
    }
  }
  if (r.room != 0) {
    const std::uint64_t before = s.number - r.room;
    const Outcome& o = s.history[before % kHistory];
    const Picoseconds ended = o.number == before ? o.last : start_;
    if (ended == kNever) return kNever;
    edge = std::max(edge, aligned(s, s.clock.edge_at_or_after(ended)));
  }
  return s.clock.edge(edge);
}

/// Clocks for which the core waits for bursts in internal RAM, in the record's gap from an edge on.
std::uint64_t ReplayPath::wait_in_gap(const trace::Record& r, std::uint64_t edge) {
  if (asleep_ && !settled_) return 0;
  if (!ram_.known()) {
    ram_.gap_begins(r, edge);
    note_ram_over();
  }
  return ram_.waited();
}

void ReplayPath::note_ram_over() { ram_over_ = ram_.over(streams_[0].clock); }

/// Of a wait for another stream, which one; for an interrupt that of the transfer behind it.
std::uint8_t ReplayPath::awaited(const trace::Record& r) const {
  if (r.release != trace::Release::kWhen) return trace::kInterrupt;
  return r.source != trace::kInterrupt ? r.source : info_.interrupts[r.event].source;
}

/// The time of the stream's next request, if it is known.
void ReplayPath::prepare(unsigned stream) {
  if (stream == 0 && ram_.played()) return prepare_core();
  Stream& s = streams_[stream];
  set_time(stream, kNever);
  for (;;) {
    if (!s.valid) return;
    const std::uint8_t earlier = stream == 0 ? wake_core() : trace::kInterrupt;
    const trace::Record& r = s.record;
    if (r.on_bus()) {
      s.slot = place(masters_[index(r.master)], r.write);
      if (s.slot->free == kNever) return;
    }
    Picoseconds at = released(s);
    waits_for_[stream] = at == kNever ? awaited(r) : earlier;
    cross_ |= waits_for_[stream] != trace::kInterrupt;
    if (at == kNever) return;
    if (r.kind == trace::Kind::kTransfer) {
      at = turn_of_transfer(s, at);
      if (at != kNever) set_time(stream, at);
      return;
    }
    s.came = at;
    bool off_edge = s.align > 1 && r.release != trace::Release::kAt && r.kind != trace::Kind::kStep;
    if (r.on_bus() && s.slot->free > at) {
      at = s.slot->free;
      off_edge = s.align > 1;
    }
    if (off_edge) at = s.clock.edge(aligned(s, s.clock.edge_at_or_after(at)));
    if (r.kind == trace::Kind::kStep)
      at += r.service;  // the stores of the program before it may have gone out later
    else
      at = std::max(at, s.earliest);
    if (at > kLatest) throw UserError(fmt::format("trace '{}': it goes on for hours", name_));
    if (r.on_bus() || earlier != trace::kInterrupt) {
      set_time(stream, at);
      return;
    }
    if (r.kind == trace::Kind::kMark) marks_.push_back({r.address, at});
    if (stream == 0) core_last_ = std::max(core_last_, at);
    if (on_issue) on_issue(stream, at);
    note_outcome(s, at, at);
    if (cross_) wake_those_behind(stream);
    next_record(stream);
  }
}

/// When a request goes out that its program has come to at `came`.
Picoseconds ReplayPath::time_on_port(const Stream& s, const trace::Record& r, Picoseconds came,
                                     const Slot& slot) const {
  Picoseconds at = std::max(came, slot.free);
  if (s.align > 1 && (r.release != trace::Release::kAt || slot.free > came))
    at = s.clock.edge(aligned(s, s.clock.edge_at_or_after(at)));
  return std::max(at, s.earliest);
}

/// Where the trace has the core's accesses to internal RAM, its program is followed for itself: it comes to a record
/// at a time which bursts in the RAM may still postpone, and goes on while its requests wait for their port.
void ReplayPath::prepare_core() {
  Stream& s = streams_[0];
  program_time_ = program_time();
  // What the program shows is no part of it, and may come behind what it does next.
  for (; program_time_ != kNever && s.record.kind == trace::Kind::kMark; program_time_ = program_time()) {
    note_outcome(s, program_time_, program_time_);
    ready_.push_back({std::move(s.record), s.number, program_time_});
    ram_.next_record();
    next_record(0);
  }
  set_time(0, std::min(ready_time(), program_time_));
}

/// When the first request that the program has come to goes out; marks among them are noted.
Picoseconds ReplayPath::ready_time() {
  Stream& s = streams_[0];
  for (; !ready_.empty() && ready_.front().record.kind == trace::Kind::kMark; ready_.pop_front()) {
    const Picoseconds at = std::max(ready_.front().came, s.earliest);
    marks_.push_back({ready_.front().record.address, at});
    core_last_ = std::max(core_last_, at);
    if (on_issue) on_issue(0, at);
  }
  if (ready_.empty()) {
    if (std::exchange(ended_in_trace_, false)) core_has_ended(info_.core_until);
    return kNever;
  }
  const Ready& r = ready_.front();
  ready_slot_ = place(masters_[index(r.record.master)], r.record.write);
  return ready_slot_->free == kNever ? kNever : time_on_port(s, r.record, r.came, *ready_slot_);
}

/// When the program comes to the core's next record, as far as is known.
Picoseconds ReplayPath::program_time() {
  Stream& s = streams_[0];
  // A core that sleeps has seen its buffers out.
  if (!s.valid || (asleep_ && !ready_.empty())) return kNever;
  const std::uint8_t earlier = wake_core();
  const trace::Record& r = s.record;
  const Picoseconds at = released(s);
  waits_for_[0] = at == kNever ? awaited(r) : earlier;
  cross_ |= waits_for_[0] != trace::kInterrupt;
  if (at == kNever) return kNever;
  if (at > kLatest) throw UserError(fmt::format("trace '{}': it goes on for hours", name_));
  if (r.kind == trace::Kind::kMark) return at;
  return std::max(program_at_, r.kind == trace::Kind::kStep ? at + r.service : at);
}

/// The time of the core's next event has come: a request goes out, or its program has come to the next record.
void ReplayPath::go_on_with_core() {
  Stream& s = streams_[0];
  const Picoseconds now = next_time_;
  if (program_time_ > now) {
    const Ready ready = std::move(ready_.front());
    ready_.pop_front();
    issue_request(0, ready.record, ready.number, ready.came, *ready_slot_);
    prepare(0);
    return find_next();
  }
  settled_ = true;  // nothing has woken the core earlier
  program_at_ = now;
  const trace::Record& r = s.record;
  note_outcome(s, r.kind == trace::Kind::kStep || r.write ? now : kNever, r.on_bus() ? kNever : now);
  if (r.kind == trace::Kind::kStep) {
    core_last_ = std::max(core_last_, now);
    if (on_issue) on_issue(0, now);
  } else {
    ready_.push_back({std::move(s.record), s.number, now});
  }
  ram_.next_record();
  next_record(0);
  if (cross_) wake_those_behind(0);
  prepare(0);
  find_next();
}

/// When the channel controller submits a transfer whose turn comes at `ready`: at an edge of its clock, once its
/// transfer controller's program register is free and the request before is formed.
Picoseconds ReplayPath::turn_of_transfer(const Stream& s, Picoseconds ready) const {
  const Picoseconds free = pipes_[s.controller]->program_free_from();
  if (free == kNever) return kNever;
  const Picoseconds from = std::max({ready, next_request_, free + 1, s.earliest});
  return scr_.edge(scr_.edge_at_or_after(from));
}

/// The record is the stream's next one, and its time has come.
void ReplayPath::submit_transfer(unsigned stream) {
  Stream& s = streams_[stream];
  const Picoseconds now = next_time_;
  TransferRequest request = s.record.transfer;
  request.number = s.number;
  const bool moves = request.bytes() != 0;
  masters_[index(edma_read(s.controller))].at_recorded_time += s.record.release == trace::Release::kAt && s.number > 0;
  note_outcome(s, now, moves ? kNever : now);
  s.earliest = now;
  next_request_ = scr_.edge(scr_.edge_after(now) + info_.edma.request_clocks - 1);
  if (on_issue) on_issue(stream, now);
  for (const Master m : {edma_read(s.controller), edma_write(s.controller)}) {
    if (masters_[index(m)].priority == s.record.priority) continue;
    masters_[index(m)].priority = s.record.priority;
    memory_.crossbar().set_priority(m, s.record.priority);
  }
  const unsigned burst = s.record.burst;
  const auto in_ram = [this](const TransferRequest::Side& side) {
    return side.address - memory_.map().ram_base < memory_.map().ram_size;
  };
  if (moves && in_ram(request.source))
    slaves_.expect(edma_read(s.controller), request.bytes(), s.record.ram_waits[false]);
  if (moves && in_ram(request.destination))
    slaves_.expect(edma_write(s.controller), request.bytes(), s.record.ram_waits[true]);
  set_time(stream, kNever);
  if (moves) pipes_[s.controller]->submit(request, burst, now);
  fetch(stream);
  wake_those_behind(stream);
  for (unsigned i = 0; i < streams_.size(); ++i)
    if (i != stream && streams_[i].controller != kTransferControllers && time_[i] < next_request_) prepare(i);
  find_next();
}

/// Puts a burst on its port, or where there is no crossbar hands it to its slave.
void ReplayPath::send(ReplayPipe::Burst& burst) {
  const bool sdram = burst.address >= memory_.map().ddr_base;
  if (sdram) {
    const MasterState& m = masters_[index(burst.master)];
    if (std::uint64_t{burst.address - memory_.map().ddr_base} + burst.bytes > memory_.store().size())
      throw UserError(fmt::format("trace '{}': a transfer of {}: {} bytes at 0x{:08x}: outside the SDRAM of {} MiB "
                                  "(ddr.part)", name_, m.label, burst.bytes,
                                  burst.address - memory_.map().ddr_base, memory_.store().size() >> 20));
    ++requests_;
    bytes_ += burst.bytes;
  }
  if (sdram || !memory_only_) masters_[index(burst.master)].count(burst.write, burst.bytes);
  // The crossbar takes a request before its time; without it there is nothing that would hold it back.
  if (memory_only_) return slaves_.add({&burst, burst.issued, true});
  memory_.submit(burst);
}

void ReplayPath::serve(MemRequest& r, bus::Slave slave, Picoseconds arrival) {
  if (slave == bus::Slave::kInternalRam && ram_.played()) {
    ram_.arrive(r, arrival);
    return begin_in_ram();
  }
  Picoseconds done = 0;
  if (slave == bus::Slave::kInternalRam) {
    done = slaves_.serve_ram(r, streams_[0].clock, arrival);
  } else if (is_core(r.master)) {
    const auto& slot = static_cast<Slot&>(r);
    done = slaves_.serve_registers(r, slot.service, arrival);
    delivered(slot, done);
  } else {
    done = slaves_.serve_registers(r, arrival);
  }
  if (!is_core(r.master)) static_cast<ReplayPipe::Burst&>(r).delivered = done;
  slaves_.add({&r, done});
}

/// The core's write changes its register at `at`.
void ReplayPath::delivered(const Slot& slot, Picoseconds at) {
  const unsigned stream = masters_[index(slot.master)].stream;
  streams_[stream].history[slot.number % kHistory].delivered = at;
  wake_those_behind(stream);
}

Taken ReplayPath::deliver(MemRequest& r, bus::Slave slave, Picoseconds arrival) {
  serve(r, slave, arrival);
  return Taken::kYes;
}

/// The RAM takes the next burst, if it is at rest.
void ReplayPath::begin_in_ram() {
  if (!ram_.waiting()) return;
  const std::uint64_t before = ram_.waited();
  ram_.begin(streams_[0].clock);
  note_ram_over();
  if (ram_.waited() != before) wake(0);
}

/// The burst in the RAM is over, unless the program has looked at a word there meanwhile.
void ReplayPath::end_in_ram() {
  const Picoseconds now = ram_over_;
  const Clock& core = streams_[0].clock;
  if (ram_.known() && streams_[0].valid) {
    const trace::Record& r = streams_[0].record;
    if (r.look_clocks != 0 && event(r) == kNever) {
      ram_.looks_until(core.edge_at_or_after(now) + 1);
      ram_.follow();
      note_ram_over();
      if (ram_over_ > now) return;
    }
  }
  MemRequest& r = ram_.finish(now);
  ram_over_ = kNever;
  static_cast<ReplayPipe::Burst&>(r).delivered = now;
  end_served(r, now);
  begin_in_ram();
}

void ReplayPath::finish_served() {
  const ReplaySlaves::Due first = slaves_.take();
  if (first.arrives) {
    if (first.request->address >= memory_.map().ddr_base) return memory_.submit(*first.request);
    return serve(*first.request, memory_.slave_of(*first.request), first.at);
  }
  end_served(*first.request, first.at);
}

void ReplayPath::end_served(MemRequest& r, Picoseconds at) {
  if (!memory_only_) return memory_.slave_done(r, at, false);
  r.first = r.last = at;
  completed(r);
}

void ReplayPath::completed(MemRequest& r) {
  if (streams_[masters_[index(r.master)].stream].controller == kTransferControllers)
    return complete(static_cast<Slot&>(r));
  auto& burst = static_cast<ReplayPipe::Burst&>(r);
  last_ = std::max(last_, burst.last);
  static_cast<ReplayPipe*>(burst.owner)->completed(burst);
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
  if (stream == 0 && ram_.played()) return go_on_with_core();
  Stream& s = streams_[stream];
  const trace::Record& r = s.record;
  if (r.kind == trace::Kind::kTransfer) return submit_transfer(stream);
  if (stream == 0) settled_ = true;  // nothing has woken the core earlier
  if (!r.on_bus()) {
    prepare(stream);
    return find_next();
  }
  note_outcome(s, r.write ? s.came : kNever, kNever);
  issue_request(stream, r, s.number, s.came, *s.slot);
  fetch(stream);
  find_next();
}

void ReplayPath::issue_request(unsigned stream, const trace::Record& r, std::uint64_t number, Picoseconds came,
                               Slot& slot) {
  Stream& s = streams_[stream];
  MasterState& m = masters_[index(r.master)];
  if (m.in_turn) {
    unsigned& turn = m.turn[r.write];
    if (++turn == (r.write ? m.slots.size() : m.read_slots_to))
      turn = r.write ? m.write_slots_from : 0;
  }
  slot.free = kNever;
  slot.number = number;
  const bool aside = r.kind == trace::Kind::kAside;
  slot.address = aside ? r.address : memory_.map().ddr_base + r.address;
  slot.service = r.service;
  slot.critical = r.critical;
  slot.issued = next_time_;
  slot.write = r.write;
  slot.locked = r.locked;
  slot.bytes = r.bytes;
  slot.came = came;
  s.earliest = next_time_;
  if (stream == 0) core_last_ = next_time_;
  if (on_issue) [[unlikely]]
    on_issue(stream, next_time_);
  if (!aside) {
    ++requests_;
    bytes_ += r.bytes;
    m.at_recorded_time += r.release == trace::Release::kAt && number > 0;
  }
  if (!aside || !memory_only_) m.count(r.write, r.bytes);
  if (m.priority != r.priority) {
    m.priority = r.priority;
    memory_.crossbar().set_priority(r.master, r.priority);
  }
  if (aside && memory_only_)
    serve(slot, bus::Slave::kConfig, slot.issued);
  else
    memory_.submit(slot);
}

bool ReplayPath::run_before(Picoseconds until) {
  if (ended_early_ != kNever) return true;
  for (;;) {
    if (stop_ < until) until = stop_;
    const Picoseconds event = memory_.next_event(), slave = std::min(slaves_.next(), ram_over_);
    if (slave < std::min(next_time_, event)) [[unlikely]] {  // after all else of its instant
      if (slave >= until) break;
      if (ram_over_ < slaves_.next())
        end_in_ram();
      else
        finish_served();
    } else if (next_time_ <= event) {
      if (next_time_ >= until) break;
      issue();
    } else if (!memory_.advance(std::min({next_time_, until, slave == kNever ? kNever : slave + 1})) &&
               until <= next_time_ && until <= std::min(slaves_.next(), ram_over_)) {
      break;
    }
  }
  const bool all = std::min(next_time_, next_event()) == kNever;
  if (until == stop_ && !all) {
    ended_early_ = stop_;
    leave_out_the_rest();
    return true;
  }
  if (!all) return false;
  for (const Stream& s : streams_)
    if (s.valid)  // a locked read without its write keeps all others out
      throw UserError(fmt::format("trace '{}': it stops before its end", name_));
  return true;
}

void ReplayPath::leave_out_the_rest() {
  for (; !ready_.empty(); ready_.pop_front()) left_out_ += ready_.front().record.on_bus();
  for (unsigned i = 0; i < streams_.size(); ++i)
    for (Stream& s = streams_[i]; s.valid; next_record(i)) {
      left_out_ += s.record.on_bus() || s.record.kind == trace::Kind::kTransfer;
      if (i == 0 && asleep_) wake_core();
    }
  while (!marks_.empty() && marks_.back().at > ended_early_) marks_.pop_back();
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
  if (Outcome& o = streams_[m.stream].history[slot.number % kHistory]; o.number == slot.number) {
    o.first = slot.write ? slot.came : slot.first;
    o.last = slot.last;
    if (o.delivered == kNever) o.delivered = slot.last;
  }
  if (time_[m.stream] == kNever || (m.stream == 0 && ram_.played())) wake(m.stream);
  if (cross_) [[unlikely]]
    wake_those_behind(m.stream);
}

/// Those that wait for something of the stream.
void ReplayPath::wake_those_behind(unsigned stream) {
  for (unsigned i = 0; i < streams_.size(); ++i)
    if (waits_for_[i] == stream && (time_[i] == kNever || i == 0)) wake(i);
}

void ReplayPath::wake(unsigned stream) {
  prepare(stream);
  if (stream == next_stream_) {
    find_next();
  } else if (time_[stream] < next_time_ || (time_[stream] == next_time_ && stream < next_stream_)) {
    next_stream_ = stream;
    next_time_ = time_[stream];
  }
}

}  // namespace fovea::app
