// Which block an input of the interrupt controller belongs to: the one place that says it, for the
// statistics of the core's sleep and for the profile.
#include "model/soc/dm365.h"

namespace fovea::soc {
namespace {

/// VPSSINT outputs: what the INTSEL fields select (TI's register header for the DM36x). The front end's
/// sources are 0 to 20, the VENC's is 21.
cpu::WakeEvent vpss_event(unsigned source) {
  if (source == video::VpssTop::kVencSource) return cpu::WakeEvent::kDisplay;
  return source < video::VpssTop::kVencSource ? cpu::WakeEvent::kCapture : cpu::WakeEvent::kOther;
}

}  // namespace

Dm365::InterruptSource Dm365::interrupt_source(unsigned input) const {
  const auto choice = periph::InterruptMux::find_choice(input);
  const bool second =
      choice && arm_intmux_.read() >> periph::kInterruptChoices[*choice].bit & 1u;
  for (std::size_t k = 0; k < placed.size(); ++k) {
    const Placement& row = placed.row(k);
    for (std::size_t i = 0; i < row.irqs.size(); ++i) {
      if (row.irqs[i].input != input || row.irqs[i].second != second) continue;
      const bool video = &placed.block(k) == &vpss;
      return {row.name + "." + std::string(placed.block(k).interrupts()[i].name),
              video ? vpss_event(vpss.source_of(static_cast<unsigned>(i))) : row.wakes};
    }
  }
  return {"input" + std::to_string(input), cpu::WakeEvent::kOther};
}

cpu::WakeEvent Dm365::wake_event() const {
  const auto input = aintc.core().most_urgent();
  return input ? interrupt_source(*input).event : cpu::WakeEvent::kOther;
}

}  // namespace fovea::soc
