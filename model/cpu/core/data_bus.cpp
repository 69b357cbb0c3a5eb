#include "model/cpu/core/data_bus.h"

namespace fovea::cpu {

/// AHB clock at which the write under way, whose outcome is known, leaves the port.
[[gnu::always_inline]] inline std::uint64_t DataBus::write_over() const {
  if (write_over_ == 0)
    write_over_ = interface_.ahb(interface_.clock.edge_at_or_after(write_access_.last));
  return write_over_;
}

/// Waits until the next buffered write can be sent: until the last words of a read have left the
/// port, then for an edge of the AHB clock.
void DataBus::wait_for_port(Cause cause) {
  ledger_.stall_to(port_free_, cause, port_address_, kService);
  ledger_.stall_to(interface_.ahb(std::max(next_write_cycle_, port_free_)), cause,
                   writes_.victim_bytes ? writes_.victim_address : writes_.front().address, kCore);
}

Picoseconds DataBus::time_of_next_act() const {
  const std::uint64_t c = next_act_cycle();
  if (c == kNoCycle) return kNever;
  if (act_time_cycle_ != c) {
    act_time_cycle_ = c;
    act_time_ = interface_.clock.running() ? interface_.time(c) : kNever;
  }
  return act_time_;
}

std::uint64_t DataBus::next_act_cycle() const {
  if (read_waiting_) return kNoCycle;
  if (write_in_flight_) return write_access_.done ? write_over() : kNoCycle;
  if (nothing_buffered()) return kNoCycle;
  return interface_.ahb(std::max(next_write_cycle_, port_free_));
}

void DataBus::act() {
  interface_.buffers_act = true;
  act_at(next_act_cycle());
  interface_.buffers_act = false;
}

/// @param cycle the current next_act_cycle()
inline void DataBus::act_at(std::uint64_t cycle) {
  if (write_in_flight_) retire_write();
  if (!nothing_buffered()) start_write(cycle);
}

void DataBus::retire_write() {
  write_in_flight_ = false;
  if (write_is_victim_)
    writes_.victim_bytes = 0;
  else
    writes_.acknowledge(write_access_.bytes);
}

/// The next burst of the victim buffer, or of a write buffer entry of several words.
void DataBus::next_burst() {
  BusAccess& a = write_access_;
  if (write_is_victim_) {
    a.address = writes_.victim_address;
    a.bytes = static_cast<std::uint8_t>(writes_.victim_bytes);
    a.asked = writes_.victim_asked;
    std::memcpy(a.data, writes_.victim.data(), a.bytes);
  } else {
    const WriteBuffer::Entry& e = writes_.front();
    a.bytes = static_cast<std::uint8_t>(WriteBuffer::next_burst(e));
    a.address = e.address + e.sent;
    a.asked = e.asked;
    std::memcpy(a.data, e.data.data() + e.sent, a.bytes);
  }
  a.kind = a.bytes == 32   ? BusAccess::Kind::kIncr8
           : a.bytes == 16 ? BusAccess::Kind::kIncr4
                           : BusAccess::Kind::kSingle;
}

void DataBus::start_write(std::uint64_t cycle) {
  BusAccess& a = write_access_;
  write_is_victim_ = writes_.victim_bytes != 0;
  a.victim = write_is_victim_;
  if (const WriteBuffer::Entry& e = writes_.front(); !write_is_victim_ && e.bytes == 4) {
    a.kind = BusAccess::Kind::kSingle;
    a.bytes = 4;
    a.address = e.address;
    a.asked = e.asked;
    std::memcpy(a.data, e.data.data(), 4);
  } else {
    next_burst();
  }
  write_in_flight_ = true;
  write_over_ = 0;
  port_free_ = cycle;
  interface_.submit(a, cycle);
  if (a.least != whole_of_) [[unlikely]]
    count_whole(a.least);
  write_floor_ = cycle + whole_;
}

/// Number of whole clocks in a duration. The result is kept, because ports rarely change their
/// answer.
void DataBus::count_whole(Picoseconds t) {
  whole_of_ = t;
  whole_ = 0;
  while (interface_.clock.periods(whole_ + 1) + 1 < t) ++whole_;  // edges may be rounded down
}

/// Executes the buffers' work before a clock, in order of time. Called only if there may be some.
void DataBus::run_buffers_slow(std::uint64_t cycle) { work_before(cycle); }

[[gnu::always_inline]] inline void DataBus::work_before(std::uint64_t cycle) {
  for (;;) {
    if (write_in_flight_ && !write_access_.done && (cycle < write_floor_ || !write_is_over(cycle)))
      return;
    const std::uint64_t next = next_act_cycle();
    if (next > cycle) return;
    act_at(next);
  }
}

/// True if the write under way has ended by then. While the port waits, the buffers may advance on
/// their own, so the caller has to check their state again.
bool DataBus::write_is_over(std::uint64_t cycle) {
  if (cycle >= interface_.stop_cycle || interface_.attention) [[unlikely]]
    cycle = interface_.let_others_act(cycle);
  return interface_.port.poll(write_access_, interface_.time(cycle)) ||
         (write_in_flight_ && write_access_.done);
}

/// Waits until the write under way has ended; the next one does not start meanwhile.
void DataBus::finish_write(Cause cause) { wait_for_write(cause); }

[[gnu::always_inline]] inline void DataBus::wait_for_write(Cause cause) {
  read_waiting_ = true;
  interface_.port.finish(write_access_);
  read_waiting_ = false;
  const Picoseconds last = write_access_.last;
  const std::uint64_t there = interface_.clock.edge_at_or_after(last);
  if (write_over_ == 0) write_over_ = interface_.ahb(there);
  ledger_.stall_on(write_access_, last, there, write_over_, cause);
  next_write_cycle_ = std::max(next_write_cycle_, ledger_.cycle);
  retire_write();
}

void DataBus::drain(Cause cause) {
  run_buffers(ledger_.cycle);
  if (!busy()) return;
  while (busy()) {
    if (!write_in_flight_) {
      wait_for_port(cause);
      start_write(interface_.ahb(ledger_.cycle));
    }
    finish_write(cause);
  }
  ++drains_;
}

void DataBus::make_room(unsigned count) {
  const std::uint64_t begin = ledger_.cycle;
  waits_for_room_ = true;
  do {
    if (!write_in_flight_) {
      wait_for_port(Cause::kWriteBuffer);
      start_write(interface_.ahb(ledger_.cycle));
    }
    wait_for_write(Cause::kWriteBuffer);
    if (!nothing_buffered()) work_before(ledger_.cycle);
  } while (!writes_.room(count));
  waits_for_room_ = false;
  room_waits_ += ledger_.cycle - begin;
}

void DataBus::prepare(BusAccess::Kind kind, std::uint32_t pa, unsigned bytes, bool locked) {
  access_.kind = kind;
  access_.write = access_.buffered = false;
  access_.locked = locked;
  access_.address = pa;
  access_.bytes = static_cast<std::uint8_t>(bytes);
}

/// Executes the prepared read. @param before_victim it precedes the victim, which waits already
bool DataBus::read(bool before_victim, Cause cause) {
  BusAccess& a = access_;
  const std::uint32_t start = a.kind == BusAccess::Kind::kWrap8 ? a.address & ~31u : a.address;
  if (writes_.overlaps(start, a.bytes)) drain(cause);
  if (!before_victim) run_buffers(ledger_.cycle);
  if (write_in_flight_) finish_write(cause);
  ledger_.stall_to(port_free_, cause, port_address_, kService);
  ledger_.stall_to(interface_.ahb(ledger_.cycle), Cause::kBusSync, a.address, kCore);
  read_waiting_ = true;
  ledger_.counts.d_read_beats += beats(a.bytes);
  interface_.submit(a, ledger_.cycle);
  interface_.port.finish(a);
  read_waiting_ = false;
  const std::uint64_t there = interface_.clock.edge_at_or_after(a.first);
  ledger_.stall_on(a, a.first, there, there + (a.error ? 0 : fill_latency_), cause);
  port_free_ = interface_.clock.edge_at_or_after(a.last);
  port_address_ = a.address;
  return !a.error;
}

bool DataBus::read_line(std::uint32_t pa, std::uint64_t asked, Cause cause) {
  access_.asked = asked;
  prepare(BusAccess::Kind::kWrap8, pa & ~3u, 32, false);
  return read(true, cause);
}

bool DataBus::read_word(std::uint32_t pa, std::uint32_t& value, Cause cause) {
  prepare(BusAccess::Kind::kSingle, pa, 4, false);
  access_.asked = asked_now();
  const bool good = read(false, cause);
  std::memcpy(&value, access_.data, 4);
  return good;
}

bool DataBus::read_uncached(std::uint32_t pa, unsigned bytes, bool locked, std::uint32_t& value) {
  prepare(BusAccess::Kind::kSingle, pa, bytes, locked);
  access_.asked = asked_now();
  // Device order: earlier writes have to be complete first.
  drain(Cause::kUncached);
  const bool good = read(false, Cause::kUncached);
  value = 0;
  std::memcpy(&value, access_.data, bytes);
  return good;
}

bool DataBus::write_unbuffered(std::uint32_t pa, unsigned bytes, bool locked,
                               std::uint32_t value) {
  drain(Cause::kUncached);
  ledger_.stall_to(port_free_, Cause::kUncached, port_address_, kService);
  ledger_.stall_to(interface_.ahb(ledger_.cycle), Cause::kBusSync, pa, kCore);
  BusAccess& a = access_;
  prepare(BusAccess::Kind::kSingle, pa, bytes, locked);
  a.write = true;
  a.asked = 0;  // the program waits until it has ended
  std::memcpy(a.data, &value, bytes);
  ledger_.counts.d_write_beats += beats(bytes);
  read_waiting_ = true;
  interface_.submit(a, ledger_.cycle);
  interface_.port.finish(a);
  read_waiting_ = false;
  const std::uint64_t there = interface_.clock.edge_at_or_after(a.last);
  ledger_.stall_on(a, a.last, there, there, Cause::kUncached);
  port_free_ = ledger_.cycle;
  return !a.error;
}

void DataBus::write_back(Cache& cache, unsigned line, bool before_fill, Cause cause) {
  Cache::Line& l = cache.line(line);
  if (l.dirty == 0) return;
  if (!before_fill) run_buffers(ledger_.cycle);
  const std::uint64_t begin = ledger_.cycle;
  while (writes_.victim_bytes) {
    if (!write_in_flight_) {
      wait_for_port(cause);
      start_write(interface_.ahb(ledger_.cycle));
    }
    finish_write(cause);
  }
  room_waits_ += ledger_.cycle - begin;
  const unsigned from = l.dirty == 2 ? 16 : 0, n = l.dirty == 3 ? 32 : 16;
  if (writes_.empty() && !write_in_flight_) next_write_cycle_ = ledger_.cycle;
  writes_.victim_address = l.pa + from;
  writes_.victim_bytes = n;
  writes_.victim_asked = asked_now();
  std::memcpy(writes_.victim.data(), cache.data(line) + from, n);
  l.dirty = 0;
  ++ledger_.counts.dcache_writebacks;
  ledger_.counts.writeback_words += n / 4;
  ledger_.counts.d_write_beats += beats(n);
  if (!read_waiting_ && !write_in_flight_ && port_free_ <= ledger_.cycle && !before_fill)
    start_write(interface_.ahb(ledger_.cycle));
}

void DataBus::clock_changed() {
  write_over_ = write_floor_ = 0;
  whole_of_ = whole_ = 0;
  act_time_cycle_ = kNoCycle;
}

void DataBus::patch(std::uint32_t pa, std::span<const std::uint8_t> bytes) {
  writes_.patch(pa, bytes);
  if (!write_in_flight_) return;
  BusAccess& a = write_access_;
  for (std::size_t k = 0; k < bytes.size(); ++k)
    if (const std::uint32_t d = pa + static_cast<std::uint32_t>(k) - a.address; d < a.bytes)
      a.data[d] = bytes[k];
}

}  // namespace fovea::cpu
