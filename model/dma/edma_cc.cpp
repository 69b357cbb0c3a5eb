#include "model/dma/edma_cc.h"

#include <algorithm>

namespace fovea::dma {

EdmaCc::EdmaCc(sc_core::sc_module_name name, const EdmaParams& params)
    : WithRegs(static_cast<unsigned>(params.reset_priority())), BusTarget(name, regs) {
  add_power_gate(lpsc);
  for (Reg* r : {&regs.quetcmap, &regs.quepri})
    r->on_write([this](std::uint32_t) { written_.soon(); });
  SC_METHOD(update);
  sensitive << written_.event();
}

void EdmaCc::update() {
  std::array<std::uint32_t, kTransferControllers> level;
  level.fill(7);
  for (unsigned q = 0; q < kQueues; ++q) {
    const std::uint32_t tc = regs.quetcmap.fields()[q]->get();
    if (tc >= kTransferControllers) {
      Diagnostics::instance().guest("QUETCMAP names a transfer controller that is not there");
      continue;
    }
    level[tc] = std::min(level[tc], regs.quepri.fields()[q]->get());
  }
  for (unsigned tc = 0; tc < kTransferControllers; ++tc) priority[tc].write(level[tc]);
}

}  // namespace fovea::dma
