// The data AHB port with its write and victim buffers, and reads that wait for the port.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "model/cpu/core/bus_interface.h"
#include "model/cpu/core/cache.h"
#include "model/cpu/core/stall_ledger.h"
#include "model/cpu/core/write_buffer.h"

namespace fovea::cpu {

class DataBus {
 public:
  DataBus(BusInterface& interface, StallLedger& ledger, unsigned fill_latency)
      : interface_(interface), ledger_(ledger), fill_latency_(fill_latency) {
    write_access_.write = write_access_.buffered = true;
  }
  DataBus(const DataBus&) = delete;
  DataBus& operator=(const DataBus&) = delete;

  /// Sends the buffered writes that are due before a clock, in order of time.
  void run_buffers(std::uint64_t cycle) {
    if (write_in_flight_ ? !write_access_.done && cycle < write_floor_ : nothing_buffered()) return;
    run_buffers_slow(cycle);
  }
  // Work that goes on while the core is blocked (Background).
  Picoseconds next_act() const { return read_waiting_ ? kNever : time_of_next_act(); }
  void act();

  /// A read of a line's words, the wanted one first. It overtakes waiting writes unless it overlaps
  /// one of them. @return false after a bus error
  bool read_line(std::uint32_t pa, std::uint64_t asked, Cause cause);
  /// A read of a word or less that overtakes waiting writes (a page walk).
  bool read_word(std::uint32_t pa, std::uint32_t& value, Cause cause);
  /// A read in the order of the program: earlier writes are complete first. `locked`: one of the
  /// two accesses of a SWP.
  bool read_uncached(std::uint32_t pa, unsigned bytes, bool locked, std::uint32_t& value);
  /// A write whose end the program awaits.
  bool write_unbuffered(std::uint32_t pa, unsigned bytes, bool locked, std::uint32_t value);
  /// The bytes of the last read, in address order.
  const std::uint8_t* data() const { return access_.data; }
  /// Clock at which the last word of the last read is there.
  std::uint64_t last_word() const {
    return interface_.clock.edge_at_or_after(access_.last) + fill_latency_;
  }

  /// Puts consecutive bytes into the write buffer.
  void buffer(std::uint32_t pa, const std::uint8_t* bytes, unsigned count) {
    buffer_with(count, [&] { writes_.push(pa, bytes, count, asked_now()); });
  }
  /// The same for a word or less.
  template <unsigned kBytes>
  [[gnu::always_inline]] void buffer_word(std::uint32_t pa, std::uint32_t value) {
    buffer_with(kBytes, [&] { writes_.push(pa, value, kBytes, asked_now()); });
  }
  /// Moves the dirty halves of a line to the victim buffer. `before_fill`: the line that replaces
  /// it is requested first.
  void write_back(Cache& cache, unsigned line, bool before_fill, Cause cause);
  /// Waits until both buffers are empty.
  void drain(Cause cause);

  /// BusAccess::asked of an access that the program reaches now.
  std::uint64_t asked_now() const { return ledger_.cycle - room_waits_; }
  /// To be called around a change of the clock: bus activity that is under way keeps its end.
  std::uint64_t& port_free() { return port_free_; }
  void clock_changed();
  /// Drops what the buffers hold; no access may be under way.
  void reset() {
    writes_ = {};
    read_waiting_ = write_in_flight_ = write_is_victim_ = false;
    port_free_ = next_write_cycle_ = write_floor_ = write_over_ = 0;
    act_time_cycle_ = kNoCycle;
  }

  /// Lets all others act up to the core's time.
  void let_others_act() { interface_.let_others_act(ledger_.cycle); }
  /// True if the buffers hold bytes of [address, address + n) that memory has not taken yet.
  bool unsent(std::uint32_t address, unsigned n) const {
    if (nothing_buffered()) return false;
    const unsigned taken = write_in_flight_ && write_access_.done ? write_access_.bytes : 0;
    return write_is_victim_ ? writes_.overlaps(address, n, 0, taken) : writes_.overlaps(address, n, taken, 0);
  }

  // What a debugger sees and changes.
  const WriteBuffer& writes() const { return writes_; }
  bool write_in_flight() const { return write_in_flight_; }
  std::uint32_t write_address() const { return write_access_.address; }
  /// Changes pending bytes, so that older data do not overwrite new ones later.
  void patch(std::uint32_t pa, std::span<const std::uint8_t> bytes);
  /// Forgets the times that are remembered because they are asked for again and again.
  void forget() {
    act_time_cycle_ = kNoCycle;
    write_over_ = 0;
    whole_of_ = kNever;
  }
  /// Clocks that the core waited for room in the buffers, and how often it waited until both were
  /// empty.
  std::uint64_t room_waits() const { return room_waits_; }
  std::uint64_t drains() const { return drains_; }
  /// The core waits for room in the write buffer.
  bool waits_for_room() const { return waits_for_room_; }

 private:
  static constexpr std::uint64_t kNoCycle = ~std::uint64_t{0};

  bool nothing_buffered() const { return writes_.empty() && writes_.victim_bytes == 0; }
  bool busy() const { return write_in_flight_ || !nothing_buffered(); }
  void work_before(std::uint64_t cycle);
  [[gnu::noinline]] void run_buffers_slow(std::uint64_t cycle);
  Picoseconds time_of_next_act() const;
  std::uint64_t next_act_cycle() const;
  void act_at(std::uint64_t cycle);
  void start_write(std::uint64_t ahb_cycle);
  [[gnu::noinline]] void next_burst();
  void retire_write();
  std::uint64_t write_over() const;
  [[gnu::noinline]] bool write_is_over(std::uint64_t cycle);
  [[gnu::noinline]] void finish_write(Cause cause);
  void wait_for_write(Cause cause);
  void wait_for_port(Cause cause);
  [[gnu::noinline]] void make_room(unsigned count);
  [[gnu::noinline]] void count_whole(Picoseconds t);
  bool read(bool before_victim, Cause cause);
  void prepare(BusAccess::Kind kind, std::uint32_t pa, unsigned bytes, bool locked);
  /// @param put puts `count` bytes into the write buffer
  template <class Put>
  [[gnu::always_inline]] void buffer_with(unsigned count, Put put) {
    run_buffers(ledger_.cycle);
    if (!writes_.room(count)) make_room(count);
    if (writes_.empty()) next_write_cycle_ = ledger_.cycle;
    put();
    ledger_.counts.d_write_beats += beats(count);
    // If the port is idle, the write is sent at once.
    if (!write_in_flight_ && port_free_ <= ledger_.cycle)
      start_write(interface_.ahb(ledger_.cycle));
  }

  BusInterface& interface_;
  StallLedger& ledger_;
  unsigned fill_latency_;  // core clocks from the critical word on the AHB to the core

  BusAccess access_;  // a read, or a write that is not buffered
  bool read_waiting_ = false;
  std::uint64_t port_free_ = 0;     // clock at which the port is free
  std::uint32_t port_address_ = 0;  // address whose last word occupies the port until then

  WriteBuffer writes_;
  BusAccess write_access_;  // of the buffers
  bool write_in_flight_ = false;
  bool write_is_victim_ = false;
  std::uint64_t next_write_cycle_ = 0;
  std::uint64_t write_floor_ = 0;  // the write under way does not end before this clock
  Picoseconds whole_of_ = 0;       // count_whole(): last argument and result
  std::uint64_t whole_ = 0;
  mutable std::uint64_t write_over_ = 0;  // clock at which the write under way can be retired; 0:
                                          // unknown
  mutable std::uint64_t act_time_cycle_ = kNoCycle;  // next_act(): last clock and its time
  mutable Picoseconds act_time_ = 0;
  bool waits_for_room_ = false;
  std::uint64_t room_waits_ = 0;  // clocks waited for room in the buffers, for all causes
  std::uint64_t drains_ = 0;      // number of times that the core waited until they were empty
};

}  // namespace fovea::cpu
