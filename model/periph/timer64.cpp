#include "model/periph/timer64.h"

#include <algorithm>
#include <utility>

namespace fovea::periph {

namespace {
constexpr std::uint32_t kKey1 = 0xA5C6, kKey2 = 0xDA7E;
}

Timer64::Timer64(sc_core::sc_module_name name) : ClockedTarget(name, regs) {
  add_interrupt("tint12", tint12);
  add_interrupt("tint34", tint34);
  half_[0].counter = TimerCounter(64);
  regs.tim12.on_read([this] {
    regs.tim12.set(static_cast<std::uint32_t>(count(0)));
    shadow34_ = static_cast<std::uint32_t>(count(1));
    shadow_valid_ = wide();
  });
  regs.tim34.on_read([this] {
    regs.tim34.set(shadow_valid_ ? shadow34_ : static_cast<std::uint32_t>(count(1)));
    shadow_valid_ = false;
  });
  lockable(regs.tim12, [this] { set_count(0, regs.tim12.get()); });
  lockable(regs.tim34, [this] { set_count(1, regs.tim34.get()); });
  lockable(regs.prd12, [this] { load_periods(); });
  lockable(regs.prd34, [this] { load_periods(); });
  lockable(regs.tcr, [this] {
    if (regs.tcr.clksrc12) diagnostics().not_modelled("TIMER64 clock from the pin");
    reconfigure();
  });
  lockable(regs.tgcr, [this] { reconfigure(); });
  regs.wdtcr.on_write([this](std::uint32_t word) { watchdog_key(word); });
  auto pin = [this](std::uint32_t) {
    pin_reset_ = (regs.gpint_gpen.get() & 0x20000) && (regs.gpdat_gpdir.get() & 0x20002) == 0x20002;
    if (pin_reset_) reset_cause_ = "the watchdog timer's pin was driven high, as boot loaders do";
    reschedule();
  };
  regs.gpint_gpen.on_write(pin);
  regs.gpdat_gpdir.on_write(pin);
  SC_METHOD(update);
  sensitive << wake_.event();
}

void Timer64::lockable(Reg& reg, std::function<void()> written) {
  lockable_.push_back({&reg, 0});
  reg.on_write([this, n = lockable_.size() - 1, written = std::move(written)](std::uint32_t) {
    Lockable& l = lockable_[n];
    if (!locked()) return written();
    l.reg->set(l.value);
    diagnostics().guest("TIMER64." + l.reg->name() +
                        " is written while the watchdog is armed, and keeps its value; allowed: the keys in "
                        "WDTCR");
  });
}

std::uint64_t Timer64::count(unsigned half) const {
  const std::uint64_t t = ticks();
  if (wide()) return half_[0].counter.value(t) >> 32 * half & 0xFFFFFFFFu;
  if (half == 1 && mode_ == kChained && half_[0].run) return half_[0].counter.phase(t);
  return half_[half].counter.value(t);
}

void Timer64::set_count(unsigned half, std::uint32_t value) {
  const std::uint64_t t = ticks();
  shadow_valid_ = false;
  if (wide()) {
    const std::uint64_t old = half_[0].counter.value(t);
    const std::uint64_t both =
        half ? std::uint64_t{value} << 32 | (old & 0xFFFFFFFFu) : (old & ~0xFFFFFFFFull) | value;
    half_[0].counter.set_value(both, t);
  } else {
    half_[half].counter.set_value(value, t);
    if (half == 1 && mode_ == kChained && half_[0].run) {
      half_[0].run = false;  // the prescaler's position has changed
      reconfigure();
    }
  }
  reschedule();
}

void Timer64::load_periods() {
  const std::uint64_t t = ticks();
  const std::uint64_t low = regs.prd12.get(), high = regs.prd34.get();
  half_[0].counter.set_period(wide() ? high << 32 | low : low, t);
  half_[1].counter.set_period(high, t);
  if (mode_ == kChained) reconfigure();
  reschedule();
}

void Timer64::apply(Half& half, bool run, bool once, std::uint64_t prescale, std::uint64_t phase) {
  const std::uint64_t t = ticks();
  if (run == half.run && once == half.once && prescale == half.prescale) return;
  if (half.run) half.counter.stop(t);
  if (run) half.counter.start(t, once, prescale, std::min(phase, prescale - 1));
  half.run = run;
  half.once = once;
  half.prescale = prescale;
}

void Timer64::reconfigure() {
  const std::uint32_t mode = regs.tgcr.timmode.get();
  if (mode != mode_) {
    const std::uint64_t low = count(0), high = count(1), t = ticks();
    for (Half& h : half_) {
      h.counter.stop(t);
      h.run = false;
    }
    mode_ = mode;
    half_[0].counter = TimerCounter(wide() ? 64 : 32);
    half_[1].counter = TimerCounter(32);
    half_[0].counter.set_value(wide() ? high << 32 | low : low, t);
    half_[1].counter.set_value(high, t);
    load_periods();
  }
  const bool rs12 = regs.tgcr.tim12rs.get(), rs34 = regs.tgcr.tim34rs.get();
  const std::uint32_t ena12 = regs.tcr.enamode12.get(), ena34 = regs.tcr.enamode34.get();
  const bool serving = watchdog_ == Watchdog::kActive || watchdog_ == Watchdog::kServing;
  Half &h12 = half_[0], &h34 = half_[1];
  switch (mode) {
    case k64:
      apply(h12, rs12 && rs34 && ena12, ena12 == 1, 1, 0);
      apply(h34, false, false, 1, 0);
      break;
    case kWatchdog:
      apply(h12, rs12 && rs34 && ena12 && serving, true, 1, 0);
      apply(h34, false, false, 1, 0);
      break;
    case kUnchained:
      apply(h12, rs12 && ena12, ena12 == 1, 1, 0);
      apply(h34, rs34 && ena34, ena34 == 1, regs.tgcr.psc34.get() + 1, regs.tgcr.tddr34.get());
      break;
    case kChained: {
      const std::uint64_t position = count(1);
      const bool run = rs12 && rs34 && ena12;
      apply(h12, run, ena12 == 1, std::uint64_t{regs.prd34.get()} + 1, position);
      if (!run) h34.counter.set_value(position, ticks());  // TIM34 keeps its position
      break;
    }
  }
  reschedule();
}

void Timer64::matched(unsigned half) {
  (half ? regs.intctl_stat.stat34 : regs.intctl_stat.stat12).set(1);
  regs.cap12.set(static_cast<std::uint32_t>(count(0)));
  regs.cap34.set(static_cast<std::uint32_t>(count(1)));
  if (mode_ == kWatchdog) {
    watchdog_ = Watchdog::kExpired;
    reset_cause_ = "the watchdog expired";
    regs.wdtcr.wdflag.set(1);
  }
}

/// ENAMODE = 3: the new period takes effect with the count of 0, one tick after the match.
void Timer64::reload(unsigned half) {
  if ((half ? regs.tcr.enamode34.get() : regs.tcr.enamode12.get()) != 3) return;
  if (half == 0) regs.prd12.set(regs.rel12.get());
  if (half == 1 || wide()) regs.prd34.set(regs.rel34.get());
  load_periods();
}

void Timer64::watchdog_key(std::uint32_t word) {
  const std::uint32_t key = word >> 16;
  switch (watchdog_) {
    case Watchdog::kIdle:
      if (key == kKey1) watchdog_ = Watchdog::kPreActive;
      for (Lockable& l : lockable_) l.value = l.reg->get();
      break;
    case Watchdog::kPreActive:
      watchdog_ = key == kKey2 && regs.wdtcr.wden ? Watchdog::kActive
                  : key == kKey1                  ? Watchdog::kPreActive
                                                  : Watchdog::kIdle;
      break;
    case Watchdog::kActive:
      regs.wdtcr.wden.set(1);
      watchdog_ = key == kKey1 ? Watchdog::kServing : key == kKey2 ? Watchdog::kActive : Watchdog::kExpired;
      break;
    case Watchdog::kServing:
      regs.wdtcr.wden.set(1);
      if (key == kKey2) {
        watchdog_ = Watchdog::kActive;
        half_[0].counter.set_value(0, ticks());
      } else if (key != kKey1) {
        watchdog_ = Watchdog::kExpired;
      }
      break;
    case Watchdog::kExpired:
      break;
  }
  if (watchdog_ == Watchdog::kExpired && !regs.wdtcr.wdflag) {
    regs.wdtcr.wdflag.set(1);
    reset_cause_ = "a wrong key was written to the active watchdog, as Linux does to restart";
  }
  reconfigure();
}

void Timer64::on_reset(ResetKind) {
  half_ = {};
  half_[0].counter = TimerCounter(64);
  mode_ = k64;
  watchdog_ = Watchdog::kIdle;
  pin_reset_ = shadow_valid_ = false;
  wake_.soon();
}

void Timer64::reschedule() {
  const std::uint64_t t = ticks();
  for (Half& h : half_) {
    if (h.run && t >= h.due) continue;  // a match at this instant is handled by update()
    h.due = h.run ? h.counter.next_match(t) : kNever;
  }
  wake_.soon();
}

void Timer64::update() {
  const std::uint64_t t = ticks();
  for (unsigned n = 0; n < 2; ++n) {
    Half& h = half_[n];
    if (t < h.due) continue;
    h.level = mode_ != kWatchdog;
    h.off = h.due + 1;
    matched(n);
    h.due = h.counter.next_match(t);
  }
  for (unsigned n = 0; n < 2; ++n) {
    Half& h = half_[n];
    if (t < h.off) continue;
    h.level = false;
    h.off = kNever;
    reload(n);
  }
  tint12.write(half_[0].level);
  tint34.write(half_[1].level);
  expired.write(watchdog_ == Watchdog::kExpired || pin_reset_);
  wake_.move_to(time_of(std::min(std::min(half_[0].due, half_[1].due),
                                    std::min(half_[0].off, half_[1].off))));
}

}  // namespace fovea::periph
