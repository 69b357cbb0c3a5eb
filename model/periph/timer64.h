// 64-bit timer: used as one 64-bit timer, two 32-bit timers, chained timers, or watchdog.
#pragma once
#include <array>
#include <functional>
#include <systemc>
#include <vector>

#include "model/periph/clocked_target.h"
#include "model/periph/core/timer_counter.h"

namespace fovea::periph {

struct TimerRegs : RegBank {
  Reg pid12{*this, "PID12", 0x00, Mode::kRo, "peripheral identification (value not public)"};
  Reg emumgt{*this, "EMUMGT_CLKSPD", 0x04, Mode::kRw, "emulation; kept, no effect"};
  Reg gpint_gpen{*this, "GPINT_GPEN", 0x08, Mode::kRw, "bit 17: the timer pin is an output pin"};
  Reg gpdat_gpdir{*this, "GPDAT_GPDIR", 0x0C, Mode::kRw, "bits 17, 1: direction and level of it"};
  Reg tim12{*this, "TIM12", 0x10, Mode::kRw, "counter, lower half"};
  Reg tim34{*this, "TIM34", 0x14, Mode::kRw, "counter, upper half"};
  Reg prd12{*this, "PRD12", 0x18, Mode::kRw, "period, lower half"};
  Reg prd34{*this, "PRD34", 0x1C, Mode::kRw, "period, upper half; chained: prescaler of TIM12"};
  struct Tcr : Reg {
    using Reg::Reg;
    Field enamode12{*this, "ENAMODE12", 6, 2, Mode::kRw, "0 off, 1 once, 2 periodic, 3 reloading"};
    Field clksrc12{*this, "CLKSRC12", 8, 1, Mode::kRw, "1: clock from the pin (not modelled)"};
    Field enamode34{*this, "ENAMODE34", 22, 2, Mode::kRw, "as ENAMODE12, for TIM34 unchained"};
  } tcr{*this, "TCR", 0x20, "control"};
  struct Tgcr : Reg {
    using Reg::Reg;
    Field tim12rs{*this, "TIM12RS", 0, 1, Mode::kRw, "1: TIM12 is out of reset"};
    Field tim34rs{*this, "TIM34RS", 1, 1, Mode::kRw, "1: TIM34 is out of reset"};
    Field timmode{*this, "TIMMODE", 2, 2, Mode::kRw, "0 64-bit, 1 2x32, 2 watchdog, 3 chained"};
    Field plusen{*this, "PLUSEN", 4, 1, Mode::kRw, "kept, no effect"};
    Field psc34{*this, "PSC34", 8, 4, Mode::kRw, "unchained: TIM34 counts every PSC34 + 1 ticks"};
    Field tddr34{*this, "TDDR34", 12, 4, Mode::kRw, "prescaler count at start"};
  } tgcr{*this, "TGCR", 0x24, "global control"};
  struct Wdtcr : Reg {
    using Reg::Reg;
    Field wden{*this, "WDEN", 14, 1, Mode::kRw, "watchdog enable, taken with the second key"};
    Field wdflag{*this, "WDFLAG", 15, 1, Mode::kRo, "the watchdog has expired"};
    Field wdkey{*this, "WDKEY", 16, 16, Mode::kWo, "0xA5C6 then 0xDA7E"};
  } wdtcr{*this, "WDTCR", 0x28, "watchdog control"};
  Reg rel12{*this, "REL12", 0x34, Mode::kRw, "ENAMODE12 = 3: next PRD12, taken at a match"};
  Reg rel34{*this, "REL34", 0x38, Mode::kRw, "ENAMODE34 = 3: next PRD34"};
  Reg cap12{*this, "CAP12", 0x3C, Mode::kRo, "TIM12 at the last match"};
  Reg cap34{*this, "CAP34", 0x40, Mode::kRo, "TIM34 at the last match"};
  struct IntctlStat : Reg {
    using Reg::Reg;
    Field en12{*this, "PRDINTEN12", 0, 1, Mode::kRw, "kept; interrupts come without it"};
    Field stat12{*this, "PRDINTSTAT12", 1, 1, Mode::kW1c, "TIM12 has matched"};
    Field en34{*this, "PRDINTEN34", 16, 1, Mode::kRw, "kept; interrupts come without it"};
    Field stat34{*this, "PRDINTSTAT34", 17, 1, Mode::kW1c, "TIM34 has matched"};
  } intctl_stat{*this, "INTCTL_STAT", 0x44, "interrupt control and status"};

  TimerRegs() : RegBank("TIMER64") {}
};

/// Timer64 (public description of the family: SPRUH82C ch. 30; offsets: TI boot loader, Linux).
///
/// A match raises tint12 or tint34 for one clock period (the AINTC captures the edge). Counters are
/// computed when they are read; the only pending event is the next match or the end of its pulse.
/// Interrupts do not depend on INTCTL_STAT: Linux gets them without writing it. A counter in reset
/// (TIMxxRS = 0) keeps its value (assumed).
///
/// Watchdog: the keys 0xA5C6, 0xDA7E (with WDEN) activate it and later serve it. A word that is neither, or a match,
/// makes it expire, and it stays expired. From the first key on TIM12, TIM34, PRD12, PRD34, TCR and TGCR cannot be
/// written, from the second one on WDEN neither: an active watchdog ends by a reset only (SPRUH82C 30.1.6; which
/// registers: Linux drivers/watchdog/davinci_wdt.c).
///
/// Not modelled: the pin as clock or gate, compare registers, capture of external events.
class Timer64 : public WithRegs<TimerRegs>, public ClockedTarget {
 public:
  SC_HAS_PROCESS(Timer64);
  OptionalOut<bool> tint12{"tint12"}, tint34{"tint34"};
  /// Requests a reset of the chip: the watchdog has expired, or software drives the timer's pin
  /// high, as boot loaders do for a reset (GPINT_GPEN = 0x20000, GPDAT_GPDIR = 0x20002).
  OptionalOut<bool> expired{"expired"};

  explicit Timer64(sc_core::sc_module_name name);
  /// The reason why `expired` is high, for messages.
  const char* reset_cause() const { return reset_cause_; }

 private:
  enum TimerMode : std::uint32_t { k64 = 0, kUnchained = 1, kWatchdog = 2, kChained = 3 };
  enum class Watchdog { kIdle, kPreActive, kActive, kServing, kExpired };
  struct Half {
    TimerCounter counter{32};
    bool run = false, once = false;
    std::uint64_t prescale = 1;
    std::uint64_t due = kNever, off = kNever;  // ticks of the next match and of the end of the
                                               // pulse
    bool level = false;
  };

  /// A register that cannot be written while the watchdog is armed, and its value then.
  struct Lockable {
    Reg* reg;
    std::uint32_t value;
  };

  bool wide() const { return mode_ == k64 || mode_ == kWatchdog; }
  bool locked() const { return mode_ == kWatchdog && watchdog_ != Watchdog::kIdle; }
  void lockable(Reg& reg, std::function<void()> written);
  std::uint64_t count(unsigned half) const;
  void set_count(unsigned half, std::uint32_t value);
  void load_periods();
  void reconfigure();
  void apply(Half& half, bool run, bool once, std::uint64_t prescale, std::uint64_t phase);
  void reschedule();
  void matched(unsigned half);
  void reload(unsigned half);
  void watchdog_key(std::uint32_t word);
  void clock_changed() override { reschedule(); }
  void on_reset(ResetKind) override;
  void update();

  std::vector<Lockable> lockable_;
  std::array<Half, 2> half_;  // TIM12 and TIM34; in the 64-bit modes half_[0] is both
  std::uint32_t mode_ = k64;
  Watchdog watchdog_ = Watchdog::kIdle;
  bool pin_reset_ = false;
  const char* reset_cause_ = "";
  std::uint32_t shadow34_ = 0;  // upper half of the count, latched when the lower half is read
  bool shadow_valid_ = false;
  Timer wake_;
};

}  // namespace fovea::periph
