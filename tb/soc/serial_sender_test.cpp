// The far end of a UART's receive line: every byte arrives at its time, also where the host stops the
// simulation at that very time.
#include <deque>

#include "model/board/serial_sender.h"
#include "tb/periph/bench.h"

namespace fovea::board {
namespace {
using test::now;
using test::run_until;

struct Typed : SerialInput {
  std::deque<std::uint8_t> bytes;
  std::optional<std::uint8_t> next(Picoseconds) override {
    if (bytes.empty()) return {};
    const std::uint8_t b = bytes.front();
    bytes.pop_front();
    return b;
  }
};

struct System {
  ClockSignal clk{"clk", Frequency(24'000'000)};
  periph::Uart16550 uart{"uart"};
  Typed typed;
  SerialSender sender{"sender", uart, typed};
  test::Bus bus{"bus"};
  System() {
    uart.clk(clk);
    bus.socket.bind(uart.reg_socket);
  }
};

TEST(SerialSenderTest, AByteArrivesThoughTheHostStopsAtItsLastPicosecond) {
  static System s;
  s.bus.write(0x20, 13);      // DLL: 24 MHz / (13 x 16) = 115.4 kBaud
  s.bus.write(0x0C, 3);       // LCR: eight bits, no parity, one stop bit
  s.bus.write(0x30, 0xE001);  // PWREMU_MGMT: both halves run
  const auto received = [] { return (s.bus.read(0x14) & 1) != 0; };  // LSR.DR
  ASSERT_FALSE(received());
  for (const std::uint8_t byte : {0x41, 0x42}) {
    const Picoseconds over = now() + s.uart.character_time();
    s.typed.bytes.push_back(byte);
    s.sender.kick();
    run_until(over - 1);
    EXPECT_FALSE(received());
    run_until(over);
    ASSERT_TRUE(received());
    EXPECT_EQ(s.bus.read(0x00) & 0xFFu, byte);
  }
}

}  // namespace
}  // namespace fovea::board

FOVEA_SC_TEST_MAIN
