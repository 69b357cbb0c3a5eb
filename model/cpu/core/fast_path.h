// Inline fast paths of the core: fetch from the current line, translation of a known page, the end
// of a bus access.
#pragma once
#include <bit>
#include <cstring>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

inline const Instruction* Core::fetch() {
  if ((pc_ & ~31u) == line_va_ && (cpsr_ & 0x20u) == line_thumb_) {
    if (cycle_ < ifill_.last && ifill_.line == (fetched_at(pc_) & ~31u)) [[unlikely]]
      stall_to(ifill_.word((pc_ >> 2) & 7u), Cause::kIcache, ifill_.pa, kService);
    const unsigned at = (pc_ & 31u) >> line_shift_;
    if (current_line_->valid && current_line_->records[at].body) return &current_line_->records[at];
  }
  return fetch_slow();
}

/// @return nullptr if a fault was recorded
[[gnu::always_inline]] inline const Translation* Core::translate(std::uint32_t mva, bool write,
                                                                 bool user, bool instruction) {
  if (!(control_ & 1u)) return &flat_;
  const Memo& memo = (instruction ? imemo_ : dmemo_)[(mva >> 10) % kMemos];
  if (memo.page == memo_key(mva, user) && (write ? memo.write_ok : memo.read_ok))
    return &memo.translation;
  return translate_slow(mva, write, user, instruction);
}

/// Stalls up to `cycle` for access `a`, which completed at `outcome` (clock `bus` of the core). The
/// clocks up to `bus` are attributed in proportion to what the access waited for, even if the core
/// began to wait later; the clocks after it are attributed to the core itself.
[[gnu::always_inline]] inline void Core::stall_on(const BusAccess& a, Picoseconds outcome,
                                                  std::uint64_t bus, std::uint64_t cycle,
                                                  Cause cause) {
  if (cycle <= cycle_) return;
  bus_waited_ = true;
  const std::uint8_t region = regions_.find(a.address);
  const std::uint64_t end = std::max(cycle_, std::min(bus, cycle));
  counts_.stalls.split(cause, region, end - cycle_, a.parts, outcome - a.issued, cycle - end);
  counts_.stall[index(cause)] += cycle - cycle_;
  cycle_ = cycle;
}

/// Clock at which all operands are available (ARM DDI 0222B 8.3). Times in ready_ count from the
/// end of the producer's issue; store data and accumulators are read one clock later.
inline std::uint64_t Core::operands_ready(const Instruction& i, std::uint64_t cycle) const {
  std::uint64_t need = cycle;
  for (std::uint32_t s = i.sources; s; s &= s - 1)
    need = std::max(need, ready_[static_cast<unsigned>(std::countr_zero(s))] >> 2);
  for (std::uint32_t s = i.stored; s; s &= s - 1) {
    const std::uint64_t entry = ready_[static_cast<unsigned>(std::countr_zero(s))];
    const std::uint64_t ready = entry >> 2;
    const auto by = static_cast<Producer>(entry & 3u);
    // These operands are read one clock later. But loads do not forward to this port (their latency
    // is one clock more), and a multiply forwards only to the accumulator input, not to store data.
    const bool late = by == kLoad || (by == kMultiply && i.op >= Op::kLdr);
    need = std::max(need, late || ready == 0 ? ready : ready - 1);
  }
  return need;
}

}  // namespace fovea::cpu
