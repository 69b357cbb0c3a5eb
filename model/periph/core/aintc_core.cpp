#include "model/periph/core/aintc_core.h"

#include <bit>

namespace fovea::periph {

AintcCore::AintcCore(bool level_capture) : level_capture_(level_capture) {
  remap();
  auto status = [this](Reg& reg, bool fiq, unsigned shift) {
    reg.on_read([this, &reg, fiq, shift] {
      const std::uint64_t shown = pending_ & (fiq ? fiq_map_ : ~fiq_map_);
      reg.set(~static_cast<std::uint32_t>(shown >> shift));
    });
    reg.on_write([this, fiq, shift](std::uint32_t word) {
      acknowledge((std::uint64_t{word} << shift) & (fiq ? fiq_map_ : ~fiq_map_));
    });
  };
  status(regs.fiq0, true, 0);
  status(regs.fiq1, true, 32);
  status(regs.irq0, false, 0);
  status(regs.irq1, false, 32);
  regs.irqentry.on_read([this] { regs.irqentry.set(entry(false)); });
  regs.fiqentry.on_read([this] { regs.fiqentry.set(entry(true)); });
  regs.eint0.on_write([this](std::uint32_t) { enable_written(); });
  regs.eint1.on_write([this](std::uint32_t) { enable_written(); });
  for (Reg& r : regs.intpri) r.on_write([this](std::uint32_t) { remap(); });
}

void AintcCore::reset() {
  regs.reset();
  pending_ = disable_pending_ = was_enabled_ = 0;
  remap();
}

void AintcCore::set_sources(std::uint64_t levels) {
  pending_ |= level_capture_ ? levels : levels & ~levels_;
  levels_ = levels;
}

void AintcCore::acknowledge(std::uint64_t mask) {
  pending_ &= ~mask;
  disable_pending_ &= ~mask;
  if (level_capture_) pending_ |= levels_;
  changed();
}

void AintcCore::enable_written() {
  const std::uint64_t now = enabled();
  if (regs.intctl.idmode) disable_pending_ |= was_enabled_ & ~now & pending_;
  disable_pending_ &= ~now;
  was_enabled_ = now;
  changed();
}

void AintcCore::remap() {
  fiq_map_ = 0;
  for (unsigned n = 0; n < kInterruptCount; ++n) {
    priority_[n] = static_cast<std::uint8_t>((regs.intpri[n / 8].get() >> 4 * (n % 8)) & 7u);
    if (priority_[n] < 2) fiq_map_ |= std::uint64_t{1} << n;
  }
  changed();
}

std::uint32_t AintcCore::entry(bool fiq) const {
  const bool raw = fiq ? regs.intctl.feraw.get() != 0 : regs.intctl.ieraw.get() != 0;
  const std::uint64_t candidates = (raw ? pending_ : active()) & (fiq ? fiq_map_ : ~fiq_map_);
  const std::uint32_t base = regs.eabase.base.get() << 3;
  if (!candidates) return base;
  return base + (first_of(candidates) + 1) * (4u << regs.eabase.size.get());
}

std::optional<unsigned> AintcCore::most_urgent(std::uint64_t among) const {
  const std::uint64_t all = active() & among, fiqs = all & fiq_map_, irqs = all & ~fiq_map_;
  if (!fiqs && !irqs) return std::nullopt;
  return first_of(fiqs ? fiqs : irqs);
}

/// The number with the most urgent priority; candidates must not be 0.
unsigned AintcCore::first_of(std::uint64_t candidates) const {
  unsigned best = 0, best_priority = 8;
  for (; candidates; candidates &= candidates - 1) {
    const unsigned n = static_cast<unsigned>(std::countr_zero(candidates));
    if (priority_[n] < best_priority) {
      best = n;
      best_priority = priority_[n];
    }
  }
  return best;
}

}  // namespace fovea::periph
