// The data AHB port with its write and victim buffers, and reads that wait for the port.
#include <cstring>

#include "model/cpu/core/fast_path.h"

namespace fovea::cpu {

void Core::charge_stall(std::uint64_t cycle, Cause cause, std::uint32_t pa, std::size_t culprit) {
  counts_.stall[index(cause)] += cycle - cycle_;
  counts_.stalls.add(cause, regions_.find(pa), culprit, cycle - cycle_);
  cycle_ = cycle;
}

/// Waits until the next buffered write can be sent: until the last words of a read have left the
/// port, then for an edge of the AHB clock.
void Core::stall_for_port(Cause cause) {
  stall_to(data_port_free_, cause, data_port_pa_, kService);
  stall_to(ahb(std::max(next_write_cycle_, data_port_free_)), cause,
           writes_.victim_bytes ? writes_.victim_address : writes_.front().address, kCore);
}

/// Lets all other agents do what they do before this clock. They may change the core's frequency or
/// stop its clock.
/// @return the clock, or the first one after a change
[[gnu::noinline]] std::uint64_t Core::let_others_act(std::uint64_t cycle) {
  for (;;) {
    await_clock();
    if (cycle < clock_floor_) cycle = ahb(clock_floor_);
    const Picoseconds t = time(cycle);
    if (port_.horizon() >= t) return cycle;
    port_.sleep_until(t);
    if (cycle >= clock_floor_ && clock_.running() && time(cycle) == t) return cycle;
  }
}

/// Waits while the core's clock is stopped.
void Core::await_clock() {
  while (!clock_.running()) port_.sleep_until(kNever);
}

/// Submits an access on its port.
void Core::submit(BusAccess& a, std::uint64_t cycle) {
  a.done = false;  // the buffers may inspect it while others act
  if ((cycle >= stop_cycle_ || attention_) && !port_runs_buffers_) [[unlikely]]
    cycle = let_others_act(cycle);
  a.parts.clear();
  a.issued = time(cycle);
  port_.submit(a, a.issued);
  if (a.outside) attention_ = true;  // its outcome may bring the horizon nearer
}

Picoseconds Core::time_of_next_act() const {
  const std::uint64_t c = next_act_cycle();
  if (c == kNoCycle) return kNever;
  if (act_time_cycle_ != c) {
    act_time_cycle_ = c;
    act_time_ = clock_.running() ? time(c) : kNever;
  }
  return act_time_;
}

std::uint64_t Core::next_act_cycle() const {
  if (read_waiting_) return kNoCycle;
  if (write_in_flight_) return write_access_.done ? write_over() : kNoCycle;
  if (writes_.empty() && writes_.victim_bytes == 0) return kNoCycle;
  return ahb(std::max(next_write_cycle_, data_port_free_));
}

/// AHB clock at which the write under way, whose outcome is known, leaves the port.
std::uint64_t Core::write_over() const {
  if (write_over_ == 0) write_over_ = ahb(clock_.edge_at_or_after(write_access_.last));
  return write_over_;
}

void Core::act() {
  port_runs_buffers_ = true;
  act_at(next_act_cycle());
  port_runs_buffers_ = false;
}

/// @param cycle the current next_act_cycle()
inline void Core::act_at(std::uint64_t cycle) {
  if (write_in_flight_) retire_write();
  if (!writes_.empty() || writes_.victim_bytes) start_write(cycle);
}

void Core::retire_write() {
  write_in_flight_ = false;
  if (write_is_victim_)
    writes_.victim_bytes = 0;
  else
    writes_.acknowledge(write_access_.bytes);
}

void Core::start_write(std::uint64_t cycle) {
  write_is_victim_ = writes_.victim_bytes != 0;
  BusAccess& a = write_access_;
  if (const WriteBuffer::Entry& e = writes_.front(); !write_is_victim_ && e.bytes == 4) {
    a.bytes = 4;
    a.address = e.address;
    a.asked = e.asked;
    std::memcpy(a.data, e.data.data(), 4);
  } else if (write_is_victim_) {
    a.address = writes_.victim_address;
    a.bytes = static_cast<std::uint8_t>(writes_.victim_bytes);
    a.asked = writes_.victim_asked;
    std::memcpy(a.data, writes_.victim.data(), a.bytes);
  } else {
    a.bytes = static_cast<std::uint8_t>(WriteBuffer::next_burst(e));
    a.address = e.address + e.sent;
    a.asked = e.asked;
    std::memcpy(a.data, e.data.data() + e.sent, a.bytes);
  }
  a.kind = a.bytes == 32   ? BusAccess::Kind::kIncr8
           : a.bytes == 16 ? BusAccess::Kind::kIncr4
                           : BusAccess::Kind::kSingle;
  a.victim = write_is_victim_;
  write_in_flight_ = true;
  write_over_ = 0;
  data_port_free_ = cycle;
  submit(a, cycle);
  if (a.least != whole_of_) [[unlikely]]
    count_whole(a.least);
  write_floor_ = cycle + whole_;
}

/// Number of whole clocks in a duration. The result is kept, because ports rarely change their
/// answer.
[[gnu::noinline]] void Core::count_whole(Picoseconds t) {
  whole_of_ = t;
  whole_ = 0;
  while (clock_.periods(whole_ + 1) + 1 < t) ++whole_;  // because edges may be rounded down
}

/// Executes the buffers' work before a clock, in order of time. Called only if there may be some.
[[gnu::noinline]] void Core::run_buffers_slow(std::uint64_t cycle) {
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
[[gnu::noinline]] bool Core::write_is_over(std::uint64_t cycle) {
  if (cycle >= stop_cycle_ || attention_) [[unlikely]] cycle = let_others_act(cycle);
  return port_.poll(write_access_, time(cycle)) || (write_in_flight_ && write_access_.done);
}

/// Waits until the write under way has ended; the next one does not start meanwhile.
void Core::finish_write(Cause cause) { wait_for_write(cause); }

[[gnu::always_inline]] inline void Core::wait_for_write(Cause cause) {
  read_waiting_ = true;
  port_.finish(write_access_);
  read_waiting_ = false;
  const Picoseconds last = write_access_.last;
  const std::uint64_t there = clock_.edge_at_or_after(last);
  if (write_over_ == 0) write_over_ = ahb(there);
  stall_on(write_access_, last, there, write_over_, cause);
  next_write_cycle_ = std::max(next_write_cycle_, cycle_);
  retire_write();
}

void Core::drain(Cause cause) {
  run_buffers(cycle_);
  const auto busy = [&] {
    return write_in_flight_ || !writes_.empty() || writes_.victim_bytes != 0;
  };
  if (!busy()) return;
  while (busy()) {
    if (!write_in_flight_) {
      stall_for_port(cause);
      start_write(ahb(cycle_));
    }
    finish_write(cause);
  }
  ++drains_;
}

[[gnu::noinline]] void Core::make_room(unsigned count) {
  const std::uint64_t begin = cycle_;
  do {
    if (!write_in_flight_) {
      stall_for_port(Cause::kWriteBuffer);
      start_write(ahb(cycle_));
    }
    wait_for_write(Cause::kWriteBuffer);
    run_buffers(cycle_);
  } while (!writes_.room(count));
  room_waits_ += cycle_ - begin;
}

/// @param put puts `count` bytes into the write buffer
template <class Put>
[[gnu::always_inline]] inline void Core::enqueue(unsigned count, Put put) {
  run_buffers(cycle_);
  if (!writes_.room(count)) make_room(count);
  if (writes_.empty()) next_write_cycle_ = cycle_;
  put();
  counts_.d_write_beats += beats(count);
  // If the port is idle, the write is sent at once.
  if (!write_in_flight_ && data_port_free_ <= cycle_) start_write(ahb(cycle_));
}

void Core::enqueue_write(std::uint32_t pa, const std::uint8_t* bytes, unsigned count) {
  enqueue(count, [&] { writes_.push(pa, bytes, count, asked_now()); });
}

/// A store to a writable line that the cache does not hold.
template <unsigned kBytes>
void Core::store_absent(std::uint32_t va, std::uint32_t pa, std::uint32_t value) {
  record(pc_, va, kBytes | kWritten);
  ++counts_.dcache_writes;
  if (cycle_ < dfill_.last) dcache_wait(modified(va));
  ++counts_.dcache_write_misses;
  enqueue(kBytes, [&] { writes_.push(pa, value, kBytes, asked_now()); });
}
template void Core::store_absent<1>(std::uint32_t, std::uint32_t, std::uint32_t);
template void Core::store_absent<2>(std::uint32_t, std::uint32_t, std::uint32_t);
template void Core::store_absent<4>(std::uint32_t, std::uint32_t, std::uint32_t);

/// A read on the data port. It overtakes waiting writes unless it overlaps one of them.
void Core::bus_read(BusAccess& a, Cause cause) {
  const std::uint32_t start = a.kind == BusAccess::Kind::kWrap8 ? a.address & ~31u : a.address;
  if (writes_.overlaps(start, a.bytes)) drain(cause);
  if (!filling_) run_buffers(cycle_);
  if (write_in_flight_) finish_write(cause);
  stall_to(data_port_free_, cause, data_port_pa_, kService);
  sync_to_ahb(a.address);
  read_waiting_ = true;
  counts_.d_read_beats += beats(a.bytes);
  submit(a, cycle_);
  port_.finish(a);
  read_waiting_ = false;
  const std::uint64_t there = clock_.edge_at_or_after(a.first);
  stall_on(a, a.first, there, there + (a.error ? 0 : fill_latency_), cause);
  data_port_free_ = clock_.edge_at_or_after(a.last);
  data_port_pa_ = a.address;
}

bool Core::uncached_read(std::uint32_t pa, unsigned bytes, std::uint32_t& value) {
  BusAccess& a = data_access_;
  a.kind = BusAccess::Kind::kSingle;
  a.write = a.buffered = false;
  a.locked = swapping_;
  a.address = pa;
  a.bytes = static_cast<std::uint8_t>(bytes);
  a.asked = asked_now();
  // Device order: earlier writes have to be complete first.
  drain(Cause::kUncached);
  bus_read(a, Cause::kUncached);
  value = 0;
  std::memcpy(&value, a.data, bytes);
  return !a.error;
}

bool Core::unbuffered_write(std::uint32_t pa, unsigned bytes, std::uint32_t value) {
  drain(Cause::kUncached);
  stall_to(data_port_free_, Cause::kUncached, data_port_pa_, kService);
  sync_to_ahb(pa);
  BusAccess& a = data_access_;
  a.kind = BusAccess::Kind::kSingle;
  a.write = true;
  a.buffered = false;
  a.asked = 0;  // the program waits until it has ended
  a.locked = swapping_;
  a.address = pa;
  a.bytes = static_cast<std::uint8_t>(bytes);
  std::memcpy(a.data, &value, bytes);
  counts_.d_write_beats += beats(bytes);
  read_waiting_ = true;
  submit(a, cycle_);
  port_.finish(a);
  read_waiting_ = false;
  const std::uint64_t there = clock_.edge_at_or_after(a.last);
  stall_on(a, a.last, there, there, Cause::kUncached);
  data_port_free_ = cycle_;
  return !a.error;
}

/// Moves the dirty halves of a line to the victim buffer.
void Core::write_back(unsigned index, Cause cause) {
  Cache::Line& l = dcache_.line(index);
  if (l.dirty == 0) return;
  if (!filling_) run_buffers(cycle_);
  const std::uint64_t begin = cycle_;
  while (writes_.victim_bytes) {
    if (!write_in_flight_) {
      stall_for_port(cause);
      start_write(ahb(cycle_));
    }
    finish_write(cause);
  }
  room_waits_ += cycle_ - begin;
  const unsigned from = l.dirty == 2 ? 16 : 0, n = l.dirty == 3 ? 32 : 16;
  if (writes_.empty() && !write_in_flight_) next_write_cycle_ = cycle_;
  writes_.victim_address = l.pa + from;
  writes_.victim_bytes = n;
  writes_.victim_asked = asked_now();
  std::memcpy(writes_.victim.data(), dcache_.data(index) + from, n);
  l.dirty = 0;
  ++counts_.dcache_writebacks;
  counts_.writeback_words += n / 4;
  counts_.d_write_beats += beats(n);
  if (!read_waiting_ && !write_in_flight_ && data_port_free_ <= cycle_ && !filling_)
    start_write(ahb(cycle_));
}

}  // namespace fovea::cpu
