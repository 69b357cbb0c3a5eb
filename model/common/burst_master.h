// A memory master without a thread: video DMA ports, traffic generators.
#pragma once
#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <span>
#include <systemc>
#include <vector>

#include "model/common/check.h"
#include "model/common/mem_sockets.h"
#include "model/common/timer.h"

namespace fovea {

/// Issues bursts of at most kMaxBurstBytes (each aligned to its size, so that none crosses a
/// multiple of it) on one memory master, and reports their completions, in order within a
/// direction. MemInitiatorIf is public for the same reason as in LookaheadInitiator: a derived class must be able
/// to destroy SystemC's virtual base.
class BurstMaster : public sc_core::sc_module, public MemInitiatorIf {
 public:
  struct Completion {
    std::uint64_t tag;
    bool write, error;
    std::uint32_t address;
    std::span<const std::uint8_t> data;  ///< read data; valid during the call
    Picoseconds issued, first, last;
  };
  enum class Report {
    kAtLastBeat,   ///< on_done is called in kernel time, at the burst's last beat
    kAtFirstBeat,  ///< the same, but for a read at its first beat; its last one lies ahead then
    /// on_done is called within the memory path, when the outcome is decided (and those of older
    /// bursts of the direction); its times may lie ahead. It may issue bursts from `last` on. No kernel
    /// event is spent on the burst; on_done of one without side effects must set no Timer either.
    kWhenDecided,
    /// The same, but what is in order among reads is their first beats: with the times of kAtFirstBeat.
    kFirstBeatWhenDecided,
  };
  MemInitiatorSocket<32> socket{"socket"};
  std::function<void(const Completion&)> on_done;

  BurstMaster(sc_core::sc_module_name name, Master id, unsigned max_outstanding,
              Report report = Report::kAtLastBeat)
      : sc_module(name), id_(id), report_(report), slots_(max_outstanding) {
    SC_HAS_PROCESS(BurstMaster);
    socket.bind(*this);
    SC_METHOD(deliver);
    sensitive << due_.event();
    dont_initialize();
  }

  /// Earliest time at which a slot is free; kNever if no outstanding burst has a known end. A slot is
  /// freed at the last beat of its burst.
  Picoseconds free_from() const {
    Picoseconds t = kNever;
    for (const Slot& s : slots_) t = std::min(t, s.free);
    return t;
  }
  /// Before the first burst. A master that shares its port with others needs kernel time: see bus/shared_port.h.
  void set_report(Report report) { report_ = report; }
  bool can_issue() const { return free_from() <= kernel_time(); }
  /// Slots not free strictly before t, as far as is known.
  unsigned taken_at(Picoseconds t) const {
    unsigned n = 0;
    for (const Slot& s : slots_) n += s.free >= t;
    return n;
  }
  /// No burst is under way at the present time, whatever was decided ahead of it.
  bool idle() const { return taken_at(kernel_time() + 1) == 0; }
  /// Bursts not yet reported; if they are when decided, those undecided.
  unsigned outstanding() const { return busy_; }

  /// `at`: when the burst is put on the port, now or later; a slot must be free from then on. The
  /// port keeps the order of the calls. `no_side_effects`: see MemRequest.
  void write(std::uint32_t address, std::span<const std::uint8_t> data, std::uint64_t tag,
             Picoseconds at, bool no_side_effects) {
    issue(address, static_cast<unsigned>(data.size()), data.data(), tag, at, no_side_effects);
  }
  void read(std::uint32_t address, unsigned bytes, std::uint64_t tag, Picoseconds at,
            bool no_side_effects) {
    issue(address, bytes, nullptr, tag, at, no_side_effects);
  }
  void write(std::uint32_t address, std::span<const std::uint8_t> data, std::uint64_t tag = 0) {
    write(address, data, tag, kernel_time(), false);
  }
  void read(std::uint32_t address, unsigned bytes, std::uint64_t tag = 0) {
    read(address, bytes, tag, kernel_time(), false);
  }

 private:
  struct Slot : MemRequest {
    alignas(16) std::array<std::uint8_t, kMaxBurstBytes> bytes_{};
    std::uint64_t tag = 0;
    Picoseconds free = 0;  // from when on it can be taken; kNever: not known
    bool due = false;      // decided, but not yet reported
    std::uint64_t order = 0;
    std::uint64_t turn = 0;  // its number within the direction
  };

  void issue(std::uint32_t address, unsigned bytes, const std::uint8_t* data, std::uint64_t tag,
             Picoseconds at, bool no_side_effects) {
    FOVEA_CHECK(bytes > 0 && address % kMaxBurstBytes + bytes <= kMaxBurstBytes, "bad burst");
    Slot* s = nullptr;
    for (Slot& c : slots_)
      if (c.free <= at && (!s || c.free < s->free)) s = &c;
    FOVEA_CHECK(s, "burst issued beyond the outstanding limit");
    newest_ = at = std::max(at, newest_);
    s->free = kNever;
    s->tag = tag;
    s->order = ++issued_count_;
    s->turn = issued_[data != nullptr]++;
    ++busy_;
    if (data) std::memcpy(s->bytes_.data(), data, bytes);
    s->address = address;
    s->data = s->bytes_.data();
    s->bytes = static_cast<std::uint8_t>(bytes);
    s->write = data != nullptr;
    s->master = id_;
    s->no_side_effects = no_side_effects;
    s->error = false;
    s->issued = at;
    MemPhase phase = MemPhase::kRequest;
    const Picoseconds now = kernel_();
    sc_core::sc_time delay = ps_time(at > now ? at - now : 0);
    socket->nb_transport_fw(*s, phase, delay);
  }

  tlm::tlm_sync_enum nb_transport_bw(MemRequest& r, MemPhase& phase, sc_core::sc_time&) override {
    if (phase != MemPhase::kResponse) return tlm::TLM_ACCEPTED;
    auto& s = static_cast<Slot&>(r);
    s.due = true;
    if (report_ == Report::kWhenDecided || report_ == Report::kFirstBeatWhenDecided)
      report_in_turn(s);
    else
      schedule();
    return tlm::TLM_COMPLETED;
  }

  /// Slaves of different speed may answer in another order: a burst waits for the older ones of its
  /// direction, and ends no sooner than they do.
  void report_in_turn(Slot& s) {
    const bool write = s.write;
    if (s.turn != reported_[write]) {
      ++held_back_;
      return;
    }
    for (Slot* next = &s; next; next = held_back_ > 0 ? take_held_back(write) : nullptr) {
      ++reported_[write];
      Picoseconds& at = reported(*next);
      at = ended_[write] = std::max(at, ended_[write]);
      next->last = std::max(next->last, next->first);
      report(*next);
    }
  }
  Slot* take_held_back(bool write) {
    for (Slot& s : slots_)
      if (s.due && s.write == write && s.turn == reported_[write]) {
        --held_back_;
        return &s;
      }
    return nullptr;
  }

  void report(Slot& s) {
    // The slot may be taken again inside the call: hand out a copy of the data.
    auto data = s.bytes_;
    if (s.error && !s.write) data.fill(0);  // no slave has answered
    const Completion c{s.tag,    s.write, s.error, s.address, {data.data(), s.bytes},
                       s.issued, s.first, s.last};
    --busy_;
    s.due = false;
    s.free = s.last;
    if (on_done) on_done(c);
  }

  /// True if an older burst of the same direction has not been reported. Slaves of different speed may
  /// answer in another order.
  bool overtakes(const Slot& s) const {
    for (const Slot& o : slots_)
      if (o.free == kNever && o.write == s.write && o.order < s.order) return true;
    return false;
  }
  Slot* next_due() {
    Slot* best = nullptr;
    for (Slot& s : slots_)
      if (s.due &&
          (!best || reported(s) < reported(*best) ||
           (reported(s) == reported(*best) && s.order < best->order)) &&
          !overtakes(s))
        best = &s;
    return best;
  }

  /// When the outcome is reported.
  Picoseconds& reported(Slot& s) const {
    const bool at_first = report_ == Report::kAtFirstBeat || report_ == Report::kFirstBeatWhenDecided;
    return at_first && !s.write ? s.first : s.last;
  }
  void schedule() {
    if (Slot* s = next_due()) due_.at(reported(*s));
  }

  void deliver() {
    while (Slot* s = next_due()) {
      if (reported(*s) > kernel_()) break;
      reported(*s) = kernel_();  // later if it had to wait for an older one
      s->last = std::max(s->last, s->first);
      report(*s);
    }
    schedule();
  }

  Master id_;
  Report report_;
  KernelNow kernel_;
  std::vector<Slot> slots_;
  Timer due_;
  Picoseconds newest_ = 0;  // when the latest burst is put on the port
  unsigned busy_ = 0;
  std::uint64_t issued_count_ = 0;
  // Of reads and of writes: bursts issued and reported, and time of the latest report that was made when decided.
  std::array<std::uint64_t, 2> issued_{}, reported_{};
  std::array<Picoseconds, 2> ended_{};
  unsigned held_back_ = 0;  // bursts with an outcome, behind an older one without
};

}  // namespace fovea
