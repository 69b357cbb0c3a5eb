// Pins, edges, and the interrupt lines of GPIO0 to GPIO15.
#include "model/periph/gpio.h"

#include <array>
#include <tuple>
#include <vector>

#include "tb/periph/bench.h"

namespace fovea::periph {
namespace {
using test::now;
using test::run_until;

constexpr std::uint32_t reg(unsigned bank, std::uint32_t offset) {
  return 0x10 + 0x28 * bank + offset;
}
enum : std::uint32_t {
  kDir = 0x0,
  kOut = 0x4,
  kSet = 0x8,
  kClr = 0xC,
  kIn = 0x10,
  kSetRis = 0x14,
  kClrRis = 0x18,
  kSetFal = 0x1C,
  kClrFal = 0x20,
  kIntstat = 0x24
};

struct System {
  ClockSignal clk{"clk", Frequency(121'500'000)};
  Gpio gpio{"gpio"};
  sc_core::sc_signal<bool> irq0{"irq0"}, irq5{"irq5"};
  Gpio fresh{"fresh"};  // with a pin that is high from the start
  test::Bus bus{"bus"}, fresh_bus{"fresh_bus"};
  test::Probe probe0{"probe0"}, probe5{"probe5"};
  std::vector<std::tuple<unsigned, std::uint32_t, Picoseconds>> outputs;
  Subscription watching;
  System() {
    gpio.clk(clk);
    gpio.irq[0](irq0);
    gpio.irq[5](irq5);
    probe0.in(irq0);
    probe5.in(irq5);
    bus.socket.bind(gpio.reg_socket);
    watching = gpio.observe_outputs([this](unsigned bank, std::uint32_t out, Picoseconds t) {
      outputs.emplace_back(bank, out, t);
    });
    gpio.set_pin(97, true);  // a DIP switch, set before the run starts
    fresh.clk(clk);
    fresh_bus.socket.bind(fresh.reg_socket);
    fresh.set_pin(5, true);
  }
};

struct GpioTest : testing::Test {
  static System& system() {
    static System* s = new System;
    return *s;
  }
  System& s = system();
  test::Bus& bus = s.bus;
  void SetUp() override {
    run_until(now() + 1'000'000);
    bus.write(0x08, 0);
    for (unsigned b = 0; b < kGpioBanks; ++b) {
      bus.write(reg(b, kClrRis), ~0u);
      bus.write(reg(b, kClrFal), ~0u);
      bus.write(reg(b, kClr), ~0u);
      bus.write(reg(b, kDir), ~0u);
      bus.write(reg(b, kIntstat), ~0u);
    }
    s.outputs.clear();
    s.probe0.rises = s.probe5.rises = 0;
  }
};

// Registers of any block: what an observer is told of whole words, parts of words and holes.
TEST_F(GpioTest, AnObserverSeesWhatWasReadAndWritten) {
  struct Seen : RegisterObserver {
    std::vector<RegisterAccess> all;
    void accessed(const RegisterAccess& a) override { all.push_back(a); }
  } seen, longer;
  bus.write(reg(1, kOut), 0x1234'5678);
  const Subscription to_the_end = s.gpio.observe(longer);
  Subscription observing = s.gpio.observe(seen);
  EXPECT_EQ(bus.read(reg(1, kOut)), 0x1234'5678u);
  EXPECT_EQ(bus.read(reg(1, kOut) + 2, 2), 0x1234u);
  bus.write(reg(1, kOut) + 3, 0xFF, 1);
  EXPECT_EQ(bus.read(0xF00), 0u) << "a hole";
  observing.reset();
  EXPECT_EQ(bus.read(reg(1, kOut)), 0xFF34'5678u);
  ASSERT_EQ(seen.all.size(), 4u);
  ASSERT_EQ(longer.all.size(), 5u) << "the end of one leaves the other";
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(std::tuple(longer.all[i].offset, longer.all[i].value), std::tuple(seen.all[i].offset, seen.all[i].value));
  const std::array<std::tuple<std::uint32_t, unsigned, bool, std::uint32_t>, 4> expected{
      {{reg(1, kOut), 4, false, 0x1234'5678},
       {reg(1, kOut) + 2, 2, false, 0x1234},
       {reg(1, kOut) + 3, 1, true, 0xFF},
       {0xF00, 4, false, 0}}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const RegisterAccess& a = seen.all[i];
    EXPECT_EQ(std::tuple(a.offset, a.bytes, a.write, a.value), expected[i]) << i;
    EXPECT_FALSE(a.gated);
  }
}

TEST_F(GpioTest, InputsReadTheBoardAndSwitchesHoldFromTheStart) {
  EXPECT_EQ(bus.read(reg(3, kIn)), 2u);  // pin 97
  s.gpio.set_pin(97, false);
  s.gpio.set_pin(40, true);
  EXPECT_EQ(bus.read(reg(3, kIn)), 0u);
  EXPECT_EQ(bus.read(reg(1, kIn)), 1u << 8);
  s.gpio.set_pin(40, false);
}

// What the parts beside the chip see: the level on the wire, whether the chip or the board drives it.
TEST_F(GpioTest, APinHasTheLevelOfWhatDrivesIt) {
  s.gpio.set_pin(40, true);
  for (const unsigned pin : {8u, 39u, 41u, 72u}) EXPECT_FALSE(s.gpio.pin(pin)) << pin;
  EXPECT_TRUE(s.gpio.pin(40));
  bus.write(reg(1, kDir), ~(1u << 8));
  EXPECT_FALSE(s.gpio.pin(40)) << "an output, which is low";
  bus.write(reg(1, kSet), 1u << 8);
  s.gpio.set_pin(40, false);
  EXPECT_TRUE(s.gpio.pin(40));
}

TEST_F(GpioTest, OutputsReachTheObserverOnceAChangeWithTheirTime) {
  bus.write(reg(2, kSet), 0x50);
  EXPECT_TRUE(s.outputs.empty());  // still inputs
  bus.write(reg(2, kDir), ~0x70u);
  ASSERT_EQ(s.outputs.size(), 1u);
  EXPECT_EQ(s.outputs[0], std::make_tuple(2u, 0x50u, now()));
  run_until(now() + 777);
  bus.write(reg(2, kSet), 0x20);
  bus.write(reg(2, kSet), 0x20);  // no change
  bus.write(reg(2, kClr), 0x50);
  ASSERT_EQ(s.outputs.size(), 3u);
  EXPECT_EQ(s.outputs[1], std::make_tuple(2u, 0x70u, now()));
  EXPECT_EQ(s.outputs[2], std::make_tuple(2u, 0x20u, now()));
  EXPECT_EQ(bus.read(reg(2, kOut)), 0x20u);
  EXPECT_EQ(bus.read(reg(2, kSet)), 0x20u);
  EXPECT_EQ(bus.read(reg(2, kIn)) & 0x70, 0x20u);  // an output reads its own level
}

TEST_F(GpioTest, RisingEdgePulsesTheLineForOneClock) {
  bus.write(0x08, 1);
  bus.write(reg(0, kSetRis), 1u << 5);
  run_until(now() + 5'000'000);
  const Picoseconds at = now();
  s.gpio.set_pin(5, true);
  run_until(at + 100'000);
  EXPECT_EQ(s.probe5.rises, 1u);
  EXPECT_EQ(s.probe5.last_rise, at);
  EXPECT_GT(s.probe5.last_fall, at);
  EXPECT_LE(s.probe5.last_fall, at + 8'231);  // one period of 121.5 MHz, rounded up
  EXPECT_EQ(bus.read(reg(0, kIntstat)), 1u << 5);
  s.gpio.set_pin(5, false);  // falling is not selected
  run_until(now() + 100'000);
  EXPECT_EQ(s.probe5.rises, 1u);
  bus.write(reg(0, kIntstat), 1u << 5);
  EXPECT_EQ(bus.read(reg(0, kIntstat)), 0u);
}

TEST_F(GpioTest, FallingEdgeAndDisableRegistersWork) {
  bus.write(0x08, 1);
  bus.write(reg(0, kSetFal), 1);
  s.gpio.set_pin(0, true);
  run_until(now() + 100'000);
  EXPECT_EQ(s.probe0.rises, 0u);
  s.gpio.set_pin(0, false);
  run_until(now() + 100'000);
  EXPECT_EQ(s.probe0.rises, 1u);
  EXPECT_EQ(bus.read(reg(0, kClrFal)), 1u);
  bus.write(reg(0, kClrFal), 1);
  s.gpio.set_pin(0, true);
  s.gpio.set_pin(0, false);
  run_until(now() + 100'000);
  EXPECT_EQ(s.probe0.rises, 1u);
}

TEST_F(GpioTest, ALevelFromBeforeTheStartIsNoEdgeWhenAnotherPinChanges) {
  s.fresh_bus.write(reg(0, kSetRis), 1u << 5 | 1u << 6);
  s.gpio.set_pin(6, false);
  s.fresh.set_pin(6, true);
  EXPECT_EQ(s.fresh_bus.read(reg(0, kIntstat)), 1u << 6);
}

/// Every pin is an input again and no edge is watched for, in the first bank and in the last.
TEST_F(GpioTest, AResetMakesInputsOfAllPins) {
  for (const unsigned bank : {0u, kGpioBanks - 1}) {
    bus.write(reg(bank, kDir), ~2u);
    bus.write(reg(bank, kSet), 2);
    bus.write(reg(bank, kSetRis), 1);
    bus.write(reg(bank, kSetFal), 1);
  }
  bus.write(0x08, 1);
  run_until(now() + 1'000'000);
  s.outputs.clear();
  s.gpio.reset(ResetKind::kWarm);
  run_until(now() + 1'000'000);
  ASSERT_EQ(s.outputs.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(std::get<0>(s.outputs[i]), i == 0 ? 0u : kGpioBanks - 1);
    EXPECT_EQ(std::get<1>(s.outputs[i]), 0u);
  }
  bus.write(0x08, 1);
  for (const unsigned bank : {0u, kGpioBanks - 1}) {
    EXPECT_EQ(bus.read(reg(bank, kDir)), ~0u) << bank;
    s.gpio.set_pin(32 * bank, true);
    run_until(now() + 1'000'000);
    s.gpio.set_pin(32 * bank, false);
    run_until(now() + 1'000'000);
    EXPECT_EQ(bus.read(reg(bank, kSetRis)), 0u) << bank;
    EXPECT_EQ(bus.read(reg(bank, kIntstat)), 0u) << bank;
  }
  EXPECT_EQ(s.probe0.rises, 0u);
}

TEST_F(GpioTest, BintenGatesTheLineButNotTheStatus) {
  bus.write(reg(0, kSetRis), 1);
  s.gpio.set_pin(0, true);
  run_until(now() + 100'000);
  EXPECT_EQ(s.probe0.rises, 0u);
  EXPECT_EQ(bus.read(reg(0, kIntstat)), 1u);
  s.gpio.set_pin(0, false);
}

}  // namespace
}  // namespace fovea::periph

FOVEA_SC_TEST_MAIN
