#include "model/board/serial_sender.h"

namespace fovea::board {

SerialSender::SerialSender(sc_core::sc_module_name name, periph::Uart16550& uart,
                           SerialInput& input)
    : sc_module(name), uart_(uart), input_(input) {
  SC_HAS_PROCESS(SerialSender);
  SC_METHOD(run);
  sensitive << look_.event() << over_.event();
  uart_.on_ready = [this] { look_.soon(); };
}

void SerialSender::kick() {
  look_.soon();
}

void SerialSender::run() {
  const Picoseconds now = kernel_time();
  if (on_line_) {
    if (!over_.event().triggered()) return;
    uart_.receive(*on_line_);
    on_line_.reset();
  }
  if (!uart_.can_receive()) return;  // on_ready will call
  on_line_ = input_.next(now);
  if (on_line_) {
    over_.at(now + uart_.character_time());
  } else {
    look_.at(input_.ask_again());
  }
}

}  // namespace fovea::board
