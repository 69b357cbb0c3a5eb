// UART timing: byte times to the picosecond, FIFO rules, interrupts.
#include <string>
#include <utility>
#include <vector>

#include "model/periph/uart16550.h"
#include "tb/periph/bench.h"

namespace fovea::periph {
namespace {
using test::now;
using test::run_until;

Picoseconds edge(std::uint64_t k) { return k * 125'000 / 3; }  // 24 MHz

enum : std::uint32_t {
  kData = 0x00,
  kIer = 0x04,
  kIirFcr = 0x08,
  kLcr = 0x0C,
  kMcr = 0x10,
  kLsr = 0x14,
  kScr = 0x1C,
  kDll = 0x20,
  kDlh = 0x24,
  kPwremu = 0x30,
  kMdr = 0x34
};

struct System {
  ClockSignal clk{"clk", Frequency(24'000'000)};
  sc_core::sc_signal<bool> irq{"irq"};
  Uart16550 uart{"uart"};
  test::Bus bus{"bus"};
  test::Probe probe{"probe"};
  std::vector<std::pair<std::uint8_t, Picoseconds>> sent;
  std::vector<Picoseconds> receive_events, transmit_events;
  System() {
    uart.clk(clk);
    uart.irq(irq);
    bus.socket.bind(uart.reg_socket);
    probe.in(irq);
    uart.sink = [this](std::uint8_t b, Picoseconds t) { sent.emplace_back(b, t); };
    uart.on_receive_event = [this] { receive_events.push_back(now()); };
    uart.on_transmit_event = [this] { transmit_events.push_back(now()); };
  }
};

struct UartTest : testing::Test {
  static System& system() {
    static System* s = new System;
    return *s;
  }
  System& s = system();
  test::Bus& bus = s.bus;

  void SetUp() override {
    bus.write(kPwremu, 0);
    bus.write(kIirFcr, 7);
    bus.write(kIirFcr, 0);
    bus.write(kIer, 0);
    bus.write(kMcr, 0);
    bus.write(kMdr, 0);
    bus.write(kDll, 13);
    bus.write(kDlh, 0);
    bus.write(kLcr, 3);  // 8N1
    bus.write(kPwremu, 0xE001);
    bus.read(kData);
    bus.read(kLsr);
    s.sent.clear();
    s.receive_events.clear();
    s.transmit_events.clear();
  }
  static std::uint64_t next_edge() {
    std::uint64_t k = now() * 3 / 125'000;
    while (edge(k) <= now()) ++k;
    return k;
  }
};

TEST_F(UartTest, EightN1ByteTakesTenBitsOfSixteenTimesTheDivisor) {
  run_until(now() + 12'345);
  const std::uint64_t k = next_edge();
  bus.write(kData, 'A');
  const Picoseconds end = edge(k + 10 * 16 * 13);
  run_until(end - 1);
  EXPECT_TRUE(s.sent.empty());
  EXPECT_EQ(bus.read(kLsr) & 0x60, 0x20u);  // THR free, line busy
  run_until(end);
  ASSERT_EQ(s.sent.size(), 1u);
  EXPECT_EQ(s.sent[0], std::make_pair(std::uint8_t{'A'}, end));
  EXPECT_EQ(bus.read(kLsr) & 0x60, 0x60u);
}

TEST_F(UartTest, FifoBytesFollowWithoutGapAndInOrder) {
  bus.write(kIirFcr, 1);
  const std::uint64_t k = next_edge();
  const std::string text = "Fovea 0123456789";
  for (char c : text) bus.write(kData, static_cast<std::uint8_t>(c));
  run_until(edge(k + text.size() * 2080));
  ASSERT_EQ(s.sent.size(), text.size());
  for (std::size_t n = 0; n < text.size(); ++n) {
    EXPECT_EQ(s.sent[n].first, static_cast<std::uint8_t>(text[n]));
    EXPECT_EQ(s.sent[n].second, edge(k + (n + 1) * 2080)) << n;
  }
}

TEST_F(UartTest, AByteTooManyTakesTheLastPlaceOfTheTransmitFifo) {
  bus.write(kIirFcr, 1);
  for (std::uint32_t n = 0; n < 18; ++n) bus.write(kData, n);  // one in the shift register, 16, one
  run_until(now() + edge(30 * 2080));
  ASSERT_EQ(s.sent.size(), 17u);
  for (unsigned n = 0; n < 16; ++n) EXPECT_EQ(s.sent[n].first, n);
  EXPECT_EQ(s.sent[16].first, 17u);
}

TEST_F(UartTest, FcrEmptiesEachFifoAlone) {
  for (const bool transmit : {false, true}) {
    s.sent.clear();
    bus.write(kIirFcr, 1);
    for (std::uint32_t n = 0; n < 3; ++n) bus.write(kData, 'a' + n);  // one in the shift register
    s.uart.receive('x');
    s.uart.receive('y');
    bus.write(kIirFcr, transmit ? 5 : 3);
    EXPECT_EQ(bus.read(kLsr) & 1, transmit ? 1u : 0u);
    run_until(now() + edge(5 * 2080));
    EXPECT_EQ(s.sent.size(), transmit ? 1u : 3u);
    EXPECT_EQ(bus.read(kData), transmit ? 'x' : 0u);
    EXPECT_EQ(bus.read(kLsr) & 1, transmit ? 1u : 0u);
    bus.write(kIirFcr, 7);
  }
}

// PC16550D, 8.4: FCR0 must be 1 when other bits are written to, or they are not programmed.
TEST_F(UartTest, WithoutFifoenTheOtherBitsOfFcrAreNotProgrammed) {
  s.uart.receive('x');
  bus.write(kIirFcr, 0xCE);  // would empty the FIFOs
  EXPECT_EQ(bus.read(kLsr) & 1u, 1u);
  EXPECT_EQ(bus.read(kData), 'x');
  EXPECT_EQ(bus.read(kIirFcr) >> 6, 0u);
}

// The part's registers are bytes: a write of others of the word sends nothing and changes nothing.
TEST_F(UartTest, OnlyTheLowestByteOfAWordReachesTheRegisters) {
  bus.write(kIirFcr, 1);
  bus.write(kIer, 5);
  for (const std::uint32_t reg : {kData, kIer, kIirFcr})
    for (const unsigned lane : {1u, 2u, 3u}) bus.write(reg + lane, 0xFF, 1);
  bus.write(kData + 2, 0xFFFF, 2);
  EXPECT_EQ(bus.read(kLsr) & 0x60, 0x60u);
  EXPECT_EQ(bus.read(kIer), 5u);
  EXPECT_EQ(bus.read(kIirFcr) >> 6, 3u);
  bus.write(kLcr, 0x83);
  bus.write(kData + 1, 0xFF, 1);
  bus.write(kIer + 1, 0xFF, 1);
  EXPECT_EQ(bus.read(kData), 13u);
  EXPECT_EQ(bus.read(kIer), 0u);
  bus.write(kLcr, 3);
}

TEST_F(UartTest, BytesLeftAfterAReadTimeOutAgain) {
  bus.write(kIirFcr, 0x81);  // FIFOs, interrupt from 8 bytes on
  bus.write(kIer, 1);
  for (unsigned n = 0; n < 3; ++n) s.uart.receive(static_cast<std::uint8_t>(n));
  run_until(now() + edge(5 * 2080));
  EXPECT_EQ(bus.read(kIirFcr) & 0xF, 12u);
  EXPECT_EQ(bus.read(kData), 0u);
  EXPECT_EQ(bus.read(kIirFcr) & 0xF, 1u);
  const std::uint64_t k = next_edge() - 1;
  run_until(edge(k + 4 * 2080) - 1);
  EXPECT_FALSE(s.irq.read());
  run_until(edge(k + 4 * 2080));
  EXPECT_TRUE(s.irq.read());
  EXPECT_EQ(bus.read(kIirFcr) & 0xF, 12u);
  EXPECT_EQ(bus.read(kData), 1u);
  EXPECT_EQ(bus.read(kData), 2u);
  run_until(now() + edge(5 * 2080));
  EXPECT_EQ(bus.read(kIirFcr) & 0xF, 1u);  // empty: no time-out
}

TEST_F(UartTest, AResetTransmitterDropsTheByteItIsSending) {
  bus.write(kData, 'X');
  run_until(now() + edge(1000));
  bus.write(kPwremu, 0xA001);  // receiver only
  EXPECT_EQ(bus.read(kLsr) & 0x40, 0x40u);
  bus.write(kPwremu, 0xE001);
  run_until(now() + edge(3 * 2080));
  EXPECT_TRUE(s.sent.empty());
}

struct Format {
  std::uint32_t lcr, mdr, divisor;
  std::uint64_t ticks;
};
TEST_F(UartTest, DivisorFormatAndOversamplingSetTheTime) {
  const Format formats[] = {
      {3, 0, 14, 10 * 16 * 14},        // divisor + 1
      {3, 0, 0x101, 10 * 16 * 0x101},  // both divisor bytes
      {7, 0, 13, 11 * 16 * 13},        // second stop bit
      {0xB, 0, 13, 11 * 16 * 13},      // parity
      {0, 0, 13, 7 * 16 * 13},         // 5 data bits
      {4, 0, 13, 15 * 16 * 13 / 2},    // 5 data bits, 1.5 stop bits
      {3, 1, 13, 10 * 13 * 13},        // 13 samples a bit
  };
  for (const Format& f : formats) {
    s.sent.clear();
    bus.write(kLcr, f.lcr);
    bus.write(kMdr, f.mdr);
    bus.write(kDll, f.divisor & 0xFF);
    bus.write(kDlh, f.divisor >> 8);
    const std::uint64_t k = next_edge();
    bus.write(kData, 0x55);
    run_until(edge(k + f.ticks));
    ASSERT_EQ(s.sent.size(), 1u) << f.ticks;
    EXPECT_EQ(s.sent[0].second, edge(k + f.ticks));
  }
}

TEST_F(UartTest, DlabGivesTheDivisorAtTheClassicOffsets) {
  bus.write(kLcr, 0x83);
  bus.write(kData, 0x27, 1);
  bus.write(kIer, 0x01, 1);
  EXPECT_EQ(bus.read(kData), 0x27u);
  bus.write(kLcr, 0x03);
  EXPECT_EQ(bus.read(kDll), 0x27u);
  EXPECT_EQ(bus.read(kDlh), 0x01u);
  EXPECT_EQ(bus.read(kIer), 0x00u);  // the interrupt enables were not touched
  EXPECT_TRUE(s.sent.empty());
}

TEST_F(UartTest, NothingLeavesWhileTheTransmitterIsInReset) {
  bus.write(kPwremu, 0x2001);
  bus.write(kData, 'x');
  run_until(now() + 200'000'000);
  EXPECT_TRUE(s.sent.empty());
  const std::uint64_t k = next_edge();
  bus.write(kPwremu, 0x6001);
  run_until(edge(k + 2080));
  ASSERT_EQ(s.sent.size(), 1u);
  EXPECT_EQ(s.sent[0].second, edge(k + 2080));
}

/// A divisor of 0 gives no baud clock. Either half makes one.
TEST_F(UartTest, ByteWaitsForADivisor) {
  for (const std::uint32_t half : {kDll, kDlh}) {
    bus.write(kDll, 0);
    bus.write(kDlh, 0);
    s.sent.clear();
    bus.write(kData, 'x');
    run_until(now() + 200'000'000);
    EXPECT_TRUE(s.sent.empty()) << half;
    const std::uint64_t k = next_edge(), character = 10 * 16 * (half == kDll ? 1 : 256);
    bus.write(half, 1);
    run_until(edge(k + character));
    ASSERT_EQ(s.sent.size(), 1u) << half;
    EXPECT_EQ(s.sent[0].second, edge(k + character)) << half;
  }
}

TEST_F(UartTest, TransmitInterruptComesWhenTheHoldingRegisterEmptiesAndGoesWithIir) {
  EXPECT_FALSE(s.irq.read());
  bus.write(kIer, 2);  // the register is empty: at once
  EXPECT_TRUE(s.irq.read());
  EXPECT_EQ(bus.read(kIirFcr) & 0xF, 2u);
  EXPECT_FALSE(s.irq.read());
  EXPECT_EQ(bus.read(kIirFcr) & 0xF, 1u);
  const std::uint64_t k = next_edge();
  bus.write(kData, 'a');  // moves on into the shift register
  EXPECT_TRUE(s.irq.read());
  bus.write(kData, 'b');
  EXPECT_FALSE(s.irq.read());
  const unsigned rises = s.probe.rises;
  run_until(edge(k + 2080));
  EXPECT_EQ(s.probe.rises, rises + 1);
  EXPECT_EQ(s.probe.last_rise, edge(k + 2080));
  run_until(edge(k + 2 * 2080));
}

TEST_F(UartTest, ReceivedByteInterruptsAndOverrunIsFlaggedOnce) {
  bus.write(kIer, 1);
  s.uart.receive('q');
  test::settle();
  EXPECT_TRUE(s.irq.read());
  EXPECT_EQ(bus.read(kIirFcr) & 0xF, 4u);
  EXPECT_EQ(bus.read(kLsr) & 3, 1u);
  s.uart.receive('r');
  EXPECT_EQ(bus.read(kLsr) & 3, 3u);
  EXPECT_EQ(bus.read(kLsr) & 3, 1u);
  EXPECT_EQ(bus.read(kData), std::uint32_t{'r'});
  EXPECT_FALSE(s.irq.read());
  EXPECT_EQ(bus.read(kLsr) & 1, 0u);
}

TEST_F(UartTest, FifoTriggerLevelAndTimeoutAfterFourCharacters) {
  bus.write(kIirFcr, 1 | 1u << 6);  // trigger at 4
  bus.write(kIer, 1);
  for (int n = 0; n < 3; ++n) s.uart.receive(static_cast<std::uint8_t>(n));
  const std::uint64_t k = next_edge() - 1;
  test::settle();
  EXPECT_FALSE(s.irq.read());
  run_until(edge(k + 4 * 2080) - 1);
  EXPECT_FALSE(s.irq.read());
  run_until(edge(k + 4 * 2080));
  EXPECT_TRUE(s.irq.read());
  EXPECT_EQ(bus.read(kIirFcr), 0xC0u | 12);
  s.uart.receive(3);
  test::settle();
  EXPECT_EQ(bus.read(kIirFcr), 0xC0u | 4);
  for (std::uint32_t n = 0; n < 4; ++n) EXPECT_EQ(bus.read(kData), n);
  EXPECT_FALSE(s.irq.read());
}

TEST_F(UartTest, TellsWhenItCanReceiveAndHowLongAByteTakes) {
  unsigned told = 0;
  s.uart.on_ready = [&] { ++told; };
  EXPECT_TRUE(s.uart.can_receive());
  const Picoseconds begin = edge(next_edge() - 1);
  run_until(begin);
  EXPECT_EQ(s.uart.character_time(), edge(next_edge() - 1 + 2080) - begin);  // 10 bits of 16 * 13
  s.uart.receive('a');  // without FIFOs one byte is all
  EXPECT_FALSE(s.uart.can_receive());
  told = 0;
  bus.read(kData);
  EXPECT_TRUE(s.uart.can_receive());
  EXPECT_GT(told, 0u);
  bus.write(kIirFcr, 1);
  for (int n = 0; n < 15; ++n) s.uart.receive('b');
  EXPECT_TRUE(s.uart.can_receive());
  s.uart.receive('b');
  EXPECT_FALSE(s.uart.can_receive());
  bus.write(kIirFcr, 3);
  EXPECT_TRUE(s.uart.can_receive());
  bus.write(kMcr, 0x10);  // loopback: the line is not connected
  EXPECT_FALSE(s.uart.can_receive());
  bus.write(kMcr, 0);
  bus.write(kPwremu, 0x4001);
  EXPECT_FALSE(s.uart.can_receive());
  told = 0;
  bus.write(kPwremu, 0x6001);
  EXPECT_TRUE(s.uart.can_receive());
  EXPECT_GT(told, 0u);
  for (const std::uint32_t divisor : {0u, 1u, 2u}) {
    bus.write(0x20, divisor);
    EXPECT_EQ(s.uart.can_receive(), divisor != 0) << divisor;
  }
  s.uart.on_ready = nullptr;
}

using Times = std::vector<Picoseconds>;

TEST_F(UartTest, ReceiveEventComesWithTheTriggerLevelAndWithTheTimeOut) {
  for (const auto& [bits, level] : {std::pair{0u, 1u}, {1u, 4u}, {2u, 8u}, {3u, 14u}}) {
    bus.write(kIirFcr, 0);
    bus.write(kIirFcr, 9 | bits << 6);
    s.receive_events.clear();
    for (unsigned n = 1; n < level; ++n) s.uart.receive('a');
    EXPECT_EQ(s.receive_events, Times{}) << level;
    s.uart.receive('b');
    EXPECT_EQ(s.receive_events, Times{now()}) << level;
    s.uart.receive('c');  // above the level
    EXPECT_EQ(s.receive_events.size(), 1u) << level;
    bus.read(kData);
    bus.read(kData);
    s.uart.receive('d');
    EXPECT_EQ(s.receive_events.size(), 2u) << level << ": reached once more";
  }
  bus.write(kIirFcr, 0);
  bus.write(kIirFcr, 9 | 1 << 6);
  s.receive_events.clear();
  s.uart.receive('x');
  const Picoseconds end = edge(next_edge() - 1 + 4 * 2080);
  run_until(end - 1);
  EXPECT_EQ(s.receive_events, Times{});
  run_until(end);
  EXPECT_EQ(s.receive_events, Times{end});
}

TEST_F(UartTest, TransmitEventComesWhenTheFifoRunsEmptyAndWithUtrst) {
  bus.write(kIirFcr, 9);
  const std::uint64_t k = next_edge();
  const Picoseconds written = now();
  for (const char c : {'a', 'b', 'c'}) bus.write(kData, static_cast<std::uint8_t>(c));
  run_until(edge(k + 3 * 2080));
  // 'a' goes to the shift register at once, 'c' when 'b' has been sent.
  EXPECT_EQ(s.transmit_events, (Times{written, edge(k + 2 * 2080)}));
  s.transmit_events.clear();
  bus.write(kPwremu, 0xE001);
  EXPECT_EQ(s.transmit_events, Times{}) << "it runs already";
  bus.write(kPwremu, 0x2001);
  bus.write(kPwremu, 0xE001);
  EXPECT_EQ(s.transmit_events, Times{now()});
  bus.write(kPwremu, 0x2001);
  bus.write(kData, 'd');
  bus.write(kPwremu, 0xE001);
  EXPECT_EQ(s.transmit_events.size(), 2u) << "once: when its byte leaves the FIFO";
}

TEST_F(UartTest, NoEventsWithoutFifosOrDmaMode) {
  for (const std::uint32_t fcr : {0u, 1u, 8u}) {
    bus.write(kIirFcr, fcr);
    bus.write(kPwremu, 0x2001);
    bus.write(kPwremu, 0xE001);
    bus.write(kData, 'a');
    s.uart.receive('b');
    run_until(now() + 6 * edge(2080));
    bus.read(kData);
    EXPECT_EQ(s.receive_events, Times{}) << fcr;
    EXPECT_EQ(s.transmit_events, Times{}) << fcr;
  }
}

TEST_F(UartTest, LoopbackFeedsTheReceiver) {
  bus.write(kMcr, 0x10);
  const std::uint64_t k = next_edge();
  bus.write(kData, 0x5A);
  run_until(edge(k + 2080));
  EXPECT_TRUE(s.sent.empty());
  EXPECT_EQ(bus.read(kLsr) & 1, 1u);
  EXPECT_EQ(bus.read(kData), 0x5Au);
}

TEST_F(UartTest, ClockChangeStretchesTheRestOfTheByte) {
  const std::uint64_t k = next_edge();
  bus.write(kData, 'z');
  run_until(edge(k + 1000));
  s.clk.write(Frequency(12'000'000));
  test::settle();
  const Picoseconds change = now();
  run_until(change + 1080 * 250'000 / 3);
  ASSERT_EQ(s.sent.size(), 1u);
  EXPECT_EQ(s.sent[0].second, change + 1080 * 250'000 / 3);
  s.clk.write(Frequency(24'000'000));
  // Back on the grid of the run's start, which the other cases compute with.
  test::settle();
}

}  // namespace
}  // namespace fovea::periph

FOVEA_SC_TEST_MAIN
