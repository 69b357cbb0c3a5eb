// Of the recorder: what the transfers of the EDMA and the core wait for from each other. The rules and their
// reasons: model/decisions/0006-trace.md.
#include <algorithm>
#include <iterator>

#include "model/contract/memory_map.h"
#include "model/trace/core/recorder.h"

namespace fovea::trace {
namespace {

constexpr std::size_t kTriggersKept = 64;
/// So many looks at a word make it one that the program waits at, and so far apart (clocks of the core) they are one
/// loop.
constexpr unsigned kLooksOfALoop = 3;
constexpr std::uint64_t kClocksOfALoop = 64;
/// So many looks at one register, one behind the other, may be at as many of its bits; more are a loop.
constexpr unsigned kLooksRecorded = 8;
/// From a completion code's pulse to the core's interrupt line.
constexpr Picoseconds kToTheLine = kPsPerUs;
/// A core that woke so many clocks ago serves an interrupt, and sleeps again when it has done so.
constexpr std::uint64_t kClocksOfAHandler = 4096;
constexpr std::size_t kEndsKept = 16;
/// Accesses to internal RAM between two records of the core; of more, the latest ones.
constexpr std::size_t kAccessesKept = 1u << 16;

}  // namespace

/// A register access of the core: of its write buffer, or one that it waits for. Looks at one register again and again
/// are not recorded: how many there are is a matter of what the program waits for.
void BusRecorder::submit_aside(const MemRequest& r) {
  if (delayed_ && !surroundings_.transfers_under_way()) begin(r.issued);
  const bool recorded = open_ && r.issued >= start_;
  const bool waits = !r.write || core_(&r).asked == 0;
  if (waits) {
    if (recorded) {
      note_sleep();
      note_ends(r.issued);
    }
    register_access_ = true;
    awaited_ = &r;
    if (looks_in_a_loop(r)) return;
    place_waits();
    place_work_before(r);
  } else {
    place_wait_before(r);
    posted_.push_back(&r);
  }
  Stream& s = streams_[0];
  const std::uint64_t number = s.next;
  Pending& p = append(s, r.issued);
  p.record.kind = Kind::kAside;
  p.record.write = r.write;
  p.record.bytes = r.bytes;
  p.record.master = r.master;
  p.record.address = r.address;
  if (surroundings_.register_latency) p.record.service = surroundings_.register_latency(r.address);
  s.history[number % kHistory].write = r.write;
  flights_[index(r.master)].push_back({&r, number});
  if (recorded) release_core(s, p, r);
}

/// Whether the program's accesses before, kLooksRecorded of them, were to the same register.
bool BusRecorder::looks_in_a_loop(const MemRequest& r) {
  const std::uint64_t now = clock_.running() ? clock_.edge_at_or_after(r.issued) : 0;
  if (r.write || register_looks_.count == 0 || register_looks_.place != r.address)
    register_looks_ = {r.address, now, now, 0, 0, 0};
  register_looks_.latest = now;
  // A code from before the first look is seen without a wait.
  if (++register_looks_.count == 1) code_seen_ = true;
  return register_looks_.count > kLooksRecorded;
}

/// A burst of a transfer, which follows from its record. Which of them changes a word that the program looks at, and
/// what each waits for in internal RAM, is noted.
void BusRecorder::submit_of_transfer(const MemRequest& r, bool to_sdram) {
  Controller& c = controllers_[master_info(r.master).unit];
  auto& to_issue = c.to_issue[r.write];
  if (to_issue.empty()) return;  // of a request from before the recorder
  Controller::Left& left = to_issue.front();
  left.bytes -= std::min<std::uint32_t>(left.bytes, r.bytes);
  if (!to_sdram) c.elsewhere[r.write].push_back({r.address, left.number, left.bursts++, left.bytes == 0});
  if (left.bytes == 0) to_issue.pop_front();
}

void BusRecorder::register_done(const MemRequest& r) {
  if (of_transfers_ >> index(r.master) & 1u) {
    auto& under_way = controllers_[master_info(r.master).unit].elsewhere[r.write];
    const auto it = std::find_if(under_way.begin(), under_way.end(),
                                 [&](const Controller::Elsewhere& w) { return w.address == r.address; });
    if (it != under_way.end()) under_way.erase(it);
    return;
  }
  if (stream_of_[index(r.master)] != 0) return;
  if (const auto it = std::find(posted_.begin(), posted_.end(), &r); it != posted_.end()) posted_.erase(it);
  if (awaited_ == &r) awaited_ = nullptr;
  end_flight(r);
  // A loop that looks at a register sees the code that was set since its look before.
  if (r.write || register_looks_.count < 2 || code_seen_) return;
  code_seen_ = true;
  note_wait(register_looks_.first, clock_.edge_at_or_after(r.last), core_(nullptr).room_waits - room_waits_at_open_,
            {transfer_of(code_), code_.kind == TransferTrigger::Kind::kEnded ? Point::kEnd : Point::kSubmitted,
             code_.at});
}

/// The record of the core's write that changes a register now; kNone: it has none.
std::uint64_t BusRecorder::register_write() const {
  const MemRequest* by = awaited_ || posted_.empty() ? awaited_ : posted_.front();
  if (!by) return kNone;
  const auto& flights = flights_[index(by->master)];
  const auto it = std::find_if(flights.begin(), flights.end(), [&](const Flight& f) { return f.request == by; });
  return it == flights.end() ? kNone : it->number;
}

void BusRecorder::trigger_written(Master writer, Picoseconds at) {
  const std::uint64_t by = stream_of_[index(writer)] == 0 ? register_write() : kNone;
  if (by == kNone) return;
  triggers_.push_back({at, by});
  places_.emplace(by, kNone);
  if (triggers_.size() > kTriggersKept) triggers_.pop_front();
}

void BusRecorder::requested(const TransferRequest& request, const TransferTrigger& by, unsigned burst,
                            Picoseconds ready, Picoseconds at) {
  Controller& c = controllers_[request.controller];
  if (c.stream == ~0u) {  // a load shares its ports, whose requests are not told apart
    if (open_ && at >= start_)
      not_followed_ |= 1u << index(edma_read(request.controller)) | 1u << index(edma_write(request.controller));
    return;
  }
  Stream& s = streams_[c.stream];
  if (c.base == kNone) c.base = request.number - s.next;
  const std::uint64_t number = s.next;
  Pending& p = append(s, at);
  p.done = true;
  p.ready = ready;
  p.record.kind = Kind::kTransfer;
  p.record.transfer = request;
  TransferRequest& t = p.record.transfer;
  t.tcc = t.controller = 0;
  t.interrupt = t.chain = false;
  t.number = 0;
  p.record.burst = static_cast<std::uint8_t>(burst);
  if (surroundings_.priority)
    p.record.priority = static_cast<std::uint8_t>(surroundings_.priority(edma_read(request.controller)));
  if (request.bytes() != 0)
    for (auto& to_issue : c.to_issue) to_issue.push_back({number, request.bytes(), 0});
  if (!open_ || at < start_) return;
  release_transfer(p, by, ready);
  write_out(s, c.stream, kHeldBack);
}

BusRecorder::Transfer BusRecorder::transfer_of(const TransferTrigger& by) const {
  const Controller& c = controllers_[by.controller];
  if (c.stream == ~0u || c.base == kNone) return {};
  return {static_cast<std::uint8_t>(c.stream), by.number - c.base};
}

void BusRecorder::release_transfer(Pending& p, const TransferTrigger& by, Picoseconds ready) {
  Transfer source;
  Point point = Point::kEnd;
  switch (by.kind) {
    case TransferTrigger::Kind::kEvent:
      return;  // at its time
    case TransferTrigger::Kind::kWrite: {
      const auto it =
          std::find_if(triggers_.rbegin(), triggers_.rend(), [&](const Written& w) { return w.at == by.at; });
      if (it == triggers_.rend()) break;
      source = {0, it->number};
      point = Point::kDelivered;
      break;
    }
    case TransferTrigger::Kind::kSubmitted:
      source = transfer_of(by);
      point = Point::kSubmitted;
      break;
    case TransferTrigger::Kind::kEnded:
      source = transfer_of(by);
      break;
  }
  if (source.stream == kInterrupt) {
    if (by.at >= start_) not_followed_ |= 1u << index(edma_read(p.record.transfer.controller));
    return;
  }
  p.record.release = Release::kWhen;
  p.record.source = source.stream;
  p.record.point = point;
  p.event = source.number;
  const std::uint64_t to = scr_.edge_at_or_after(ready), from = scr_.edge_at_or_after(by.at);
  p.record.wake_gap = static_cast<std::uint32_t>(to - std::min(from, to));
}

BusRecorder::Pending& BusRecorder::append_step(Picoseconds at) {
  Stream& s = streams_[0];
  Pending& p = append(s, at);
  p.done = true;
  p.record.kind = Kind::kStep;
  s.history[(s.next - 1) % kHistory] = {s.next - 1, kNone, at, at, true, false};
  return p;
}

/// What follows in the program counts from the step just appended.
void BusRecorder::note_step(std::uint64_t room_waits, std::uint64_t asked) {
  Stream& s = streams_[0];
  const std::uint64_t number = s.next - 1;
  steps_[next_step_++ % kSteps] = {number, asked, room_waits, false, true};
  s.blocking_read = number;
  const Outcome* latest = outcome(s, s.latest);
  if (!latest || (latest->done && latest->last <= s.history[number % kHistory].first)) s.latest = number;
}

std::size_t BusRecorder::interrupt_before(std::uint64_t woke) const {
  std::size_t n = interrupts_.size();
  while (n > 0 && (!interrupts_[n - 1].rose || clock_.edge_at_or_after(interrupts_[n - 1].at) > woke)) --n;
  return n > 0 ? n - 1 : interrupts_.size();
}

/// The core has slept since its last request: what it does next, a register access, depends on what woke it.
void BusRecorder::note_sleep() {
  const CoreState now = core_(nullptr);
  const std::uint64_t idle = now.idle - core_before_.idle;
  if (idle == 0 || now.woke == 0) return;
  const std::uint64_t woke = now.woke - now.origin;
  const std::size_t by = interrupt_before(woke);
  if (by == interrupts_.size()) return;
  core_before_.idle = now.idle;
  place_waits();
  Stream& s = streams_[0];
  const Outcome* anchor = outcome(s, s.latest);
  if (anchor && !anchor->done) anchor = nullptr;
  const std::uint64_t before = anchor ? anchor->number : kNone;
  const bool first = anchor && !anchor->write;
  const std::uint64_t from = anchor ? clock_.edge_at_or_after(first ? anchor->first : anchor->last) : woke;
  Pending& p = append_step(clock_.edge(woke));
  p.record.release = Release::kWhen;
  p.record.event = by;
  const std::uint64_t risen = clock_.edge_at_or_after(interrupts_[by].at);
  p.record.wake_gap = static_cast<std::uint32_t>(woke - std::min(risen, woke));
  if (before != kNone) {
    p.reference = before;
    p.record.from_first = first;
    const std::uint64_t not_own = from + idle + take_accesses(p.record, true, from, woke);
    p.record.gap = woke > not_own ? woke - not_own : 0;
  }
  const std::uint64_t room_waits = now.room_waits - room_waits_at_open_;
  note_step(room_waits, woke - std::min(room_waits, woke));
}

void BusRecorder::coded(const TransferTrigger& by, Picoseconds at) {
  code_ = by;
  code_seen_ = false;
  ended_.push_back(by);
  ended_.back().at = at;
  if (ended_.size() > kEndsKept) ended_.pop_front();
}

/// Transfers that ended while the core served another interrupt: it would have slept until then if they had ended
/// later. The register access at `at` is the first one that may see it.
void BusRecorder::note_ends(Picoseconds at) {
  if (ended_.empty()) return;
  const auto ended = std::exchange(ended_, {});
  const CoreState now = core_(nullptr);
  const std::uint64_t woke = now.woke - std::min(now.origin, now.woke), to = clock_.edge_at_or_after(at);
  if (now.woke == 0 || to > woke + kClocksOfAHandler) return;
  for (const TransferTrigger& by : ended) {
    if (clock_.edge_at_or_after(by.at) <= woke) continue;
    const auto of = [&](const Risen& i) { return i.by.number == by.number && i.by.controller == by.controller; };
    const auto risen = std::find_if(interrupts_.rbegin(), interrupts_.rend(), of);
    std::size_t event = static_cast<std::size_t>(interrupts_.rend() - risen) - 1;
    if (risen == interrupts_.rend() || risen->pulsed == 0) {
      event = interrupts_.size();
      const Picoseconds latest = interrupts_.empty() ? by.at : std::max(by.at, interrupts_.back().at);
      interrupts_.push_back({latest, by, by.at, false});
      interrupts_.back().by.at = latest;
    }
    place_waits();
    Pending& p = append_step(at);
    release_behind_latest(streams_[0], p, at, 1);
    p.record.gap -= std::min(p.record.gap, take_accesses(p.record, true, to - std::min(to, p.record.gap), to));
    p.record.release = Release::kWhen;
    p.record.event = event;
    const std::uint64_t room_waits = now.room_waits - room_waits_at_open_;
    note_step(room_waits, to - std::min(room_waits, to));
  }
}

/// The program has waited in a loop from `began` on and has `seen` the end, all in clocks of the core; without a
/// wait both are one. Stores from before may still be in the write buffer: the wait comes behind them in the stream.
void BusRecorder::note_wait(std::uint64_t began, std::uint64_t seen, std::uint64_t room_waits, const WaitEnd& end) {
  if (!open_ || end.by.stream == kInterrupt || clock_.edge(seen) < start_ || end.at < start_) return;
  note_sleep();
  waits_.push_back({began, seen, room_waits, end});
}

/// Those waits become records that ended no later than the program came to `asked`.
void BusRecorder::place_waits(std::uint64_t asked) {
  Stream& s = streams_[0];
  for (; !waits_.empty() && waits_.front().asked() <= asked; waits_.pop_front()) {
    const Wait& w = waits_.front();
    Pending& p = append_step(clock_.edge(w.seen));
    release_in_program(s, p, w.began - std::min(w.room_waits, w.began));
    if (w.end.point == Point::kDelivered) take_looks(p.record, w.began - std::min(w.room_waits, w.began), w.asked());
    p.record.release = Release::kWhen;
    p.record.source = w.end.by.stream;
    p.record.point = w.end.point;
    p.event = w.end.by.number;
    const std::uint64_t waited_until = std::max(clock_.edge_at_or_after(w.end.at), w.began);
    p.record.wake_gap = static_cast<std::uint32_t>(w.seen - std::min(waited_until, w.seen));
    note_step(w.room_waits, w.asked());
  }
}

void BusRecorder::place_wait_before(const MemRequest& r) {
  if (waits_.empty()) return;
  const CoreState now = core_(&r);
  place_waits(now.asked == 0 ? kNone : now.asked + room_waits_at_open_ - now.origin);
}

/// The words that the program waits at are those that it has looked at again and again, and all that the same
/// instruction looks at: the code of a loop that waits may find its first looks at some of its words fulfilled.
void BusRecorder::note_flag(const Load& load) {
  const bool polls = std::find(pollers_.begin(), pollers_.end(), load.pc) != pollers_.end();
  if (!polls && ram_looks_.by_pc < kLooksOfALoop) return;
  if (!polls) pollers_[next_poller_++ % pollers_.size()] = load.pc;
  flags_[next_flag_++ % flags_.size()] = {.word = load.offset & ~3u, .by = {}};
}

void BusRecorder::loaded(const Load& load) {
  const std::uint32_t word = load.offset & ~3u;
  if (ram_looks_.count == 0 || ram_looks_.place != word || load.clock - ram_looks_.latest > kClocksOfALoop)
    ram_looks_ = {word, load.clock, load.clock, 0, 0, 0};
  ram_looks_.latest = load.clock;
  ++ram_looks_.count;
  ram_looks_.by_pc = ram_looks_.pc == load.pc ? ram_looks_.by_pc + 1 : 1;
  ram_looks_.pc = load.pc;
  const auto flag = std::find_if(flags_.begin(), flags_.end(), [&](const Flag& f) { return f.word == word; });
  if (flag == flags_.end()) return note_flag(load);
  if (!std::exchange(flag->written, false) || !flag->last || !open_) return;
  const std::uint64_t origin = core_(nullptr).origin;
  note_wait(ram_looks_.first - origin, load.clock - origin, load.room_waits - room_waits_at_open_,
            {flag->by, Point::kDelivered, flag->at});
  ram_looks_ = {};
}

void BusRecorder::accessed(const Access& access) {
  if (!open_ || surroundings_.edma.ram_banks == 0 || access.clock < core_origin_) return;
  const std::uint32_t bank = access.offset / (INTERNAL_RAM_BYTES / surroundings_.edma.ram_banks);
  accesses_.push_back({access.clock - core_origin_, access.waited, access.room_waits - room_waits_at_open_, access.pc,
                       static_cast<std::uint8_t>(bank)});
  if (accesses_.size() > kAccessesKept) accesses_.pop_front();
}

/// The record's gap was from `from` to `to`, clocks with or without those that the core has waited for room: what it
/// did in internal RAM meanwhile becomes part of the record. Accesses from before that no record has taken are
/// forgotten. @return clocks for which they waited for the EDMA, which are not the core's own
std::uint64_t BusRecorder::take_accesses(Record& r, bool with_room_waits, std::uint64_t from, std::uint64_t to) {
  std::uint64_t waited = 0, last = 0;
  std::uint32_t pc = 0;  // of the last one
  for (; !accesses_.empty() && accesses_.front().place(with_room_waits) < to; accesses_.pop_front()) {
    const RamAccess& a = accesses_.front();
    const std::uint64_t got = a.place(with_room_waits);
    if (got < from || r.ram.size() == kMaxRamRuns) continue;
    const std::uint64_t wanted = std::max(from, got - std::min(got, a.waited));
    const std::uint64_t place = wanted - from - waited;
    waited += got - wanted;
    const bool follows = !r.ram.empty() && r.ram.back().bank == a.bank && place == last + surroundings_.edma.ram_hold;
    if (follows && a.pc == pc && r.ram.back().count > 1 && !r.ram.back().together) {
      --r.ram.back().count;  // the last one was this instruction's first
      r.ram.push_back({surroundings_.edma.ram_hold, 2, a.bank, true});
    } else if (follows && (a.pc == pc || !r.ram.back().together)) {
      ++r.ram.back().count;
      r.ram.back().together = a.pc == pc;
    } else {
      r.ram.push_back({static_cast<std::uint32_t>(place - last), 1, a.bank});
    }
    last = place;
    pc = a.pc;
  }
  return waited;
}

/// A request for which the core sees its buffers out first: it is released by their end. What the program did in
/// internal RAM before it came to the request becomes a step of its own.
void BusRecorder::place_work_before(const MemRequest& r) {
  const Stream& s = streams_[0];
  if (accesses_.empty() || !open_ || r.issued < start_ || (s.written == 0 && s.pending.empty())) return;
  const CoreState now = core_(&r);
  if (now.drains == core_before_.drains && !register_access_) return;
  const std::uint64_t asked =
      now.asked == 0 ? accesses_.back().place(false) + 1 : now.asked + room_waits_at_open_ - now.origin;
  if (accesses_.front().place(false) >= asked) return;
  Pending& p = append_step(clock_.edge(asked));
  release_in_program(streams_[0], p, asked);
}

/// The program has looked at a word of internal RAM in vain from `began` on, and has `seen` it changed: how often,
/// which it would do for as long as it takes. A program that has not looked in vain would look as it did before.
void BusRecorder::take_looks(Record& r, std::uint64_t began, std::uint64_t seen) {
  std::uint64_t last = began;
  for (unsigned looks = 0; began < seen && !accesses_.empty() && accesses_.front().place(false) <= seen;) {
    const RamAccess a = accesses_.front();
    const std::uint64_t place = a.place(false);
    if (place >= began && ++looks == 1) {
      std::uint64_t before = 0;  // where the last access in the gap was
      for (const RamRun& run : r.ram) before += run.skip + std::uint64_t{run.count - 1} * surroundings_.edma.ram_hold;
      r.ram.push_back({static_cast<std::uint32_t>(r.gap - std::min(r.gap, before)), 1, a.bank});
    } else if (place >= began) {
      looks_.clocks = static_cast<std::uint32_t>(place - last - std::min(place - last, a.waited));
      if (looks == 2) looks_.after = looks_.clocks;
      looks_.bank = a.bank;
    }
    if (place == seen) break;  // a part of what comes next
    last = place;
    accesses_.pop_front();
  }
  if (looks_.clocks == 0) return;
  r.look_after = looks_.after;
  r.look_clocks = looks_.clocks;
  r.look_bank = looks_.bank;
}

void BusRecorder::moved(const Burst& burst, Picoseconds at) {
  if (!(of_transfers_ >> index(burst.master) & 1u)) return;
  const Controller& c = controllers_[master_info(burst.master).unit];
  const auto& under_way = c.elsewhere[burst.write];
  const auto it = std::find_if(under_way.begin(), under_way.end(), [&](const Controller::Elsewhere& w) {
    return w.address - INTERNAL_RAM_DATA_BASE == burst.offset;
  });
  if (it == under_way.end()) return;
  if (surroundings_.edma.ram_banks == 0) note_ram_waits(c, *it, burst);
  if (!burst.write) return;
  for (Flag& f : flags_)
    if (f.word - burst.offset < burst.bytes)
      f = {f.word, true, it->last, {static_cast<std::uint8_t>(c.stream), it->number}, at};
}

/// The transfer's record is held back at least until its bursts have ended.
void BusRecorder::note_ram_waits(const Controller& c, const Controller::Elsewhere& of, const Burst& burst) {
  Stream& s = streams_[c.stream];
  const std::uint64_t first_pending = s.next - s.pending.size();
  if (burst.waited == 0 || of.number < first_pending) return;
  auto& waits = s.pending[of.number - first_pending].record.ram_waits[burst.write];
  waits.resize(std::max<std::size_t>(waits.size(), of.burst + 1));
  waits[of.burst] = static_cast<std::uint16_t>(std::min<std::uint64_t>(burst.waited, 0xFFFF));
}

void BusRecorder::interrupt(Picoseconds at) {
  const bool by_code = pulsed_at_ != 0 && at >= pulsed_at_ && at - pulsed_at_ <= kToTheLine;
  interrupts_.push_back({at, pulse_, by_code ? pulsed_at_ : 0});
  if (by_code) pulsed_at_ = 0;
}

void BusRecorder::list_interrupts(TraceInfo& info) {
  for (const Risen& i : interrupts_) {
    if (i.at >= end_) continue;
    Interrupt& out = info.interrupts.emplace_back(Interrupt{.at = i.at});
    if (i.pulsed == 0) continue;
    const Transfer by = transfer_of(i.by);
    const std::uint64_t place = by.stream == kInterrupt ? kNone : place_of(by.stream, by.number);
    if (place == kNone) continue;
    out.source = by.stream;
    out.point = i.by.kind == TransferTrigger::Kind::kEnded ? Point::kEnd : Point::kSubmitted;
    out.event = place;
    out.after = i.at - i.by.at;
  }
}

}  // namespace fovea::trace
