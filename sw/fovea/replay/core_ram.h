// In a replay: the internal RAM, where bursts of the EDMA meet the accesses of the core's program.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "model/common/clock.h"
#include "model/common/mem_request.h"
#include "model/contract/memory_map.h"
#include "model/cpu/core/tcm_port.h"
#include "model/trace/core/trace.h"

namespace fovea::app {

/// The model's own port (cpu::TcmPort) decides who waits for whom. The core's side comes from the trace: where its
/// program stands in the gap of a record, and which banks it accesses there.
class CoreRam {
 public:
  explicit CoreRam(const trace::EdmaInfo& edma)
      : edma_(edma),
        port_({edma.ram_word_clocks, edma.ram_latency, std::max(edma.ram_banks, 1u), edma.ram_core_first},
              INTERNAL_RAM_BYTES) {}

  /// The trace has the core's accesses.
  bool played() const { return edma_.ram_banks != 0; }

  /// The program's next record, and its gap begins at a clock of the core that is not known yet.
  void next_record() { known_ = false; }
  bool known() const { return known_; }
  /// The gap begins at `clock`. What the core does up to its end is known then, and with it what a burst under way
  /// waits for.
  void gap_begins(const trace::Record& record, std::uint64_t clock) {
    known_ = true;
    record_ = &record;
    from_ = clock;
    waited_ = run_ = done_ = place_ = 0;
    looks_from_ = clock + record.gap + record.look_after;
    look_until_ = 0;
    if (!record.ram.empty()) place_ = record.ram[0].skip;
    follow();
  }
  /// Clocks for which the program has waited in the gap.
  std::uint64_t waited() const { return waited_; }
  /// Its looks at a word behind the gap are known up to that clock.
  void looks_until(std::uint64_t clock) { look_until_ = clock; }

  /// A burst arrives; those before it come first.
  void arrive(MemRequest& burst, Picoseconds arrival) { queue_.push_back({&burst, arrival}); }
  bool waiting() const { return !port_.busy() && !queue_.empty(); }
  /// The next burst begins, in the core's clock.
  void begin(const Clock& core) {
    const MemRequest& r = *queue_.front().request;
    began_ = core.edge_after(std::max(queue_.front().arrival, free_));
    port_.begin({r.address & (INTERNAL_RAM_BYTES - 1), r.bytes, r.master}, began_);
    follow();
  }
  bool busy() const { return port_.busy(); }
  /// When the burst under way is over, as far as is known.
  Picoseconds over(const Clock& core) const { return port_.busy() ? core.edge(port_.end() - 1) : kNever; }
  MemRequest& finish(Picoseconds now) {
    free_ = now;
    total_waited_ += port_.waited_of_burst();
    port_.finish();
    MemRequest& r = *queue_.front().request;
    queue_.pop_front();
    return r;
  }
  /// What the program does before the burst's end.
  void follow() {
    if (!known_ || !port_.busy()) return;
    const std::uint32_t bank_bytes = INTERNAL_RAM_BYTES / edma_.ram_banks;
    const std::uint32_t of_burst = port_.burst().offset / bank_bytes;
    const unsigned hold = edma_.ram_hold;
    bool held = false;  // the access before was the core's, of the same bank: no word comes in between
    while (run_ < record_->ram.size()) {
      const trace::RamRun& run = record_->ram[run_];
      const std::uint64_t clock = from_ + place_ + waited_, end = port_.end();
      if (clock >= end) return;
      const std::uint64_t left = run.count - done_;
      std::uint64_t n = 1;
      if (done_ == 0) seen_from_ = clock;
      if (run.together && seen_from_ < began_) {
        n = left;  // its instruction was there before the burst
      } else if (run.bank != of_burst) {
        n = std::min(left, (end - clock + hold - 1) / hold);
      } else {
        if (held && edma_.ram_core_first) n = left;
        const auto clocks = static_cast<unsigned>(n * hold);
        const std::uint64_t got = port_.core_access(run.bank * bank_bytes, clock, clocks, cpu::TcmPort::Side::kData);
        if (got != clock) seen_from_ = got;
        waited_ += got - clock;
      }
      held = run.bank == of_burst && n < left;
      done_ += n;
      place_ += n * hold;
      if (done_ < run.count) continue;
      place_ -= hold;
      done_ = 0;
      if (++run_ < record_->ram.size()) place_ += record_->ram[run_].skip;
    }
    if (record_->look_clocks == 0 || record_->look_bank != of_burst) return;
    for (;;) {
      const std::uint64_t clock = looks_from_ + waited_;
      if (clock >= std::min(port_.end(), look_until_)) return;
      looks_from_ += port_.core_access(of_burst * bank_bytes, clock, hold, cpu::TcmPort::Side::kData) - clock;
      looks_from_ += record_->look_clocks;
    }
  }
  std::uint64_t waited_of_bursts() const { return total_waited_; }

 private:
  struct Arrived {
    MemRequest* request;
    Picoseconds arrival;
  };
  trace::EdmaInfo edma_;
  cpu::TcmPort port_;
  std::deque<Arrived> queue_;
  bool known_ = false;
  const trace::Record* record_ = nullptr;
  std::uint64_t from_ = 0, waited_ = 0, place_ = 0;  // clocks: of the gap's begin, and the next access behind it
  std::size_t run_ = 0;
  std::uint64_t done_ = 0;       // accesses of that run
  std::uint64_t seen_from_ = 0;  // bursts that begin up to this clock are seen by an instruction's other accesses
  std::uint64_t began_ = 0;      // the burst
  std::uint64_t looks_from_ = 0, look_until_ = 0;
  Picoseconds free_ = 0;
  std::uint64_t total_waited_ = 0;
};

}  // namespace fovea::app
