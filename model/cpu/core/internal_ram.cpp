#include "model/cpu/core/internal_ram.h"

namespace fovea::cpu {

/// Instructions begin no later than the next event of the others, so only time that passes within
/// an instruction needs a check: a bus access before this one (a page walk), or waiting for a DMA.
std::uint64_t InternalRam::access(std::uint32_t pa, TcmPort::Side side, bool conflicts) {
  if (ledger_.bus_waited) [[unlikely]] {
    ledger_.bus_waited = false;
    interface_.port.sleep_until(interface_.time(ledger_.cycle));
  }
  if (conflicts) ledger_.stall_to(ledger_.cycle + own_conflict_, Cause::kTcm, pa, kCore);
  const std::uint64_t wanted = ledger_.cycle;
  while (port_.busy()) [[unlikely]] {
    const std::uint64_t bursts = port_.bursts();
    const Master master = port_.burst().master;
    const std::uint64_t got = port_.core_access(offset(pa), ledger_.cycle, 1 + wait_, side);
    if (got == ledger_.cycle) break;
    ledger_.stall_to(got, Cause::kTcm, pa, index(culprit(master)));
    interface_.port.sleep_until(interface_.time(ledger_.cycle));
    if (port_.bursts() == bursts) break;  // otherwise another burst has arrived meanwhile
  }
  const std::uint64_t waited = ledger_.cycle - wanted;
  if (wait_) ledger_.stall_to(ledger_.cycle + wait_, Cause::kTcm, pa, kCore);
  return waited;
}

}  // namespace fovea::cpu
