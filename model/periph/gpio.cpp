#include "model/periph/gpio.h"

#include <algorithm>

namespace fovea::periph {

namespace {
std::string bank_name(const char* name, unsigned n) {
  return std::string(name) + (n < 3 ? std::to_string(2 * n) + std::to_string(2 * n + 1) : "6");
}
std::uint32_t at(unsigned n, std::uint32_t offset) { return 0x10 + 0x28 * n + offset; }
}  // namespace

GpioRegs::Bank::Bank(RegBank& b, unsigned n)
    : dir(b, bank_name("DIR", n), at(n, 0x0), Mode::kRw, "1: input", ~0u),
      out_data(b, bank_name("OUT_DATA", n), at(n, 0x4), Mode::kRw, "driven levels"),
      set_data(b, bank_name("SET_DATA", n), at(n, 0x8), Mode::kRw, "1 sets OUT_DATA; reads it"),
      clr_data(b, bank_name("CLR_DATA", n), at(n, 0xC), Mode::kRw, "1 clears OUT_DATA; reads it"),
      in_data(b, bank_name("IN_DATA", n), at(n, 0x10), Mode::kRo, "levels of the pins"),
      set_ris(b, bank_name("SET_RIS_TRIG", n), at(n, 0x14), Mode::kRw, "1 enables rising edges"),
      clr_ris(b, bank_name("CLR_RIS_TRIG", n), at(n, 0x18), Mode::kRw, "1 disables rising edges"),
      set_fal(b, bank_name("SET_FAL_TRIG", n), at(n, 0x1C), Mode::kRw, "1 enables falling edges"),
      clr_fal(b, bank_name("CLR_FAL_TRIG", n), at(n, 0x20), Mode::kRw, "1 disables falling edges"),
      intstat(b, bank_name("INTSTAT", n), at(n, 0x24), Mode::kW1c, "edges seen") {}

GpioRegs::GpioRegs() : RegBank("GPIO") {
  for (unsigned n = 0; n < kGpioBanks; ++n) banks.emplace_back(*this, n);
}

Gpio::Gpio(sc_core::sc_module_name name) : ClockedTarget(name, regs) {
  for (unsigned pin = 0; pin < kGpioDirectIrqs; ++pin)
    add_interrupt("gpio" + std::to_string(pin), irq[pin]);
  off_.fill(kNever);
  for (unsigned n = 0; n < kGpioBanks; ++n) {
    GpioRegs::Bank& b = regs.banks[n];
    State& s = state_[n];
    b.dir.on_write([this, n](std::uint32_t) { output_written(n); });
    b.out_data.on_write([this, n](std::uint32_t) { output_written(n); });
    b.set_data.on_write([this, n, &b](std::uint32_t word) {
      b.out_data.set(b.out_data.get() | word);
      output_written(n);
    });
    b.clr_data.on_write([this, n, &b](std::uint32_t word) {
      b.out_data.set(b.out_data.get() & ~word);
      output_written(n);
    });
    b.set_data.on_read([&b] { b.set_data.set(b.out_data.get()); });
    b.clr_data.on_read([&b] { b.clr_data.set(b.out_data.get()); });
    b.in_data.on_read([this, n, &b] { b.in_data.set(levels(n)); });
    b.set_ris.on_write([&s](std::uint32_t word) { s.rising |= word; });
    b.clr_ris.on_write([&s](std::uint32_t word) { s.rising &= ~word; });
    b.set_fal.on_write([&s](std::uint32_t word) { s.falling |= word; });
    b.clr_fal.on_write([&s](std::uint32_t word) { s.falling &= ~word; });
    for (Reg* r : {&b.set_ris, &b.clr_ris}) r->on_read([r, &s] { r->set(s.rising); });
    for (Reg* r : {&b.set_fal, &b.clr_fal}) r->on_read([r, &s] { r->set(s.falling); });
  }
  SC_METHOD(update);
  sensitive << wake_.event();
}

std::uint32_t Gpio::levels(unsigned bank) const {
  const GpioRegs::Bank& b = regs.banks[bank];
  return (state_[bank].driven & b.dir.get()) | (b.out_data.get() & ~b.dir.get());
}

/// All pins are inputs again, with the levels that the board drives.
void Gpio::on_reset(ResetKind) {
  for (unsigned n = 0; n < kGpioBanks; ++n) {
    state_[n].rising = state_[n].falling = 0;
    output_written(n);
  }
  fired_ = 0;
  off_.fill(0);
  wake_.soon();
}

void Gpio::set_pin(unsigned pin, bool level) {
  FOVEA_CHECK(pin < kGpioPins, "GPIO pin out of range");
  State& s = state_[pin / 32];
  const std::uint32_t bit = 1u << pin % 32;
  s.driven = level ? s.driven | bit : s.driven & ~bit;
  if (sc_core::sc_is_running())
    levels_changed(pin / 32);
  else
    s.last = levels(pin / 32);
}

void Gpio::output_written(unsigned bank) {
  levels_changed(bank);
  State& s = state_[bank];
  const std::uint32_t out = regs.banks[bank].out_data.get() & ~regs.banks[bank].dir.get();
  if (out == s.shown) return;
  s.shown = out;
  outputs_.each([&](OutputObserver& observer) { observer(bank, out, kernel_time()); });
}

void Gpio::levels_changed(unsigned bank) {
  State& s = state_[bank];
  const std::uint32_t now = levels(bank);
  const std::uint32_t edges = (now & ~s.last & s.rising) | (~now & s.last & s.falling);
  s.last = now;
  if (!edges || !running()) return;  // edges are detected with the module's clock
  Reg& intstat = regs.banks[bank].intstat;
  intstat.set(intstat.get() | edges);
  if (bank == 0 && (regs.binten.get() & 1)) {
    fired_ |= edges & 0xFFFF;
    wake_.soon();
  }
}

void Gpio::update() {
  const std::uint64_t t = ticks();
  std::uint64_t next = kNever;
  for (unsigned n = 0; n < kGpioDirectIrqs; ++n) {
    if (t >= off_[n]) {
      off_[n] = kNever;
      irq[n].write(false);
    }
    if (fired_ >> n & 1) {
      off_[n] = t + 1;
      irq[n].write(true);
    }
    next = std::min(next, off_[n]);
  }
  fired_ = 0;
  wake_.move_to(time_of(next));
}

}  // namespace fovea::periph
