#include "model/board/serial_sender.h"

namespace fovea::board {

SerialSender::SerialSender(sc_core::sc_module_name name, periph::Uart16550& uart,
                           SerialInput& input)
    : sc_module(name), uart_(uart), input_(input) {
  SC_HAS_PROCESS(SerialSender);
  SC_METHOD(run);
  sensitive << look_ << over_;
  uart_.on_ready = [this] { look_.notify(sc_core::SC_ZERO_TIME); };
}

void SerialSender::kick() {
  look_.notify(sc_core::SC_ZERO_TIME);
  ++horizon_epoch;
}

void SerialSender::run() {
  const Picoseconds now = kernel_time();
  if (on_line_) {
    if (!over_.triggered()) return;
    uart_.receive(*on_line_);
    on_line_.reset();
  }
  if (!uart_.can_receive()) return;  // on_ready tells
  on_line_ = input_.next(now);
  if (on_line_) {
    over_.notify(ps_time(uart_.character_time()));
  } else if (const Picoseconds at = input_.ask_again(); at != kNever) {
    look_.notify(ps_time(at > now ? at - now : 0));
  }
}

}  // namespace fovea::board
