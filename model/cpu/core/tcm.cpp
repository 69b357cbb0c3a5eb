// Internal RAM that others reach too. The burst of a DMA arrives and moves its data in the kernel's
// time; the core runs ahead strictly before that. From one to the other each of the core's accesses
// comes by here.
#include <cstring>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

void Core::tcm_burst_begins(const TcmPort::Burst& burst, Picoseconds at) {
  FOVEA_CHECK(!tcm_port_.busy() && burst.bytes > 0 && burst.offset + burst.bytes <= tcm_.size(),
              "bad burst to internal RAM");
  tcm_port_.begin(burst, clock_.edge_after(at));
  // Nobody may go on with what it knew about internal RAM.
  flush_memos();
}

void Core::tcm_burst_ends(bool write, std::uint8_t* data) {
  const TcmPort::Burst& b = tcm_port_.burst();
  tcm_port_.finish();
  if (!write) {
    std::memcpy(data, tcm_.data() + b.offset, b.bytes);
    return;
  }
  std::memcpy(tcm_.data() + b.offset, data, b.bytes);
  for (std::uint32_t line = b.offset >> 5; line <= (b.offset + b.bytes - 1) >> 5; ++line)
    tcm_decoded_[line].valid = 0;
  line_va_ = 1;
}

/// The instruction under way comes from the bank that holds `offset`. Only while every fetch looks
/// (tcm_quick()): then the line found last is the one that it comes from.
bool Core::code_shares_bank(std::uint32_t offset) const {
  if (!(line_epoch_ & kLineInRam)) return false;
  const auto line = static_cast<std::uint32_t>(current_line_ - tcm_decoded_.data());
  return tcm_port_.same_bank(offset, line * Cache::kLineBytes);
}

/// The core's turn at internal RAM: by the time of the access everybody else has acted who acts before
/// it. Instructions begin no later than the next event of others, so that only time that passes within
/// one needs a look: a bus access before this one (a page walk), or the wait for a DMA.
void Core::tcm_access(std::uint32_t pa, TcmPort::Side side) {
  if (bus_waited_) [[unlikely]] {
    bus_waited_ = false;
    port_.sleep_until(time(cycle_));
  }
  if (tcm_own_conflict_ && side == TcmPort::Side::kData && code_shares_bank(tcm_offset(pa)))
    stall_to(cycle_ + tcm_own_conflict_, Cause::kTcm, pa, kCore);
  while (tcm_port_.busy()) [[unlikely]] {
    const std::uint64_t bursts = tcm_port_.bursts();
    const Master master = tcm_port_.burst().master;
    const std::uint64_t got =
        tcm_port_.core_access(tcm_offset(pa), cycle_, 1 + tcm_wait_, side);
    if (got == cycle_) break;
    stall_to(got, Cause::kTcm, pa, index(culprit(master)));
    port_.sleep_until(time(cycle_));
    if (tcm_port_.bursts() == bursts) break;  // else another one has come meanwhile
  }
  if (tcm_wait_) stall_to(cycle_ + tcm_wait_, Cause::kTcm, pa, kCore);
}

}  // namespace fovea::cpu
