#include "tb/examples/alarm/alarm.h"

#include <algorithm>

namespace fovea::examples {

Alarm::Alarm(sc_core::sc_module_name name, const AlarmParams& params)
    : WithRegs(static_cast<std::uint32_t>(params.reset_period())), ClockedTarget(name, regs) {
  add_statistics(stats);
  add_interrupt("alarm", irq);
  regs.control.on_write([this](std::uint32_t) { start_or_stop(); });
  SC_METHOD(update);
  sensitive << wake_.event();
}

void Alarm::start_or_stop() {
  regs.count.set(0);
  due_ = regs.control.run ? ticks() + std::max(regs.period.get(), 1u) : kNever;
  wake_.soon();
}

void Alarm::update() {
  if (ticks() >= off_) off_ = kNever;
  if (ticks() >= due_) {
    ++stats.rings;
    regs.count.set(regs.count.get() + 1);
    off_ = due_ + 1;
    due_ += std::max(regs.period.get(), 1u);
  }
  irq.write(off_ != kNever);
  wake_.move_to(time_of(std::min(due_, off_)));
}

}  // namespace fovea::examples
