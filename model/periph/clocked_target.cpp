#include "model/periph/clocked_target.h"

namespace fovea::periph {

ClockedTarget::ClockedTarget(sc_core::sc_module_name name, RegBank& bank) : BusTarget(name, bank) {
  add_clock(clk);
  add_power_gate(lpsc);
  SC_METHOD(take_clock);
  sensitive << clk << lpsc;
}

bool ClockedTarget::clocked() const { return lpsc.size() == 0 || lpsc->read(); }

std::uint64_t ClockedTarget::ticks() const {
  return clock_.running() ? clock_.edge_after(kernel_time()) - 1 : stopped_at_;
}

Picoseconds ClockedTarget::time_of(std::uint64_t tick) const {
  return tick == kNever || !clock_.running() ? kNever : clock_.edge(tick);
}

void ClockedTarget::check_pins(const OptionalIn<bool>& pins, const char* selection) {
  if (pins_checked_ || pins.size() == 0 || pins->read()) return;
  pins_checked_ = true;
  diagnostics().guest(std::string(basename()) + " is used, but PINMUX does not give it its pins (" + selection +
                      "): on the chip nothing would reach them");
}

void ClockedTarget::take_clock() {
  const Frequency wanted = clocked() ? clk.read() : Frequency{};
  if (wanted == clock_.frequency()) return;
  stopped_at_ = ticks();
  clock_.restart(wanted, kernel_time());
  clock_changed();
}

}  // namespace fovea::periph
