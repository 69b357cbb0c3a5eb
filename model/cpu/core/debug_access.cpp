// What debuggers may do to a core between its instructions.
#include <cstring>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

Subscription Core::observe_boundaries(BoundaryObserver& observer) {
  end_chain();
  return boundary_observers_.add(&observer);
}

/// The boundary is not after the next event of any other agent, so only the core's own buffers and
/// the bus can act here.
void Core::settle_bus() {
  bus_.run_buffers(ledger_.cycle);
  interface_.port.sleep_until(time(ledger_.cycle));
}

void Core::disturb() {
  interface_.attention = true;
  interface_.stop_cycle = 0;
}

void Core::redirect(std::uint32_t pc) {
  regs_.pc = next_pc_ = pc & (regs_.thumb() ? ~1u : ~3u);
  fetch_.branched = true;
}

void Core::change_status(std::uint32_t cpsr) {
  set_cpsr(cpsr);
  fetch_.leave_line();
}

void Core::patch_ram(std::uint32_t pa, std::span<const std::uint8_t> bytes) {
  std::memcpy(ram_.at(pa), bytes.data(), bytes.size());
  fetch_.drop_ram(ram_.offset(pa));
  fetch_.leave_line();
}

void Core::patch(std::uint32_t mva, std::uint32_t pa, std::span<const std::uint8_t> bytes) {
  bus_.patch(pa, bytes);
  Cache& lines = data_.lines();
  if (const int i = lines.find(mva); i >= 0)
    std::memcpy(lines.data(static_cast<unsigned>(i)) + (mva & (Cache::kLineBytes - 1)),
                bytes.data(), bytes.size());
  fetch_.patch(mva, pa, bytes);
}

void Core::back_to_failure() {
  if (!failure_.failed) return;
  change_status(failure_.cpsr);
  regs_.pc = next_pc_ = failure_.pc;
}

}  // namespace fovea::cpu
