// GPIO: general-purpose input and output pins.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <systemc>

#include "model/periph/clocked_target.h"

namespace fovea::periph {

inline constexpr unsigned kGpioPins = 104;
inline constexpr unsigned kGpioBanks = 4;        ///< register groups of 32 pins each
inline constexpr unsigned kGpioDirectIrqs = 16;  ///< GPIO0 to GPIO15 have one AINTC input each

struct GpioRegs : RegBank {
  Reg pid{*this, "PID", 0x00, Mode::kRo, "peripheral identification (value not public)"};
  Reg binten{*this, "BINTEN", 0x08, Mode::kRw, "bit n: interrupts of pins 16n..16n+15"};
  /// The registers of 32 pins, in groups of 0x28 bytes from offset 0x10 on.
  struct Bank {
    Bank(RegBank& bank, unsigned n);
    Reg dir, out_data, set_data, clr_data, in_data, set_ris, clr_ris, set_fal, clr_fal, intstat;
  };
  std::deque<Bank> banks;
  GpioRegs();
};

/// GPIO at 0x01C67000 with 104 pins. If SET_RIS or SET_FAL selects an edge of a pin (an input, or
/// an output that software drives), the edge sets INTSTAT and, for pins 0 to 15 while BINTEN is
/// set, pulses the pin's interrupt line for one clock period. Not modelled: debouncing, pin
/// multiplexing (PINMUX does not disconnect a pin), the shared interrupts of the banks.
class Gpio : public WithRegs<GpioRegs>, public ClockedTarget {
 public:
  SC_HAS_PROCESS(Gpio);
  sc_core::sc_vector<OptionalOut<bool>> irq{"irq", kGpioDirectIrqs};
  using OutputObserver = std::function<void(unsigned bank, std::uint32_t out, Picoseconds)>;
  /// The observer is called with the levels that a bank drives after a change: OUT_DATA of the output
  /// pins, 0 elsewhere.
  Subscription observe_outputs(OutputObserver observer) { return outputs_.add(std::move(observer)); }

  explicit Gpio(sc_core::sc_module_name name);
  /// Sets the level that the board drives on a pin. Before the simulation starts, this is no edge.
  void set_pin(unsigned pin, bool level);
  bool pin(unsigned pin) const { return levels(pin / 32) >> pin % 32 & 1; }

 private:
  std::uint32_t levels(unsigned bank) const;
  void output_written(unsigned bank);
  void levels_changed(unsigned bank);
  void clock_changed() override { wake_.soon(); }
  void on_reset(ResetKind) override;
  void update();

  struct State {
    std::uint32_t driven = 0;  // levels driven by the board
    std::uint32_t last = 0;    // levels at the last call, for the detection of edges
    std::uint32_t rising = 0, falling = 0;
    std::uint32_t shown = 0;  // value last passed to the observers
  };
  Observers<OutputObserver> outputs_;
  std::array<State, kGpioBanks> state_;
  std::array<std::uint64_t, kGpioDirectIrqs> off_;  // tick at which the pulse ends
  std::uint32_t fired_ = 0;                         // pins 0 to 15 whose pulse begins now
  Timer wake_;
};

}  // namespace fovea::periph
