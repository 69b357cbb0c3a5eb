#include "model/trace/core/recorder.h"

#include <algorithm>

#include "model/common/check.h"
#include "model/contract/memory_map.h"

namespace fovea::trace {
namespace {

constexpr unsigned kNoStream = ~0u;
constexpr unsigned kSdramBase = DDR_BASE;  // the masters' view

/// The two sides of a transfer controller share one.
unsigned count_streams(const std::vector<BusRecorder::MasterSetup>& masters) {
  unsigned n = 1;
  for (const auto& m : masters)
    n += m.pace != Pace::kCore && (m.pace != Pace::kTransfers || master_info(m.id).side == Side::kReads);
  return n;
}

}  // namespace

BusRecorder::BusRecorder(const std::vector<MasterSetup>& masters, unsigned core_align,
                         std::function<CoreState(const MemRequest*)> core, Surroundings surroundings)
    : masters_(masters),
      streams_(count_streams(masters)),
      core_(std::move(core)),
      align_(core_align),
      surroundings_(std::move(surroundings)),
      writer_(count_streams(masters)) {
  stream_of_.fill(kNoStream);
  unsigned next = 1;
  for (const auto& m : masters_) {
    if (m.pace == Pace::kTransfers && master_info(m.id).side != Side::kReads) continue;
    const unsigned s = m.pace == Pace::kCore ? 0 : next++;
    stream_of_[index(m.id)] = s;
    streams_[s].pace = m.pace;
    streams_[s].reads = m.reads;
  }
  for (const auto& m : masters_) {
    if (m.pace != Pace::kTransfers) continue;
    of_transfers_ |= 1u << index(m.id);
    if (m.partner) stream_of_[index(m.id)] = stream_of_[index(std::min(m.id, *m.partner))];
    controllers_[master_info(m.id).unit].stream = stream_of_[index(m.id)];
  }
  for (const auto& m : masters_)
    if (m.partner)
      streams_[stream_of_[index(m.id)]].partner =
          static_cast<std::uint8_t>(stream_of_[index(*m.partner)]);
  for (Stream& s : streams_) s.history.resize(kHistory);
}

void BusRecorder::open(Picoseconds start, Frequency core_clock, Picoseconds core_clock_start, const ClockInfo& scr) {
  scr_ = Clock(scr.frequency, scr.start);
  scr_start_ = scr.start;
  clock_ = Clock(core_clock, core_clock_start);
  core_info_ = {core_clock, core_clock_start, align_, 0};
  start_ = start;
  delayed_ = surroundings_.transfers_under_way && surroundings_.transfers_under_way();
  if (!delayed_) begin(start);
}

void BusRecorder::begin(Picoseconds start) {
  start_ = start;
  open_ = true;
  delayed_ = false;
  interrupts_.clear();
  core_before_ = core_(nullptr);
  room_waits_at_open_ = core_before_.room_waits;
  core_before_.room_waits = 0;
  core_origin_ = core_before_.origin;
  accesses_.clear();
  for (Stream& s : streams_) drop_early(s);
}

void BusRecorder::close(Picoseconds end) { end_ = end; }

/// What was issued before the recording's start is left out.
void BusRecorder::drop_early(Stream& s) {
  while (!s.pending.empty() && (!open_ || s.pending.front().issued < start_)) s.pending.pop_front();
}

BusRecorder::Pending& BusRecorder::append(Stream& s, Picoseconds issued) {
  const std::uint64_t number = s.next++;
  s.history[number % kHistory] = {number, kNone, 0, 0, false, false};
  s.pending.push_back({});
  Pending& p = s.pending.back();
  p.issued = issued;
  p.record.at = issued;
  if (!open_ && s.pending.size() > kHeldBack) s.pending.pop_front();
  return s.pending.back();
}

void BusRecorder::submitted(const MemRequest& r, bool to_sdram) {
  const unsigned stream = stream_of_[index(r.master)];
  if (stream == kNoStream) return;
  if (delayed_ && r.issued >= start_ + kLongestDelay) [[unlikely]]
    begin(r.issued);
  if (of_transfers_ >> index(r.master) & 1u) return submit_of_transfer(r, to_sdram);
  if (!to_sdram) {
    if (stream == 0) submit_aside(r);
    return;
  }
  if (r.master == Master::kArmD) register_looks_ = {};
  if (stream == 0) {
    place_wait_before(r);
    place_work_before(r);
  }
  Stream& s = streams_[stream];
  const std::uint64_t number = s.next;
  Pending& p = append(s, r.issued);
  p.record.write = r.write;
  p.record.locked = r.locked;
  p.record.bytes = r.bytes;
  p.record.critical = static_cast<std::uint8_t>(r.critical);
  p.record.master = r.master;
  p.record.address = r.address - kSdramBase;
  s.history[number % kHistory].write = r.write;
  flights_[index(r.master)].push_back({&r, number});
  if (!open_ || r.issued < start_) return;
  switch (s.pace) {
    case Pace::kCore:
      return release_core(s, p, r);
    case Pace::kLines:
      return release_line(s, p, r.issued);
    case Pace::kRepeating:
      // What starts a block that works for the program, and who waits for it, is not told.
      if (master_info(r.master).priority == PrioritySource::kImcop) not_followed_ |= 1u << index(r.master);
      return release_repeating(s, p, r.issued);
    case Pace::kData:
      return release_by_data(s, p, r.issued);
    case Pace::kSampled:
    case Pace::kTransfers:
      return;
  }
}

/// See decision 0006.
void BusRecorder::release_core(Stream& s, Pending& p, const MemRequest& r) {
  const Picoseconds at = r.issued;
  const std::uint64_t to = clock_.edge_at_or_after(at);
  if (!phase_known_) {
    phase_known_ = true;
    core_info_.phase = static_cast<unsigned>(to % align_);
  } else if (to % align_ != core_info_.phase) {
    align_ = core_info_.align = 1;
    core_info_.phase = 0;
  }
  CoreState now = core_(&r);
  const bool blocking = now.asked == 0;
  // In clocks of `clock_`, less the waits since the recording began.
  now.asked = now.asked + room_waits_at_open_ - now.origin;
  now.room_waits -= room_waits_at_open_;
  // The program stands at an access that it waits for.
  if (blocking) now.asked = to - std::min(to, now.room_waits);
  const std::uint64_t came = std::min(to, now.asked + now.room_waits);
  const std::uint64_t idle = now.idle - core_before_.idle;
  const bool drained = now.drains != core_before_.drains || register_access_;
  const bool waited_for_writes = drained || now.room_waits != core_before_.room_waits;
  core_before_ = now;
  register_access_ = false;

  const Outcome* read = outcome(s, s.blocking_read);
  const Outcome* latest = outcome(s, s.latest);
  const std::uint64_t number = s.next - 1;
  // The last event that the core is known to have waited for: the first word of a read, or the end of a write.
  const Outcome* anchor = waited_for_writes || !read ? latest : read;
  if (anchor && !anchor->done) anchor = nullptr;
  const bool first = anchor && !anchor->write;
  const std::uint64_t from =
      anchor ? clock_.edge_at_or_after(first ? anchor->first : anchor->last) : 0;

  const std::size_t woken_by = interrupt_before(now.woke ? now.woke - now.origin : to);
  if (idle > 0 && woken_by < interrupts_.size() && interrupts_[woken_by].at <= at) {
    const std::uint64_t wake = clock_.edge_at_or_after(interrupts_[woken_by].at);
    p.record.release = Release::kWhen;
    p.record.event = woken_by;
    p.record.wake_gap = static_cast<std::uint32_t>(came - std::min(wake, came));
    if (anchor) {
      p.reference = anchor->number;
      p.record.from_first = first;
      const std::uint64_t work = idle + (to - std::min(wake, to)) + take_accesses(p.record, true, from, wake);
      p.record.gap = to - from > work ? to - from - work : 0;
    }
  } else if (!drained) {
    release_in_program(s, p, now.asked);
  } else if (anchor) {
    p.record.release = Release::kAfter;
    p.record.from_first = first;
    const std::uint64_t not_own = from + take_accesses(p.record, true, from, came);
    p.record.gap = came - std::min(not_own, came);
    p.reference = anchor->number;
  }
  steps_[next_step_++ % kSteps] = {number, now.asked, now.room_waits, r.write, blocking};
  if (r.write && !blocking) note_room(s, p, r, now);
  s.latest = number;
  if (!r.write) s.blocking_read = number;
}

/// Releases the request by its place in the program: the core's own clocks since the step before,
/// which is an access that the core waited for, or a store put into its buffer.
void BusRecorder::release_in_program(Stream& s, Pending& p, std::uint64_t asked) {
  const Step* step = nullptr;
  for (const Step& one : steps_) {
    if (one.number == kNone || one.asked > asked) continue;
    if (one.asked == asked && !one.write) continue;  // it comes behind the store of the same clock
    // Of the bursts of one store the first.
    if (!step || one.asked > step->asked ||
        (one.asked == step->asked && one.number < step->number))
      step = &one;
  }
  const Outcome* o = step ? outcome(s, step->number) : nullptr;
  const bool buffered = step && step->write && !step->blocking;
  if (!o || (!buffered && !o->done)) return;
  const bool first = !step->blocking || !step->write;
  const std::uint64_t from =
      buffered ? step->asked
               : clock_.edge_at_or_after(first ? o->first : o->last) - step->room_waits;
  p.record.release = Release::kAfter;
  p.record.from_first = first;
  const std::uint64_t not_own = from + take_accesses(p.record, false, from, asked);
  p.record.gap = asked - std::min(not_own, asked);
  p.reference = step->number;
}

/// Finds the write that must be out before this one has room: entries and words leave the buffer in
/// order.
void BusRecorder::note_room(Stream& s, Pending& p, const MemRequest& r, const CoreState& now) {
  const std::uint64_t number = s.next - 1;
  if (now.victim) {
    p.room = last_victim_;
    last_victim_ = number;
    return;
  }
  const unsigned words = (r.bytes + 3u) / 4;
  bursts_.push_back({number, now.asked, words});
  // The first burst of an entry asks for room for all of it.
  std::size_t entry = bursts_.size() - 1;
  unsigned filled = words;
  for (; entry > 0 && bursts_[entry - 1].asked == now.asked; --entry)
    filled += bursts_[entry - 1].words;
  unsigned entries = 1;
  std::uint64_t last_entry = now.asked;
  for (std::size_t i = entry; i-- > 0;) {
    filled += bursts_[i].words;
    entries += bursts_[i].asked != last_entry;
    last_entry = bursts_[i].asked;
    if (filled <= kBufferedWords && entries <= kBufferedStores) continue;
    const std::uint64_t first_pending = s.next - s.pending.size();
    if (bursts_[entry].number >= first_pending)
      s.pending[bursts_[entry].number - first_pending].room = bursts_[i].number;
    break;
  }
  while (bursts_.size() > kBufferedWords + kBufferedStores) bursts_.pop_front();
}

/// A display puts as many bursts of a line on its port as the port takes, and each further one when one of
/// these ends.
void BusRecorder::release_line(Stream& s, Pending& p, Picoseconds at) {
  const std::uint64_t number = s.next - 1;
  for (std::uint64_t n = number > 2 * s.reads ? number - 2 * s.reads : 0; n < number; ++n) {
    const Outcome* o = outcome(s, n);
    if (!o || !o->done || o->last != at || (s.taken_place != kNone && n <= s.taken_place)) continue;
    s.taken_place = n;
    p.record.release = Release::kAfter;
    p.reference = n;
    return;
  }
}

/// Of the stream's last records, the one that ended last at or before `at`.
const BusRecorder::Outcome* BusRecorder::latest_done(Stream& s, Picoseconds at) {
  const Outcome* best = nullptr;
  for (std::uint64_t n = s.next > 64 ? s.next - 64 : 0; n < s.next; ++n) {
    const Outcome* o = outcome(s, n);
    if (o && o->done && o->last <= at && (!best || o->last > best->last)) best = o;
  }
  return best;
}

/// After the latest completion; the pause is in picoseconds.
void BusRecorder::release_repeating(Stream& s, Pending& p, Picoseconds at) {
  const Outcome* own = latest_done(s, at);
  const Outcome* other =
      s.partner == kInterrupt ? nullptr : latest_done(streams_[s.partner], at);
  const bool near = other && at - other->last <= ~std::uint32_t{0};
  if (near && (!own || other->last >= own->last)) {
    p.record.release = Release::kWhen;
    p.record.source = s.partner;
    p.event = other->number;
    p.record.wake_gap = static_cast<std::uint32_t>(at - other->last);
  } else if (own) {
    p.record.release = Release::kAfter;
    p.reference = own->number;
    p.record.gap = at - own->last;
  }
}

/// What is written was read: it goes out when the next of the partner's reads is there.
void BusRecorder::release_by_data(Stream& s, Pending& p, Picoseconds at) {
  Stream& from = streams_[s.partner];
  std::uint64_t n = from.next > kHistory ? from.next - kHistory : 0;
  if (s.taken_place != kNone) n = std::max(n, s.taken_place + 1);
  for (; n < from.next; ++n) {
    const Outcome* o = outcome(from, n);
    if (!o || !o->done || o->last != at) continue;
    s.taken_place = n;
    p.record.release = Release::kWhen;
    p.record.source = s.partner;
    p.event = n;
    return;
  }
}

void BusRecorder::responded(const MemRequest& r) { end_flight(r); }

void BusRecorder::end_flight(const MemRequest& r) {
  auto& flights = flights_[index(r.master)];
  const auto found = std::find_if(flights.begin(), flights.end(),
                                  [&](const Flight& f) { return f.request == &r; });
  if (found == flights.end()) return;
  const unsigned stream = stream_of_[index(r.master)];
  Stream& s = streams_[stream];
  if (Outcome* o = outcome(s, found->number)) {
    o->first = r.first;
    o->last = r.last;
    o->done = true;
  }
  const std::uint64_t first_pending = s.next - s.pending.size();
  if (found->number >= first_pending) {
    Pending& p = s.pending[found->number - first_pending];
    p.done = true;
    p.failed = r.error;
    p.record.priority = r.in_path.priority;
  }
  flights.erase(found);
  if (open_) write_out(s, stream, kHeldBack);
}

void BusRecorder::mark(std::uint32_t value, Picoseconds at) {
  if (!open_ || at < start_) return;
  place_waits();
  Stream& s = streams_[0];
  Pending& p = append(s, at);
  p.done = true;
  p.record.kind = Kind::kMark;
  p.record.address = value;
  const std::uint64_t by = register_write();
  const auto step = std::find_if(steps_.begin(), steps_.end(), [&](const Step& one) { return one.number == by; });
  if (by == kNone || step == steps_.end()) return release_behind_latest(s, p, at, align_);
  const std::uint64_t from = step->asked + step->room_waits, to = clock_.edge_at_or_after(at);
  p.record.release = Release::kAfter;
  p.record.from_first = true;
  p.reference = by;
  // Rounded down to whole AHB clocks: the player rounds the sum up to an AHB edge again.
  p.record.gap = (to - std::min(from, to)) / align_ * align_;
}

/// The core has seen out all before it touches a register.
void BusRecorder::release_behind_latest(Stream& s, Pending& p, Picoseconds at, unsigned align) {
  const Outcome* o = outcome(s, s.latest);
  if (!o || !o->done) return;
  p.record.release = Release::kAfter;
  p.record.from_first = !o->write;
  p.reference = o->number;
  const std::uint64_t from = clock_.edge_at_or_after(o->write ? o->last : o->first);
  const std::uint64_t to = clock_.edge_at_or_after(at);
  p.record.gap = (to - std::min(from, to)) / align * align;
}

void BusRecorder::write_out(Stream& s, unsigned index, std::size_t keep) {
  while (s.pending.size() > keep && s.pending.front().done) write_one(s, index);
}

/// Brings the records of a stream up to that one into the trace, where its place is known then.
bool BusRecorder::write_up_to(std::uint8_t index, std::uint64_t number) {
  Stream& s = streams_[index];
  while (!s.pending.empty() && s.pending.front().done && s.next - s.pending.size() <= number)
    write_one(s, index);
  return place_of(index, number) != kNone;
}

/// None is left out of the middle of a stream of transfers.
std::uint64_t BusRecorder::place_of(std::uint8_t index, std::uint64_t number) {
  Stream& s = streams_[index];
  if (s.pace == Pace::kTransfers)
    return s.first != kNone && number >= s.first && number - s.first < s.written ? number - s.first : kNone;
  if (index == 0)
    if (const auto it = places_.find(number); it != places_.end()) return it->second;
  const Outcome* o = outcome(s, number);
  return o ? o->place : kNone;
}

void BusRecorder::write_one(Stream& s, unsigned index) {
  Pending p = std::move(s.pending.front());
  const std::uint64_t number = s.next - s.pending.size();
  s.pending.pop_front();
  if (!p.done || p.failed || p.issued < start_ || p.issued >= end_) return;
  Record& r = p.record;
  if (p.event != kNone) {
    if (write_up_to(r.source, p.event)) {
      r.event = place_of(r.source, p.event);
    } else {  // what it waited for is not in the recording
      r.release = Release::kAt;
      r.source = kInterrupt;
      r.point = Point::kEnd;
      r.wake_gap = 0;
    }
  }
  if (r.release != Release::kAt && (p.event == kNone || p.reference != kNone)) {
    const Outcome* o = outcome(s, p.reference);
    // An outcome is forgotten before it lies further back than kMaxBack.
    if (o && o->place != kNone) {
      r.back = static_cast<std::uint32_t>(s.written - o->place);
      const Outcome* room = r.release == Release::kAfter ? outcome(s, p.room) : nullptr;
      if (room && room->place != kNone)
        r.room = static_cast<std::uint32_t>(s.written - room->place);
    } else {  // what it waited for is not in the recording
      if (r.release == Release::kAfter) r.release = Release::kAt;
      r.from_first = false;
      r.gap = 0;
    }
  }
  if (r.release == Release::kAt) {
    r.from_first = false;
    r.gap = 0;
    r.ram.clear();
    r.look_after = r.look_clocks = 0;
  }
  r.at = r.release != Release::kAt ? 0 : r.kind == Kind::kTransfer ? p.ready : p.issued;
  if (Outcome* o = outcome(s, number)) o->place = s.written;
  if (index == 0)
    if (const auto it = places_.find(number); it != places_.end()) it->second = s.written;
  if (s.first == kNone) s.first = number;
  if (index == 0) core_until_ = std::min(std::max(core_until_, p.issued), end_);
  ++s.written;
  writer_.add(index, r);
}

void BusRecorder::finish(TraceInfo info,
                         const std::function<void(std::string_view)>& put) {
  FOVEA_CHECK(open_ && end_ != kNever, "a recording that was not opened and closed");
  info.start = start_;
  info.end = end_;
  info.streams.resize(streams_.size());
  info.streams[0] = core_info_;
  place_waits();
  for (const Stream& s : streams_)
    if (s.pace == Pace::kTransfers) {
      info.streams[static_cast<std::size_t>(&s - streams_.data())] = {scr_.frequency(), scr_start_, 1, 0};
      info.edma = surroundings_.edma;
    }
  for (const auto& m : masters_)
    info.masters.push_back({m.id, std::string(stat_name(m.id)),
                            stream_of_[index(m.id)], m.reads, m.writes, m.shared});
  for (unsigned i = 0; i < streams_.size(); ++i)
    while (!streams_[i].pending.empty()) write_one(streams_[i], i);
  info.core_until = core_until_;
  list_interrupts(info);
  for (const auto& m : masters_)
    if (not_followed_ >> index(m.id) & 1u) info.kept.push_back(m.id);
  writer_.finish(info, put);
}

}  // namespace fovea::trace
