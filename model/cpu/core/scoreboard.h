// When results can be used (ARM DDI 0222B 8.3).
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "model/cpu/core/instruction.h"

namespace fovea::cpu {

class Scoreboard {
 public:
  enum Producer : std::uint8_t { kOther, kLoad, kMultiply };

  /// The result in a register can be used from clock `when` on. Latencies are at most two clocks
  /// and each instruction takes at least one, so a younger result is never available before an
  /// older one.
  [[gnu::always_inline]] void ready_at(unsigned r, std::uint64_t when, Producer by) {
    ready_[r] = when * 4 + by;
    latest = when;
  }
  /// Clock from `cycle` on at which all operands are available. Times count from the end of the
  /// producer's issue; store data and accumulators are read one clock later.
  /// @param not_yet registers that may not be available at `cycle`; all others are
  std::uint64_t operands_ready(const Instruction& i, std::uint64_t cycle,
                               std::uint32_t not_yet = ~0u) const {
    std::uint64_t need = cycle;
    for (std::uint32_t s = i.sources & not_yet; s; s &= s - 1)
      need = std::max(need, ready_[static_cast<unsigned>(std::countr_zero(s))] >> 2);
    for (std::uint32_t s = i.stored & not_yet; s; s &= s - 1) {
      const std::uint64_t entry = ready_[static_cast<unsigned>(std::countr_zero(s))];
      const std::uint64_t ready = entry >> 2;
      const auto by = static_cast<Producer>(entry & 3u);
      // These operands are read one clock later. But loads do not forward to this port (their
      // latency is one clock more), and a multiply forwards only to the accumulator input, not to
      // store data.
      const bool late = by == kLoad || (by == kMultiply && !calculates(i.op));
      need = std::max(need, late || ready == 0 ? ready : ready - 1);
    }
    return need;
  }
  /// True if one of the registers becomes available only after a clock.
  bool any_later(std::uint32_t registers, std::uint64_t than) const {
    for (; registers; registers &= registers - 1)
      if (ready_[static_cast<unsigned>(std::countr_zero(registers))] >> 2 > than) return true;
    return false;
  }

  std::uint64_t latest = 0;  // clock from which all results are available

 private:
  std::array<std::uint64_t, 16> ready_{};  // clock << 2 | Producer
};

}  // namespace fovea::cpu
