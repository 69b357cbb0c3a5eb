// Connections inside the chip: timers to interrupts, ARM_INTMUX, watchdog to reset, wait states of
// internal RAM.
#include <gtest/gtest.h>

#include <systemc>

#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

constexpr std::uint32_t kPrd12 = 0x18, kPrd34 = 0x1C, kTcr = 0x20, kTgcr = 0x24, kWdtcr = 0x28;

/// A board whose core loops; registers are written by hand.
struct Chip {
  Rig rig{PROGRAM_DIR "/idle_loop.elf"};
  soc::Dm365& soc;
  Chip() : soc(rig.build().dm365) { rig.advance(kPsPerUs); }
  static void write(RegBank& regs, std::uint32_t offset, std::uint32_t word) {
    ASSERT_EQ(regs.write(offset, 4, word), Access::kOk);
  }
  void enable(unsigned lpsc) {
    write(soc.psc.regs, 0xA00 + 4 * lpsc, 0x103);
    write(soc.psc.regs, 0x120, 1);
    rig.advance(5 * kPsPerUs);
  }
  /// Interrupts that are pending after the lower, then after the upper half of this timer alone has
  /// run out once.
  using Halves = std::pair<std::uint64_t, std::uint64_t>;
  Halves pending_after(unsigned timer) {
    const std::uint64_t lower = pending_after(timer, 1u << 6);
    return {lower, pending_after(timer, 1u << 22)};
  }
  std::uint64_t pending_after(unsigned timer, std::uint32_t tcr) {
    for (const std::uint32_t status : {0x08u, 0x0Cu}) write(soc.aintc.regs.regs, status, ~0u);
    RegBank& t = soc.timers[timer]->regs;
    write(t, kTcr, 0);
    write(t, kTgcr, 0);
    write(t, 0x10, 0);
    write(t, 0x14, 0);
    write(t, kPrd12, 20);
    write(t, kPrd34, 30);
    write(t, kTgcr, 7);  // two halves, out of reset
    write(t, kTcr, tcr);
    rig.advance(10 * kPsPerUs);
    return soc.aintc.core().pending();
  }
};

constexpr std::uint64_t bits(std::initializer_list<unsigned> numbers) {
  std::uint64_t out = 0;
  for (const unsigned n : numbers) out |= std::uint64_t{1} << n;
  return out;
}

TEST(ChipTest, EachTimerHasItsGateAndItsInterrupts) {
  Chip c;
  using Halves = Chip::Halves;
  const Halves none{0, 0};
  const auto arm_intmux = [&](std::uint32_t word) {
    Chip::write(c.soc.system.regs, 0x18, word);
    c.rig.advance(kPsPerUs);
  };
  // TIMER0 to TIMER2 are on out of reset, the others are gated by LPSC 5 and 17.
  EXPECT_EQ(c.pending_after(0), Halves(bits({32}), bits({33})));
  EXPECT_EQ(c.pending_after(1), Halves(bits({34}), bits({35})));
  EXPECT_EQ(c.pending_after(2), Halves(0, bits({14})));  // 13 is RTO's
  EXPECT_EQ(c.pending_after(3), none);
  EXPECT_EQ(c.pending_after(4), none);
  c.enable(5);
  EXPECT_EQ(c.pending_after(3), Halves(bits({15}), bits({22})));
  EXPECT_EQ(c.pending_after(4), none);
  c.enable(17);
  EXPECT_EQ(c.pending_after(4), none);  // 38 and 28 are PWM2's and PWM3's
  arm_intmux(1u << 1);
  EXPECT_EQ(c.pending_after(2), Halves(bits({13}), bits({14})));
  EXPECT_EQ(c.pending_after(4), none);
  arm_intmux(1u << 12);
  EXPECT_EQ(c.pending_after(2), Halves(0, bits({14})));
  EXPECT_EQ(c.pending_after(4), Halves(bits({38}), 0));
  arm_intmux(1u << 9);
  EXPECT_EQ(c.pending_after(4), Halves(0, bits({28})));
}

TEST(ChipTest, ArmIntmuxTakesAPinsInterruptAwayAndSaysWhatIsNotModelled) {
  Chip c;
  auto& notes = c.rig.diagnostics;
  const auto pending_after_rise_of = [&](unsigned pin) {
    c.soc.gpio.set_pin(pin, false);
    c.rig.advance(kPsPerUs);
    Chip::write(c.soc.aintc.regs.regs, 0x0C, ~0u);
    c.soc.gpio.set_pin(pin, true);
    c.rig.advance(kPsPerUs);
    return c.soc.aintc.core().pending();
  };
  c.enable(26);
  Chip::write(c.soc.gpio.regs, 0x08, 1);
  Chip::write(c.soc.gpio.regs, 0x24, 0xFFFF);  // rising edges
  for (unsigned pin = 0; pin < 16; ++pin)
    EXPECT_EQ(pending_after_rise_of(pin), bits({44 + pin})) << pin;
  notes.clear();
  Chip::write(c.soc.system.regs, 0x18, 1u << 15);  // EMAC's receive interrupt instead of GPIO9's
  c.rig.advance(kPsPerUs);
  EXPECT_EQ(pending_after_rise_of(9), 0u);
  EXPECT_EQ(pending_after_rise_of(10), bits({54}));
  ASSERT_EQ(notes.counts().size(), 1u);
  EXPECT_EQ(notes.counts().begin()->first.second,
            "ARM_INTMUX bit 15 gives interrupt 53 to EMAC_RXPULSE, which is silent here");
  EXPECT_EQ(notes.counts().begin()->first.first, Diagnostics::Kind::kNotModelled);
}

/// Each block once without its pins, once with them.
TEST(ChipTest, ABlockWhosePinsPinmuxGivesAwayIsWarnedOfOnce) {
  struct Use {
    const char* block;
    std::uint32_t pinmux3;
    const char* selection;
  };
  Chip c;
  auto& notes = c.rig.diagnostics;
  for (const unsigned lpsc : {18u, 19u, 20u}) c.enable(lpsc);
  const auto send = [&](periph::Uart16550& uart) {
    Chip::write(uart.regs, 0x30, 0x6001);
    Chip::write(uart.regs, 0x20, 1);
    Chip::write(uart.regs, 0x00, 'x');
    c.rig.advance(100 * kPsPerUs);
  };
  const auto start = [&] {
    Chip::write(c.soc.i2c.regs, 0x24, 0);
    Chip::write(c.soc.i2c.regs, 0x1C, 0x5D);
    Chip::write(c.soc.i2c.regs, 0x24, 1u << 5 | 1u << 10 | 1u << 13 | 1u << 7 | 1u << 9);
    c.rig.advance(100 * kPsPerUs);
  };
  for (const Use& use : {Use{"uart0", 1u << 19, "PINMUX3 bit 19 = 1"},
                         Use{"uart1", 2u << 15, "PINMUX3 bits 16:15 = 2"},
                         Use{"i2c", 2u << 21 | 2u << 23, "PINMUX3 bits 22:21 and 24:23 = 2"}}) {
    const std::string block = use.block;
    const auto act = [&] {
      if (block == "i2c")
        start();
      else
        send(block == "uart0" ? c.soc.uart0 : c.soc.uart1);
    };
    notes.clear();
    Chip::write(c.soc.system.regs, 0x0C, use.pinmux3);
    c.rig.advance(kPsPerUs);
    act();
    EXPECT_TRUE(notes.counts().empty()) << block;
    Chip::write(c.soc.system.regs, 0x0C, ~use.pinmux3);
    c.rig.advance(kPsPerUs);
    act();
    act();
    ASSERT_EQ(notes.counts().size(), 1u) << block;
    EXPECT_EQ(notes.counts().begin()->first.second,
              block + " is used, but PINMUX does not give it its pins (" + use.selection +
                  "): on the chip nothing would reach them");
    EXPECT_EQ(notes.counts().begin()->second, 1u);
  }
}

struct WatchdogTest : testing::Test {
  Chip c;
  board::Board& board = c.rig.board();
  void start(std::uint32_t period) {
    RegBank& t = c.soc.timers[2]->regs;
    Chip::write(t, kTgcr, 0xB);
    Chip::write(t, kPrd12, period);
    Chip::write(t, kTcr, 2u << 6);
    Chip::write(t, kWdtcr, 0xA5C6'4000);
    Chip::write(t, kWdtcr, 0xDA7E'4000);
  }
};

TEST_F(WatchdogTest, ItsExpiryAsksForAChipResetToTheClock) {
  const std::uint64_t edges = kernel_time() * 3 / 125'000;  // of 24 MHz; now is none of them
  start(24'000);
  unsigned told = 0;
  const Subscription resets = board.observe_chip_reset([&](const board::ChipReset& r) {
    ++told;
    EXPECT_EQ(r.at, kernel_time());
  });
  c.rig.run(10 * kPsPerMs);
  ASSERT_TRUE(board.chip_reset().has_value());
  EXPECT_EQ(board.chip_reset()->cause, "the watchdog expired");
  EXPECT_EQ(board.chip_reset()->at, (edges + 24'000) * 125'000 / 3);
  EXPECT_EQ(kernel_time(), board.chip_reset()->at);
  EXPECT_LT(board.chip_reset()->pc, 8u);  // the loop at 0
  EXPECT_EQ(told, 1u);
}

TEST_F(WatchdogTest, WithTimer2WdtOffItIsATimerLikeTheOthers) {
  Chip::write(c.soc.system.regs, 0x38, 0x03);
  c.rig.advance(kPsPerUs);
  start(24'000);
  c.rig.advance(3 * kPsPerMs);
  EXPECT_FALSE(board.chip_reset().has_value());
  EXPECT_EQ(c.soc.timers[2]->regs.wdtcr.wdflag.get(), 1u);
  Chip::write(c.soc.system.regs, 0x38, 0x13);
  c.rig.advance(3 * kPsPerMs);
  ASSERT_TRUE(board.chip_reset().has_value());
  // The pause ends only the time that was asked for; the caller may go on.
  const Picoseconds at = board.chip_reset()->at;
  EXPECT_EQ(kernel_time(), at);
  c.rig.advance(5 * kPsPerMs);
  EXPECT_EQ(kernel_time(), at + 5 * kPsPerMs);
}

TEST_F(WatchdogTest, TheTimersPinAsBootLoadersDriveItResetsTheChip) {
  RegBank& t = c.soc.timers[2]->regs;
  Chip::write(t, 0x08, 0x0002'0000);
  Chip::write(t, 0x0C, 0x0002'0002);
  c.rig.advance(kPsPerMs);
  ASSERT_TRUE(board.chip_reset().has_value());
  EXPECT_EQ(board.chip_reset()->cause,
            "the watchdog timer's pin was driven high, as boot loaders do");
}

/// A wait state adds a clock to each instruction that is fetched from internal RAM.
class WaitStatesTest : public testing::TestWithParam<bool> {};
TEST_P(WaitStatesTest, ArmWaitstCostsAClockAFetch) {
  Rig rig(PROGRAM_DIR "/wait_states.elf");
  if (GetParam()) rig.strict();
  auto& soc = rig.build().dm365;
  std::vector<Picoseconds> shown;
  const Subscription pins = soc.gpio.observe_outputs([&](unsigned bank, std::uint32_t out, Picoseconds at) {
    if (bank == 2 && out) shown.push_back(at);
  });
  rig.advance(2 * kPsPerMs);
  ASSERT_EQ(shown.size(), 12u);
  const auto sled = [&](unsigned n) {  // 400 instructions: the longer stretch less the shorter one
    const auto took = [&](unsigned i) { return static_cast<double>(shown[i + 1] - shown[i]); };
    return took(4 * n + 2) - took(4 * n);
  };
  const double clock = 1e12 / 24e6;
  EXPECT_NEAR(sled(0), 400 * clock, 2);
  EXPECT_NEAR(sled(1), 800 * clock, 2);
  EXPECT_NEAR(sled(2), 400 * clock, 2);
}
INSTANTIATE_TEST_SUITE_P(Sync, WaitStatesTest, testing::Bool(),
                         [](const auto& p) { return p.param ? "Strict" : "Default"; });

TEST(WaitStatesKeyTest, TheKeyComesOnTopOfTheRegister) {
  Rig rig(PROGRAM_DIR "/wait_states.elf");
  rig.set("cpu.tcm.wait_states", "2 cycles");
  auto& soc = rig.build().dm365;
  std::vector<Picoseconds> shown;
  const Subscription pins = soc.gpio.observe_outputs([&](unsigned bank, std::uint32_t out, Picoseconds at) {
    if (bank == 2 && out) shown.push_back(at);
  });
  rig.advance(4 * kPsPerMs);
  ASSERT_EQ(shown.size(), 12u);
  const auto took = [&](unsigned i) { return static_cast<double>(shown[i + 1] - shown[i]); };
  EXPECT_NEAR(took(2) - took(0), 1200 * 1e12 / 24e6, 2);
  EXPECT_NEAR(took(6) - took(4), 1600 * 1e12 / 24e6, 2);
}

}  // namespace
}  // namespace fovea::e2e
