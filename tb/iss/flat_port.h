// A BusPort for flat memory with fixed latencies and a list of events at given times.
#pragma once
#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/common/clock.h"
#include "model/cpu/core/bus_port.h"

namespace fovea::cpu::test {

/// One access as it was submitted.
struct BusRecord {
  BusAccess::Port port;
  BusAccess::Kind kind;
  std::uint32_t address;
  unsigned bytes;
  bool write, buffered, locked;
  Picoseconds at, last;
};

/// Zeros. A page comes into being when it is touched, so that a machine of 16 MiB costs no more than what it uses.
class ZeroedMemory {
 public:
  explicit ZeroedMemory(std::size_t bytes) : memory_(mapped(bytes), Unmap{bytes}), bytes_(bytes) {}
  std::uint8_t* data() const { return memory_.get(); }
  std::size_t size() const { return bytes_; }

 private:
  struct Unmap {
    std::size_t bytes;
    void operator()(std::uint8_t* memory) const { ::munmap(memory, bytes); }
  };
  static std::uint8_t* mapped(std::size_t bytes) {
    void* const memory =
        ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    return static_cast<std::uint8_t*>(memory);
  }
  std::unique_ptr<std::uint8_t, Unmap> memory_;
  std::size_t bytes_;
};

/// Reads deliver their first word `read_latency` after submission and each further word one `beat`
/// later. A read samples memory at its first word, when the core continues; a write changes memory
/// when it is acknowledged. Checks that the core follows bus_port.h and throws std::logic_error
/// otherwise.
class FlatPort : public BusPort {
 public:
  Picoseconds read_latency = 80'000, beat = 8'000, write_latency = 40'000;
  bool decide_late = false;  ///< an outcome is reported at its time instead of as soon as it is
                             ///< certain
  std::function<Picoseconds()> extra;  ///< added to the latency of each access
  Picoseconds ahb_period = 8'000;  ///< every submission must be at a multiple of it; 0: not checked
  std::vector<BusRecord> log;
  /// Called for each access at its place in the memory's order.
  std::function<void(const BusAccess&)> on_memory;
  Picoseconds now = 0;

  FlatPort(std::uint32_t base, std::size_t bytes) : base_(base), memory_(bytes) {}
  void attach(Background* background) { background_ = background; }

  std::uint8_t* at(std::uint32_t address) { return memory_.data() + (address - base_); }
  bool mapped(std::uint32_t address, unsigned bytes) const {
    return address >= base_ && address - base_ + bytes <= memory_.size();
  }
  std::uint32_t word(std::uint32_t address) {
    std::uint32_t v;
    std::memcpy(&v, at(address), 4);
    return v;
  }
  void set_word(std::uint32_t address, std::uint32_t v) { std::memcpy(at(address), &v, 4); }
  void schedule(Picoseconds t, std::function<void()> what) { events_.emplace(t, std::move(what)); }
  /// Sets the time of an interrupt edge for wait_for_interrupt().
  void interrupt_at(Picoseconds t) { asserted_ = t; }

  void submit(BusAccess& a, Picoseconds t) override {
    require(t >= now, "submission in the past");
    require(t >= last_submit_, "submissions out of order");
    require(ahb_period == 0 || t % ahb_period == 0, "submission off the AHB clock");
    require(
        a.bytes <= 4 || a.kind == BusAccess::Kind::kWrap8 || (a.address % 1024) + a.bytes <= 1024,
        "burst across 1 KB");
    BusAccess*& slot = under_way_[a.port == BusAccess::Port::kData];
    bool& decided = decided_[a.port == BusAccess::Port::kData];
    require(!slot || (decided && slot->last <= t), "two transactions on one AHB port");
    last_submit_ = t;
    run_events(t, false);
    slot = &a;
    decided = a.done = a.error = false;
    const unsigned beats = std::max(1u, a.bytes / 4u);
    a.first = t + (a.write ? write_latency : read_latency) + (extra ? extra() : 0);
    a.last = a.first + (beats - 1) * beat;
    log.push_back({a.port, a.kind, a.address, a.bytes, a.write, a.buffered, a.locked, t, a.last});
    // If no event comes before its end, the outcome is certain at once, as on the real bus.
    if (!decide_late && (events_.empty() || events_.begin()->first > a.last)) {
      if (!other_under_way(a)) return carry_out(a);
    }
    events_.emplace(a.write ? a.last : a.first, [this, p = &a] { carry_out(*p); });
  }

  bool poll(BusAccess& a, Picoseconds until) override {
    if (!a.done) run_events(until, false, &a);
    return a.done && a.last <= until;
  }

  void finish(BusAccess& a) override {
    if (!a.done) run_events(a.write ? a.last : a.first, true, &a);
    require(a.done, "an access was never carried out");
  }

  Picoseconds horizon() override {
    return events_.empty() ? kNever : std::max(now, events_.begin()->first);
  }

  void sleep_until(Picoseconds t) override { run_events(t, true); }

  Picoseconds wait_for_interrupt(Picoseconds) override {
    while (asserted_ == kNever && !events_.empty()) run_events(events_.begin()->first, true);
    require(asserted_ != kNever, "wait-for-interrupt with nothing to come");
    return asserted_;
  }

  unsigned count(bool write, BusAccess::Kind kind) const {
    return static_cast<unsigned>(std::count_if(log.begin(), log.end(), [&](const BusRecord& r) {
      return r.write == write && r.kind == kind;
    }));
  }
  std::vector<BusRecord> data_log() const {
    std::vector<BusRecord> out;
    for (const auto& r : log)
      if (r.port == BusAccess::Port::kData) out.push_back(r);
    return out;
  }

 private:
  static void require(bool ok, const char* what) {
    if (!ok) throw std::logic_error(what);
  }
  bool other_under_way(const BusAccess& a) const {
    const bool other = a.port != BusAccess::Port::kData;
    return under_way_[other] && !decided_[other];
  }
  void carry_out(BusAccess& a) {
    const std::uint32_t start = a.kind == BusAccess::Kind::kWrap8 ? a.address & ~31u : a.address;
    if (on_memory) on_memory(a);
    if (!mapped(start, a.bytes)) {
      a.error = true;
    } else if (a.write) {
      std::memcpy(at(start), a.data, a.bytes);
    } else {
      std::memcpy(a.data, at(start), a.bytes);
    }
    a.done = decided_[a.port == BusAccess::Port::kData] = true;
  }
  /// Executes events, and the core's buffers if the core is blocked, in order of time up to t or
  /// until `a` is decided.
  void run_events(Picoseconds t, bool blocked, const BusAccess* a = nullptr) {
    while (!(a && a->done)) {
      const Picoseconds event = events_.empty() ? kNever : events_.begin()->first;
      const Picoseconds act = blocked && background_ ? background_->next_act() : kNever;
      if (act != kNever && act <= event && act <= t) {
        background_->act();
      } else if (event <= t && event != kNever) {
        auto node = events_.extract(events_.begin());
        now = std::max(now, event);
        node.mapped()();
      } else {
        break;
      }
    }
    if (!a && t != kNever) now = std::max(now, t);
  }

  std::uint32_t base_;
  ZeroedMemory memory_;
  std::multimap<Picoseconds, std::function<void()>> events_;
  Background* background_ = nullptr;
  BusAccess* under_way_[2] = {};
  bool decided_[2] = {};  // separate from `done`, which the core resets when it reuses the access
  Picoseconds last_submit_ = 0, asserted_ = kNever;
};

}  // namespace fovea::cpu::test
