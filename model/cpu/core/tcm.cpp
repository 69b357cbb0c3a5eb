// Internal RAM that other masters can access too. A burst of the DMA arrives and moves its data in
// kernel time, and the core runs ahead strictly before that. Between these two, each access of the
// core to internal RAM is checked here.
#include <cstring>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

void Core::tcm_burst_begins(const TcmPort::Burst& burst, Picoseconds at) {
  FOVEA_CHECK(!tcm_port_.busy() && burst.bytes > 0 && burst.offset + burst.bytes <= tcm_.size(),
              "bad burst to internal RAM");
  tcm_port_.begin(burst, clock_.edge_after(at));
  // Discard everything that was remembered about internal RAM.
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

/// True if the current instruction was fetched from the bank that holds `offset`. Valid only while
/// every fetch is checked (tcm_quick()), since the last line found is then the one it came from.
bool Core::code_shares_bank(std::uint32_t offset) const {
  if (!(line_epoch_ & kLineInRam)) return false;
  const auto line = static_cast<std::uint32_t>(current_line_ - tcm_decoded_.data());
  return tcm_port_.same_bank(offset, line * Cache::kLineBytes);
}

/// Called for an access of the core to internal RAM: all agents that act before the time of the
/// access have to act first. Instructions begin no later than the next event of the others, so only
/// time that passes within an instruction needs a check: a bus access before this one (a page
/// walk), or waiting for a DMA.
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
    if (tcm_port_.bursts() == bursts) break;  // otherwise another burst has arrived meanwhile
  }
  if (tcm_wait_) stall_to(cycle_ + tcm_wait_, Cause::kTcm, pa, kCore);
}

}  // namespace fovea::cpu
