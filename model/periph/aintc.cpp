#include "model/periph/aintc.h"

#include <bit>

namespace fovea::periph {

Aintc::Aintc(sc_core::sc_module_name name, const AintcParams& params)
    : WithRegs(params.capture.is("level")), BusTarget(name, regs.regs) {
  regs.on_change = [this] { written_.soon(); };
  SC_METHOD(update);
  sensitive << written_.event();
  for (std::size_t i = 0; i < source.size(); ++i) sensitive << source[i];
}

void Aintc::update() {
  std::uint64_t levels = 0;
  for (unsigned n = 0; n < kInterruptCount; ++n)
    levels |= static_cast<std::uint64_t>(source[n].read()) << n;
  const std::uint64_t before = regs.pending();
  regs.set_sources(levels);
  for (std::uint64_t fresh = regs.pending() & ~before; fresh; fresh &= fresh - 1)
    latched_at_[static_cast<unsigned>(std::countr_zero(fresh))] = kernel_time();
  irq.write(regs.irq());
  fiq.write(regs.fiq());
}

}  // namespace fovea::periph
