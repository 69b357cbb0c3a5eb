#include "tb/examples/filler/filler.h"

#include <cstring>

namespace fovea::examples {

Filler::Filler(sc_core::sc_module_name name)
    : BusTarget(name, regs), memory_("memory", Master::kRemapEngine, kOutstanding) {
  add_master(Master::kRemapEngine, memory_.socket, kOutstanding);
  regs.bursts.on_write([this](std::uint32_t) {
    for (unsigned i = 0; i < kBurstBytes; i += 4) {
      const std::uint32_t word = regs.pattern.get();
      std::memcpy(data_.data() + i, &word, 4);
    }
    next_ = regs.address.get();
    to_issue_ = regs.bursts.get();
    regs.left.set(to_issue_);
    fill();
  });
  memory_.on_done = [this](const BurstMaster::Completion&) {
    if (regs.left.get()) regs.left.set(regs.left.get() - 1);  // 0: reset meanwhile
    fill();
  };
}

void Filler::fill() {
  for (; to_issue_ > 0 && memory_.can_issue(); --to_issue_, next_ += kBurstBytes)
    memory_.write(next_, data_);
}

}  // namespace fovea::examples
