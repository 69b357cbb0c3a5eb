// Sends bytes into a UART's receiver, as a terminal at the far end of the serial line would.
#pragma once
#include <cstdint>
#include <optional>
#include <systemc>

#include "model/common/timer.h"
#include "model/periph/uart16550.h"

namespace fovea::board {

/// What is typed.
class SerialInput {
 public:
  virtual ~SerialInput() = default;
  /// The next byte, if there is one to send at this simulated time. May block the host, but not
  /// simulated time.
  virtual std::optional<std::uint8_t> next(Picoseconds now) = 0;
  /// After next() had nothing: when to ask again by itself; kNever: only after kick().
  virtual Picoseconds ask_again() const { return kNever; }
};

/// Sends at the rate that the UART is programmed for, byte after byte, each as soon as the receiver
/// runs and has room: a line with ideal flow control, on which nothing is lost by overrun.
class SerialSender : public sc_core::sc_module {
 public:
  SerialSender(sc_core::sc_module_name name, periph::Uart16550& uart, SerialInput& input);
  /// The input has something new.
  void kick();

 private:
  void run();

  periph::Uart16550& uart_;
  SerialInput& input_;
  std::optional<std::uint8_t> on_line_;  // its last stop bit ends with `over_`
  Timer look_, over_;
};

}  // namespace fovea::board
