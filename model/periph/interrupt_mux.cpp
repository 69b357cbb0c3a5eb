#include "model/periph/interrupt_mux.h"

namespace fovea::periph {

InterruptMux::InterruptMux(sc_core::sc_module_name name) : sc_module(name) {
  SC_METHOD(select);
  sensitive << arm_intmux;
  dont_initialize();
  SC_METHOD(update);
  sensitive << arm_intmux;
  for (std::size_t i = 0; i < kInterruptChoices.size(); ++i) sensitive << first[i] << second[i];
}

std::optional<std::size_t> InterruptMux::find_choice(unsigned interrupt) {
  for (std::size_t i = 0; i < kInterruptChoices.size(); ++i)
    if (kInterruptChoices[i].interrupt == interrupt) return i;
  return std::nullopt;
}

void InterruptMux::select() {
  for (std::size_t i = 0; i < kInterruptChoices.size(); ++i) {
    const InterruptChoice& c = kInterruptChoices[i];
    if ((arm_intmux.read() >> c.bit & 1) && second[i].size() == 0)
      diagnostics_.not_modelled("ARM_INTMUX bit " + std::to_string(c.bit) + " gives interrupt " +
                                std::to_string(c.interrupt) + " to " + c.second + ", which is silent here");
  }
}

void InterruptMux::update() {
  for (std::size_t i = 0; i < kInterruptChoices.size(); ++i) {
    const OptionalIn<bool>& in =
        arm_intmux.read() >> kInterruptChoices[i].bit & 1 ? second[i] : first[i];
    out[i].write(in.size() && in->read());
  }
}

}  // namespace fovea::periph
