// The I2C master with a register-file target, by polling and by interrupt, with bit timing.
#include <array>
#include <string>
#include <vector>

#include "model/periph/i2c_controller.h"
#include "tb/periph/bench.h"

namespace fovea::periph {
namespace {
using test::now;
using test::run_until;

Picoseconds edge(std::uint64_t k) { return k * 125'000 / 3; }  // 24 MHz

/// A device with 8-bit registers and an auto-incrementing pointer, as video decoders have.
struct FakeDecoder : sc_core::sc_module, I2cTargetIf {
  std::array<std::uint8_t, 256> regs{};
  std::string log;  // S start, s repeated, R/W direction, w/r byte, P stop
  Picoseconds last = 0;
  bool open = false, first = false;
  std::uint8_t address, pointer = 0;
  FakeDecoder(sc_core::sc_module_name name, std::uint8_t a) : sc_module(name), address(a) {}
  bool i2c_start(std::uint8_t a, bool read) override {
    if (a != address) {
      open = false;
      return false;
    }
    log += open ? 's' : 'S';
    log += read ? 'R' : 'W';
    open = true;
    first = true;
    last = now();
    return true;
  }
  bool i2c_write(std::uint8_t byte) override {
    last = now();
    log += 'w';
    if (first)
      pointer = byte;
    else
      regs[pointer++] = byte;
    first = false;
    return byte != 0xEE;  // one value that it refuses
  }
  std::uint8_t i2c_read() override {
    last = now();
    log += 'r';
    return regs[pointer++];
  }
  void i2c_stop() override {
    last = now();
    log += 'P';
    open = false;
  }
};

enum : std::uint32_t {
  kImr = 0x04,
  kStr = 0x08,
  kClkl = 0x0C,
  kClkh = 0x10,
  kCnt = 0x14,
  kDrr = 0x18,
  kSar = 0x1C,
  kDxr = 0x20,
  kMdr = 0x24,
  kIvr = 0x28,
  kPsc = 0x30
};
enum : std::uint32_t {
  kIrs = 1u << 5,
  kRm = 1u << 7,
  kTrx = 1u << 9,
  kMst = 1u << 10,
  kStp = 1u << 11,
  kStt = 1u << 13
};
enum : std::uint32_t {
  kNack = 2,
  kArdy = 4,
  kRrdy = 8,
  kXrdy = 16,
  kScd = 32,
  kRsfull = 0x800,
  kBb = 0x1000
};

struct System {
  ClockSignal clk{"clk", Frequency(24'000'000)};
  sc_core::sc_signal<bool> irq{"irq"};
  I2cController i2c{"i2c"};
  FakeDecoder decoder{"decoder", 0x5D}, other{"other", 0x20};
  test::Bus bus{"bus"};
  std::vector<Picoseconds> receive_events, transmit_events;
  System() {
    i2c.on_receive_event = [this] { receive_events.push_back(now()); };
    i2c.on_transmit_event = [this] { transmit_events.push_back(now()); };
    i2c.clk(clk);
    i2c.irq(irq);
    i2c.targets(decoder);
    i2c.targets(other);
    bus.socket.bind(i2c.reg_socket);
  }
};

struct I2cTest : testing::Test {
  static System& system() {
    static System* s = new System;
    return *s;
  }
  System& s = system();
  test::Bus& bus = s.bus;
  // ICPSC 1, L 50, H 54, d = 6: a bit is 2 x (50 + 54 + 12) = 232 clocks
  static constexpr std::uint64_t kBit = 232;

  void SetUp() override {
    bus.write(kMdr, 0);
    bus.write(kPsc, 1);
    bus.write(kClkl, 50);
    bus.write(kClkh, 54);
    bus.write(kImr, 0);
    bus.write(kMdr, kIrs);
    bus.write(kSar, 0x5D);
    s.decoder.log.clear();
    s.other.log.clear();
    s.decoder.open = false;
    s.receive_events.clear();
    s.transmit_events.clear();
  }
  static std::uint64_t next_edge() {
    std::uint64_t k = now() * 3 / 125'000;
    while (edge(k) <= now()) ++k;
    return k;
  }
  bool poll(std::uint32_t flag) {
    for (int n = 0; n < 2000; ++n) {
      if (bus.read(kStr) & flag) return true;
      run_until(now() + kPsPerUs);
    }
    return false;
  }
  void write_bytes(std::vector<std::uint8_t> bytes, std::uint32_t stop) {
    bus.write(kCnt, static_cast<std::uint32_t>(bytes.size()));
    bus.write(kDxr, bytes[0]);
    bus.write(kMdr, kIrs | kMst | kTrx | kStt | stop);
    for (std::size_t n = 1; n < bytes.size(); ++n) {
      ASSERT_TRUE(poll(kXrdy));
      bus.write(kDxr, bytes[n]);
    }
  }
};

TEST_F(I2cTest, RegisterWriteArrivesWithItsTiming) {
  const std::uint64_t k = next_edge();
  write_bytes({0x12, 0x34}, kStp);
  run_until(edge(k + kBit * (1 + 9 + 9 + 9)) - 1);
  EXPECT_EQ(s.decoder.regs[0x12], 0);
  run_until(edge(k + kBit * (1 + 9 + 9 + 9)));
  EXPECT_EQ(s.decoder.regs[0x12], 0x34);
  EXPECT_EQ(bus.read(kStr) & kBb, kBb);
  run_until(edge(k + kBit * 29));
  EXPECT_EQ(s.decoder.log, "SWwwP");
  EXPECT_EQ(s.decoder.last, edge(k + kBit * 29));
  EXPECT_EQ(bus.read(kStr) & (kBb | kScd), kScd);
  EXPECT_EQ(bus.read(kMdr), kIrs | kTrx);  // MST, STT, STP cleared
  EXPECT_EQ(s.other.log, "");
}

// START and address take 10 bits, a byte 9; each event comes with the byte that it tells of.
TEST_F(I2cTest, EachByteGivesAnEventOfItsDirection) {
  using Times = std::vector<Picoseconds>;
  std::uint64_t k = next_edge();
  write_bytes({0x12, 0x34}, kStp);
  run_until(edge(k + kBit * 29));
  EXPECT_EQ(s.transmit_events, (Times{edge(k + kBit * 10), edge(k + kBit * 19)}));
  EXPECT_EQ(s.receive_events, Times{});
  s.transmit_events.clear();
  k = next_edge();
  bus.write(kCnt, 2);
  bus.write(kMdr, kIrs | kMst | kStt | kStp);
  run_until(edge(k + kBit * 20));
  bus.read(kDrr);
  run_until(edge(k + kBit * 29));
  EXPECT_EQ(s.receive_events, (Times{edge(k + kBit * 19), edge(k + kBit * 28)}));
  EXPECT_EQ(s.transmit_events, Times{});
}

TEST_F(I2cTest, DividersSetTheBitTime) {
  struct Case {
    std::uint32_t psc, l, h;
    std::uint64_t bit;
  };
  for (const Case& c : {Case{0, 50, 54, 118}, Case{1, 50, 54, 232}, Case{2, 50, 54, 342},
                        Case{2, 51, 54, 345}, Case{26, 20, 20, 1350}}) {
    bus.write(kMdr, 0);
    bus.write(kPsc, c.psc);
    bus.write(kClkl, c.l);
    bus.write(kClkh, c.h);
    bus.write(kMdr, kIrs);
    s.decoder.log.clear();
    const std::uint64_t k = next_edge();
    write_bytes({0x01}, kStp);
    run_until(edge(k + c.bit * 20));
    EXPECT_EQ(s.decoder.log, "SWwP");
    EXPECT_EQ(s.decoder.last, edge(k + c.bit * 20)) << c.psc;
  }
}

// SPRUJ17H (AM263x), I2C_ICPSC: the prescaler is taken when IRS goes from 0 to 1.
TEST_F(I2cTest, ThePrescalerIsTakenWithTheEndOfReset) {
  bus.write(kPsc, 9);
  EXPECT_EQ(bus.read(kPsc), 9u);
  std::uint64_t k = next_edge();
  write_bytes({0x12, 0x34}, kStp);
  run_until(edge(k + kBit * 29));
  EXPECT_EQ(s.decoder.last, edge(k + kBit * 29));
  bus.write(kMdr, 0);
  bus.write(kMdr, kIrs);
  k = next_edge();
  write_bytes({0x12, 0x34}, kStp);
  const std::uint64_t bit = 10 * (50 + 54 + 10);
  run_until(edge(k + bit * 29));
  EXPECT_EQ(s.decoder.last, edge(k + bit * 29));
}

TEST_F(I2cTest, ReadWithRepeatedStart) {
  s.decoder.regs[0x80] = 0x51;
  s.decoder.regs[0x81] = 0x46;
  write_bytes({0x80}, 0);
  ASSERT_TRUE(poll(kArdy));
  EXPECT_EQ(bus.read(kStr) & kBb, kBb);  // the bus is held
  bus.write(kCnt, 2);
  bus.write(kMdr, kIrs | kMst | kStt | kStp);
  ASSERT_TRUE(poll(kRrdy));
  EXPECT_EQ(bus.read(kDrr), 0x51u);
  EXPECT_EQ(bus.read(kStr) & kRrdy, 0u);
  ASSERT_TRUE(poll(kRrdy));
  EXPECT_EQ(bus.read(kDrr), 0x46u);
  ASSERT_TRUE(poll(kScd));
  EXPECT_EQ(s.decoder.log, "SWwsRrrP");
}

TEST_F(I2cTest, UnreadByteStretchesTheClock) {
  s.decoder.regs = {1, 2, 3};
  s.decoder.pointer = 0;
  bus.write(kCnt, 3);
  bus.write(kMdr, kIrs | kMst | kStt | kStp);
  run_until(now() + 100 * kBit * 42'000);
  EXPECT_EQ(s.decoder.log, "SRrr");  // one in ICDRR, one in the shift register
  EXPECT_EQ(bus.read(kStr) & kRsfull, kRsfull);
  for (std::uint32_t n = 1; n <= 3; ++n) {
    ASSERT_TRUE(poll(kRrdy));
    EXPECT_EQ(bus.read(kDrr), n);
  }
  ASSERT_TRUE(poll(kScd));
  EXPECT_EQ(s.decoder.log, "SRrrrP");
}

TEST_F(I2cTest, EmptyDataRegisterStretchesTheClock) {
  bus.write(kCnt, 2);
  bus.write(kDxr, 0x40);
  bus.write(kMdr, kIrs | kMst | kTrx | kStt | kStp);
  run_until(now() + 100 * kBit * 42'000);
  EXPECT_EQ(s.decoder.log, "SWw");
  for (const unsigned lane : {1u, 2u, 3u}) bus.write(kDxr + lane, 0x77, 1);  // of which none is the data
  run_until(now() + 20 * kBit * 42'000);
  EXPECT_EQ(s.decoder.log, "SWw");
  const std::uint64_t k = next_edge();
  bus.write(kDxr, 0x99);
  run_until(edge(k + 9 * kBit));
  EXPECT_EQ(s.decoder.regs[0x40], 0x99);
  EXPECT_EQ(s.decoder.last, edge(k + 9 * kBit));
  ASSERT_TRUE(poll(kScd));
}

TEST_F(I2cTest, AnAddressWithoutDeviceGivesNackAndStpFreesTheBus) {
  bus.write(kSar, 0x33);
  write_bytes({0x00}, kStp);
  ASSERT_TRUE(poll(kNack));
  EXPECT_EQ(bus.read(kStr) & kBb, kBb);
  bus.write(kMdr, bus.read(kMdr) | kStp);
  ASSERT_TRUE(poll(kScd));
  EXPECT_EQ(bus.read(kStr) & kBb, 0u);
  EXPECT_EQ(s.decoder.log, "");
}

TEST_F(I2cTest, RefusedByteGivesNack) {
  write_bytes({0x10, 0xEE}, kStp);
  ASSERT_TRUE(poll(kNack));
  EXPECT_EQ(s.decoder.log, "SWww");
  bus.write(kMdr, bus.read(kMdr) | kStp);
  ASSERT_TRUE(poll(kScd));
  EXPECT_EQ(s.decoder.log, "SWwwP");
}

TEST_F(I2cTest, ZeroLengthProbeInRepeatModeAsLinuxDoes) {
  bus.write(kCnt, 0);
  bus.write(kMdr, kIrs | kMst | kTrx | kRm | kStt);
  ASSERT_TRUE(poll(kArdy));
  bus.write(kMdr, bus.read(kMdr) | kStp);
  ASSERT_TRUE(poll(kScd));
  EXPECT_EQ(s.decoder.log, "SWP");
}

TEST_F(I2cTest, InterruptDrivenWriteAsLinuxDoes) {
  bus.write(kImr, kScd | kArdy | kNack | 1);
  const std::vector<std::uint8_t> bytes = {0x20, 0xA1, 0xA2};
  std::size_t sent = 0;
  bus.write(kCnt, 3);
  bus.write(kImr, bus.read(kImr) | kXrdy);
  bus.write(kMdr, kIrs | kMst | kTrx);
  bus.write(kDxr, bytes[sent++]);
  bus.write(kMdr, kIrs | kMst | kTrx | kStt | kStp);
  EXPECT_FALSE(s.irq.read());
  bool complete = false;
  for (int n = 0; n < 2000 && !complete; ++n) {
    run_until(now() + kPsPerUs);
    if (!s.irq.read()) continue;
    while (const std::uint32_t vector = bus.read(kIvr)) {
      if (vector == 5) {
        if (sent < bytes.size())
          bus.write(kDxr, bytes[sent++]);
        else
          bus.write(kImr, bus.read(kImr) & ~kXrdy);
      } else {
        ASSERT_EQ(vector, 6u);
        complete = true;
      }
    }
    EXPECT_FALSE(s.irq.read());
  }
  EXPECT_TRUE(complete);
  EXPECT_EQ(s.decoder.regs[0x20], 0xA1);
  EXPECT_EQ(s.decoder.regs[0x21], 0xA2);
  EXPECT_EQ(s.decoder.log, "SWwwwP");
}

TEST_F(I2cTest, EmptyDataRegisterInterruptsFromStartToTheLastByteOnly) {
  bus.write(kImr, kXrdy);
  EXPECT_FALSE(s.irq.read());
  EXPECT_EQ(bus.read(kIvr), 0u);
  EXPECT_EQ(bus.read(kStr) & kXrdy, kXrdy);  // the flag itself is there for who polls
  bus.write(kCnt, 2);
  bus.write(kMdr, kIrs | kMst | kTrx);  // no START yet
  EXPECT_FALSE(s.irq.read());
  bus.write(kMdr, kIrs | kMst | kTrx | kStt);  // nothing loaded
  EXPECT_TRUE(s.irq.read());
  EXPECT_EQ(bus.read(kIvr), 5u);
  bus.write(kDxr, 0x30);
  EXPECT_FALSE(s.irq.read());
  run_until(now() + 12 * kBit * 42'000);  // address, then the byte begins
  EXPECT_TRUE(s.irq.read());
  bus.write(kDxr, 0x77);
  ASSERT_TRUE(poll(kArdy));  // held without STOP, nothing left to send
  EXPECT_EQ(bus.read(kStr) & kXrdy, kXrdy);
  EXPECT_FALSE(s.irq.read());
  EXPECT_EQ(s.decoder.regs[0x30], 0x77);
  bus.write(kCnt, 1);  // a reader has nothing to send either
  bus.write(kMdr, kIrs | kMst | kStt | kStp);
  run_until(now() + 15 * kBit * 42'000);
  EXPECT_FALSE(s.irq.read());
  ASSERT_TRUE(poll(kRrdy));
  bus.read(kDrr);
  ASSERT_TRUE(poll(kScd));
  EXPECT_FALSE(s.irq.read());
}

TEST_F(I2cTest, VectorReadLeavesTheReceivedByteToItsReader) {
  s.decoder.regs = {7};
  s.decoder.pointer = 0;
  bus.write(kImr, kRrdy);
  bus.write(kCnt, 1);
  bus.write(kMdr, kIrs | kMst | kStt | kStp);
  ASSERT_TRUE(poll(kRrdy));
  EXPECT_EQ(bus.read(kIvr), 4u);
  EXPECT_EQ(bus.read(kStr) & kRrdy, kRrdy);
  EXPECT_TRUE(s.irq.read());
  EXPECT_EQ(bus.read(kDrr), 7u);
  EXPECT_EQ(bus.read(kStr) & kRrdy, 0u);
  EXPECT_FALSE(s.irq.read());
}

TEST_F(I2cTest, ACountOfZeroIs65536Bytes) {
  bus.write(kMdr, 0);
  bus.write(kPsc, 0);
  bus.write(kClkl, 0);
  bus.write(kClkh, 0);  // a bit is 14 clocks, a byte 126: 5.25 us
  bus.write(kMdr, kIrs);
  bus.write(kCnt, 0);
  bus.write(kMdr, kIrs | kMst | kStt | kStp);
  std::uint32_t bytes = 0;
  for (int idle = 0; idle < 20 && bytes <= 65536;) {
    run_until(now() + 5 * kPsPerUs);
    const std::uint32_t status = bus.read(kStr);
    if (status & kRrdy) {
      bus.read(kDrr);
      ++bytes;
      idle = 0;
    } else {
      ++idle;
    }
    if (status & kScd) break;
  }
  EXPECT_EQ(bytes, 65536u);
}

TEST_F(I2cTest, NackmodEndsACountedReadWithTheNextByte) {
  s.decoder.regs = {1, 2, 3, 4, 5};
  s.decoder.pointer = 0;
  bus.write(kCnt, 5);
  bus.write(kMdr, kIrs | kMst | kStt | kStp);
  ASSERT_TRUE(poll(kRrdy));
  bus.write(kMdr, bus.read(kMdr) | 0x8000);
  EXPECT_EQ(bus.read(kDrr), 1u);
  ASSERT_TRUE(poll(kRrdy));
  EXPECT_EQ(bus.read(kDrr), 2u);
  ASSERT_TRUE(poll(kScd));
  EXPECT_EQ(s.decoder.log, "SRrrP");
  EXPECT_EQ(bus.read(kStr) & 0x2000, 0x2000u);  // NACKSNT
}

TEST_F(I2cTest, ARepeatingTransmitterStopsOnlyWhenNothingIsLoaded) {
  bus.write(kDxr, 0x50);
  bus.write(kMdr, kIrs | kMst | kTrx | kRm | kStt | kStp);
  for (std::uint32_t byte : {0x61u, 0x62u}) {
    ASSERT_TRUE(poll(kXrdy));
    bus.write(kDxr, byte);
  }
  ASSERT_TRUE(poll(kScd));
  EXPECT_EQ(s.decoder.log, "SWwwwP");
  EXPECT_EQ(s.decoder.regs[0x50], 0x61);
  EXPECT_EQ(s.decoder.regs[0x51], 0x62);
}

TEST_F(I2cTest, ResetInMidTransferFreesTheBus) {
  write_bytes({0x10}, 0);
  ASSERT_TRUE(poll(kArdy));
  bus.write(kMdr, 0);
  EXPECT_EQ(bus.read(kStr), 0x410u);
  EXPECT_EQ(s.decoder.log, "SWwP");
  bus.write(kMdr, kIrs);
  bus.write(kMdr, 0);
  EXPECT_EQ(s.decoder.log, "SWwP") << "nothing was under way";
}

}  // namespace
}  // namespace fovea::periph

FOVEA_SC_TEST_MAIN
