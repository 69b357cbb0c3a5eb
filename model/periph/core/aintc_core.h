// The interrupt controller without SystemC: latches, priorities, outputs and entry registers.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "model/common/regbank.h"

namespace fovea::periph {

inline constexpr unsigned kInterruptCount = 64;

/// Registers of the AINTC at 0x01C48000 (Linux irq-davinci-aintc.c, TI's register header).
/// Status bits: 0 pending, 1 idle.
struct AintcRegs : RegBank {
  Reg fiq0{*this, "FIQ0", 0x00, Mode::kW1c, "FIQ sources 0-31: 0 pending; write 1 acknowledges",
           ~0u};
  Reg fiq1{*this, "FIQ1", 0x04, Mode::kW1c, "FIQ sources 32-63", ~0u};
  Reg irq0{*this, "IRQ0", 0x08, Mode::kW1c, "IRQ sources 0-31: 0 pending; write 1 acknowledges",
           ~0u};
  Reg irq1{*this, "IRQ1", 0x0C, Mode::kW1c, "IRQ sources 32-63", ~0u};
  Reg fiqentry{*this, "FIQENTRY", 0x10, Mode::kRo, "entry address of the most urgent FIQ"};
  Reg irqentry{*this, "IRQENTRY", 0x14, Mode::kRo, "entry address of the most urgent IRQ"};
  Reg eint0{*this, "EINT0", 0x18, Mode::kRw, "enables of sources 0-31"};
  Reg eint1{*this, "EINT1", 0x1C, Mode::kRw, "enables of sources 32-63"};
  struct Intctl : Reg {
    using Reg::Reg;
    Field feraw{*this, "FERAW", 0, 1, Mode::kRw, "FIQENTRY also shows disabled sources"};
    Field ieraw{*this, "IERAW", 1, 1, Mode::kRw, "IRQENTRY also shows disabled sources"};
    Field idmode{*this, "IDMODE", 2, 1, Mode::kRw, "1: a disable waits for the acknowledge"};
  } intctl{*this, "INTCTL", 0x20, "control"};
  struct Eabase : Reg {
    using Reg::Reg;
    Field size{*this, "SIZE", 0, 2, Mode::kRw, "bytes of an entry: 4 << SIZE"};
    Field base{*this, "EABASE", 3, 26, Mode::kRw, "bits 28:3 of the table's address"};
  } eabase{*this, "EABASE", 0x24, "interrupt entry table"};
  std::array<Reg, 8> intpri{Reg{*this, "INTPRI0", 0x30, Mode::kRw, kPri, 0x77777777},
                            Reg{*this, "INTPRI1", 0x34, Mode::kRw, kPri, 0x77777777},
                            Reg{*this, "INTPRI2", 0x38, Mode::kRw, kPri, 0x77777777},
                            Reg{*this, "INTPRI3", 0x3C, Mode::kRw, kPri, 0x77777777},
                            Reg{*this, "INTPRI4", 0x40, Mode::kRw, kPri, 0x77777777},
                            Reg{*this, "INTPRI5", 0x44, Mode::kRw, kPri, 0x77777777},
                            Reg{*this, "INTPRI6", 0x48, Mode::kRw, kPri, 0x77777777},
                            Reg{*this, "INTPRI7", 0x4C, Mode::kRw, kPri, 0x77777777}};

  AintcRegs() : RegBank("AINTC") {}

 private:
  static constexpr const char* kPri = "3 bits a source on a 4-bit pitch: 0-1 FIQ, 2-7 IRQ, 2 first";
};

/// A rising edge sets the latch of its source, even while the source is disabled; the enable bit
/// gates outputs and entry registers. Writing 1 to the status clears the latch. A source that stays
/// high does not set the latch again (edge capture), or does so at once (level capture). There is
/// one latch for each source, and the priority decides whether it appears as FIQ or IRQ. Among
/// equal priorities, the lowest number is first.
class AintcCore {
 public:
  /// @param level_capture true: a latch is set as long as its source is high
  explicit AintcCore(bool level_capture);
  AintcRegs regs;
  /// After a reset: nothing is latched or enabled. A source that stays high is no new edge.
  void reset();
  std::function<void()> on_change;  ///< called after a register write that may change an output

  /// Sets the levels of the 64 sources; bit n is source n.
  void set_sources(std::uint64_t levels);
  bool irq() const { return (active() & ~fiq_map_) != 0; }
  bool fiq() const { return (active() & fiq_map_) != 0; }
  /// The input that drives an output and is served first, FIQs before IRQs; nothing: none does. Bit n of
  /// `among` counts input n.
  std::optional<unsigned> most_urgent(std::uint64_t among = ~std::uint64_t{0}) const;
  std::uint64_t pending() const { return pending_; }

 private:
  std::uint64_t enabled() const { return std::uint64_t{regs.eint1.get()} << 32 | regs.eint0.get(); }
  std::uint64_t active() const { return pending_ & (enabled() | disable_pending_); }
  void changed() {
    if (on_change) on_change();
  }
  void acknowledge(std::uint64_t mask);
  void enable_written();
  void remap();
  std::uint32_t entry(bool fiq) const;
  unsigned first_of(std::uint64_t candidates) const;

  bool level_capture_;
  std::uint64_t levels_ = 0, pending_ = 0;
  std::uint64_t fiq_map_ = 0;  // sources with priority 0 or 1
  std::uint64_t disable_pending_ = 0;  // IDMODE: disabled while active, so kept until acknowledged
  std::uint64_t was_enabled_ = 0;
  std::array<std::uint8_t, kInterruptCount> priority_{};
};

}  // namespace fovea::periph
