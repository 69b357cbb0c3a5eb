// Timer64 with the AINTC: times of counts, matches and interrupts.
#include <random>
#include <set>
#include <string>

#include "model/periph/aintc.h"
#include "model/periph/timer64.h"
#include "tb/own_diagnostics.h"
#include "tb/periph/bench.h"

namespace fovea::periph {
namespace {
using test::now;
using test::run_until;

constexpr unsigned kMhz24 = 24'000'000;
/// Edge k of 24 MHz: 125000/3 ps apart, rounded down from the start.
Picoseconds edge(std::uint64_t k) { return k * 125'000 / 3; }

struct System {
  OwnDiagnostics diagnostics;
  ClockSignal clk{"clk", Frequency(kMhz24)};
  sc_core::sc_signal<bool> gate{"gate", true};
  sc_core::sc_signal<bool> tint12{"tint12"}, tint34{"tint34"}, expired{"expired"};
  sc_core::sc_vector<sc_core::sc_signal<bool>> sources{"sources", kInterruptCount};
  sc_core::sc_signal<bool> irq{"irq"}, fiq{"fiq"};
  Timer64 timer{"timer"};
  AintcParams params;
  Aintc aintc{"aintc", params};
  // An expired watchdog stays so, and an armed one is no timer any more: each test of one has its own.
  Timer64 watchdog{"watchdog"}, pin_timer{"pin_timer"}, lock_timer{"lock_timer"}, served_timer{"served_timer"};
  sc_core::sc_signal<bool> bitten{"bitten"}, pin_reset{"pin_reset"}, lock_expired{"lock_expired"},
      served_expired{"served_expired"};
  test::Bus bus{"bus"}, aintc_bus{"aintc_bus"}, wdt_bus{"wdt_bus"}, pin_bus{"pin_bus"}, lock_bus{"lock_bus"},
      served_bus{"served_bus"};
  test::Probe probe12{"probe12"}, probe34{"probe34"}, probe_irq{"probe_irq"};
  System() {
    timer.clk(clk);
    timer.lpsc(gate);
    timer.tint12(tint12);
    timer.tint34(tint34);
    timer.expired(expired);
    bus.socket.bind(timer.reg_socket);
    aintc_bus.socket.bind(aintc.reg_socket);
    for (unsigned n = 0; n < kInterruptCount; ++n)
      if (n == 32)
        aintc.source[n](tint12);
      else if (n == 33)
        aintc.source[n](tint34);
      else
        aintc.source[n](sources[n]);
    watchdog.clk(clk);
    watchdog.expired(bitten);
    wdt_bus.socket.bind(watchdog.reg_socket);
    served_timer.clk(clk);
    served_timer.expired(served_expired);
    served_bus.socket.bind(served_timer.reg_socket);
    lock_timer.clk(clk);
    lock_timer.expired(lock_expired);
    lock_bus.socket.bind(lock_timer.reg_socket);
    pin_timer.clk(clk);
    pin_timer.expired(pin_reset);
    pin_bus.socket.bind(pin_timer.reg_socket);
    aintc.irq(irq);
    aintc.fiq(fiq);
    probe12.in(tint12);
    probe34.in(tint34);
    probe_irq.in(irq);
  }
};

enum : std::uint32_t {
  kTim12 = 0x10,
  kTim34 = 0x14,
  kPrd12 = 0x18,
  kPrd34 = 0x1C,
  kTcr = 0x20,
  kTgcr = 0x24,
  kWdtcr = 0x28,
  kRel12 = 0x34,
  kRel34 = 0x38,
  kCap12 = 0x3C,
  kCap34 = 0x40,
  kStat = 0x44
};

struct TimerTest : testing::Test {
  static System& system() {
    static System* s = new System;
    return *s;
  }
  System& s = system();
  test::Bus& bus = s.bus;

  void SetUp() override {
    run_until(now());
    bus.write(kTcr, 0);
    bus.write(kTgcr, 0);
    for (std::uint32_t r : {kTim12, kTim34, kPrd12, kPrd34}) bus.write(r, 0);
    run_until(now() + 1'000'000);  // ends any pulse
    s.probe12.rises = s.probe12.falls = s.probe34.rises = s.probe34.falls = 0;
    s.probe_irq.rises = 0;
  }
  /// The number of edges up to now: counting starts with the next one.
  std::uint64_t edges() const {
    std::uint64_t k = now() * 3 / 125'000;
    while (edge(k + 1) <= now()) ++k;
    return k;
  }
};

TEST_F(TimerTest, OneShotExpiresAtTheExactPicosecond) {
  bus.write(kPrd12, 1000);
  bus.write(kTgcr, 0x5);  // unchained, TIM12 out of reset
  const std::uint64_t k = edges();
  bus.write(kTcr, 1u << 6);
  run_until(edge(k + 999));
  EXPECT_EQ(bus.read(kTim12), 999u);
  run_until(edge(k + 1000) - 1);
  EXPECT_EQ(bus.read(kTim12), 999u);
  EXPECT_FALSE(s.tint12.read());
  run_until(edge(k + 1000));
  EXPECT_EQ(bus.read(kTim12), 1000u);
  EXPECT_TRUE(s.tint12.read());
  EXPECT_EQ(s.probe12.last_rise, edge(k + 1000));
  EXPECT_EQ(bus.read(kStat) & 2, 2u);
  run_until(edge(k + 1001));
  EXPECT_FALSE(s.tint12.read());
  run_until(edge(k + 5000));
  EXPECT_EQ(s.probe12.rises, 1u);
  EXPECT_EQ(s.probe12.last_fall, edge(k + 1001));
}

TEST_F(TimerTest, OneMoreInThePeriodIsOneClockLater) {
  Picoseconds at[2];
  std::uint64_t k[2];
  for (unsigned n = 0; n < 2; ++n) {
    bus.write(kTim12, 0);
    bus.write(kPrd12, 500 + n);
    bus.write(kTgcr, 0x5);
    k[n] = edges();
    bus.write(kTcr, 1u << 6);
    run_until(now() + 30'000'000);
    at[n] = s.probe12.last_rise;
    bus.write(kTcr, 0);
  }
  EXPECT_EQ(at[0], edge(k[0] + 500));
  EXPECT_EQ(at[1], edge(k[1] + 501));
}

TEST_F(TimerTest, PeriodicTimerDoesNotDrift) {
  bus.write(kPrd34, 6);  // every 7 clocks
  bus.write(kTgcr, 0x6);
  const std::uint64_t k = edges();
  bus.write(kTcr, 2u << 22);
  run_until(edge(k + 7 * 1000));
  EXPECT_EQ(s.probe34.rises, 1000u);  // matches at 6, 13, ..., 6999
  EXPECT_EQ(s.probe34.last_rise, edge(k + 6999));
  EXPECT_EQ(s.probe12.rises, 0u);
}

TEST_F(TimerTest, HalvesRunIndependentlyAndLinuxStyleRestartKeepsTheOther) {
  bus.write(kPrd34, 0xFFFFFFFF);
  bus.write(kTgcr, 0x7);
  const std::uint64_t k = edges();
  bus.write(kTcr, 2u << 22 | 1u << 6);
  run_until(edge(k + 40));
  bus.write(kTcr, 2u << 22);  // stop TIM12 only
  bus.write(kTim12, 0);
  bus.write(kPrd12, 100);
  bus.write(kTcr, 2u << 22 | 1u << 6);
  run_until(edge(k + 140));
  EXPECT_EQ(bus.read(kTim34), 140u);
  EXPECT_EQ(s.probe12.last_rise, edge(k + 140));
}

TEST_F(TimerTest, SixtyFourBitModeCarriesAndLatchesTheUpperHalf) {
  bus.write(kTim12, 0xFFFFFFF0);
  bus.write(kTim34, 2);
  bus.write(kPrd12, 5);
  bus.write(kPrd34, 3);
  bus.write(kTgcr, 0x3);
  const std::uint64_t k = edges();
  bus.write(kTcr, 1u << 6);
  run_until(edge(k + 15));
  EXPECT_EQ(bus.read(kTim12), 0xFFFFFFFFu);
  run_until(edge(k + 16));
  EXPECT_EQ(bus.read(kTim34), 2u);  // as latched with the lower half
  EXPECT_EQ(bus.read(kTim34), 3u);
  run_until(edge(k + 100));
  EXPECT_EQ(s.probe12.last_rise, edge(k + 21));
}

TEST_F(TimerTest, SixtyFourBitModeNeedsBothHalvesOutOfResetAndEnamode12) {
  struct Case {
    std::uint32_t tgcr, tcr;
    bool counts;
  };
  for (const Case& c : {Case{0x1, 2u << 6, false}, Case{0x2, 2u << 6, false}, Case{0x3, 0, false},
                        Case{0x3, 2u << 22, false}, Case{0x3, 2u << 6, true}}) {
    SetUp();
    bus.write(kPrd12, 0xFFFFFFFF);
    bus.write(kPrd34, 0xFFFFFFFF);
    bus.write(kTgcr, c.tgcr);
    bus.write(kTcr, c.tcr);
    run_until(now() + 1'000'000);
    EXPECT_EQ(bus.read(kTim12) > 0, c.counts) << c.tgcr << " " << c.tcr;
  }
}

TEST_F(TimerTest, ChainedModeDividesByPrd34PlusOne) {
  bus.write(kPrd34, 9);
  bus.write(kPrd12, 4);
  bus.write(kTgcr, 0xF);
  const std::uint64_t k = edges();
  bus.write(kTcr, 1u << 6);
  run_until(edge(k + 23));
  EXPECT_EQ(bus.read(kTim12), 2u);
  EXPECT_EQ(bus.read(kTim34), 3u);
  run_until(edge(k + 100));
  EXPECT_EQ(s.probe12.last_rise, edge(k + 40));
}

TEST_F(TimerTest, Psc34PrescalesTim34) {
  bus.write(kPrd34, 10);
  bus.write(kTgcr, 0x6 | 3u << 8);
  const std::uint64_t k = edges();
  bus.write(kTcr, 1u << 22);
  run_until(edge(k + 100));
  EXPECT_EQ(s.probe34.last_rise, edge(k + 40));
}

TEST_F(TimerTest, ReloadModeTakesTheNextPeriodAfterTheMatch) {
  bus.write(kPrd12, 10);
  bus.write(kRel12, 20);
  bus.write(kTgcr, 0x5);
  const std::uint64_t k = edges();
  bus.write(kTcr, 3u << 6);
  run_until(edge(k + 12));
  EXPECT_EQ(s.probe12.last_rise, edge(k + 10));
  EXPECT_EQ(bus.read(kPrd12), 20u);
  run_until(edge(k + 40));
  EXPECT_EQ(s.probe12.last_rise, edge(k + 11 + 20));  // 0 at k + 11
}

TEST_F(TimerTest, ReloadOfASixtyFourBitTimerTakesBothHalves) {
  bus.write(kPrd12, 10);
  bus.write(kRel12, 20);
  bus.write(kRel34, 7);
  bus.write(kTgcr, 0x3);
  const std::uint64_t k = edges();
  bus.write(kTcr, 3u << 6);
  run_until(edge(k + 10));
  EXPECT_EQ(bus.read(kPrd34), 0u);  // comes with the count of 0
  run_until(edge(k + 11));
  EXPECT_EQ(s.probe12.last_rise, edge(k + 10));
  EXPECT_EQ(bus.read(kPrd12), 20u);
  EXPECT_EQ(bus.read(kPrd34), 7u);
  bus.write(kRel34, 0);
}

TEST_F(TimerTest, AWriteOfEitherHalfDropsTheLatchedUpperHalf) {
  for (const bool upper : {false, true}) {
    bus.write(kTcr, 0);
    bus.write(kTim12, 0xFFFFFFF0);
    bus.write(kTim34, 2);
    bus.write(kPrd12, 0);
    bus.write(kPrd34, 100);
    bus.write(kTgcr, 0x3);
    const std::uint64_t k = edges();
    bus.write(kTcr, 1u << 6);
    run_until(edge(k + 8));
    EXPECT_EQ(bus.read(kTim12), 0xFFFFFFF8u);  // latches 2
    run_until(edge(k + 20));
    bus.write(upper ? kTim34 : kTim12, upper ? 9 : 0x100);
    EXPECT_EQ(bus.read(kTim34), upper ? 9u : 3u);
  }
}

TEST_F(TimerTest, AMatchCapturesBothCounters) {
  bus.write(kPrd34, 0xFFFF);
  bus.write(kTgcr, 0x7);
  bus.write(kTcr, 2u << 22);
  const std::uint64_t k34 = edges();
  run_until(edge(k34 + 30));
  bus.write(kPrd12, 12);
  const std::uint64_t k12 = edges();
  bus.write(kTcr, 2u << 22 | 1u << 6);
  run_until(edge(k12 + 50));
  EXPECT_EQ(bus.read(kCap12), 12u);
  EXPECT_EQ(bus.read(kCap34), k12 + 12 - k34);
}

TEST_F(TimerTest, ATimerThatStartsAtItsPeriodMatchesAWholePeriodLater) {
  bus.write(kTim12, 10);
  bus.write(kPrd12, 10);
  bus.write(kTgcr, 0x5);
  const std::uint64_t k = edges();
  bus.write(kTcr, 2u << 6);
  run_until(edge(k + 11) - 1);
  EXPECT_EQ(s.probe12.rises, 0u);
  run_until(edge(k + 11));
  EXPECT_EQ(s.probe12.rises, 1u);
  EXPECT_EQ(s.probe12.last_rise, edge(k + 11));
}

TEST_F(TimerTest, AnEndedOneShotStaysSoWhateverPeriodIsWritten) {
  bus.write(kPrd12, 20);
  bus.write(kTgcr, 0x5);
  bus.write(kTcr, 1u << 6);
  run_until(now() + 2'000'000);
  EXPECT_EQ(s.probe12.rises, 1u);
  bus.write(kPrd12, 60);
  run_until(now() + 4'000'000);
  EXPECT_EQ(bus.read(kTim12), 20u);
  EXPECT_EQ(s.probe12.rises, 1u);
  bus.write(kTim12, 30);
  run_until(now() + 4'000'000);
  EXPECT_EQ(bus.read(kTim12), 30u);
  EXPECT_EQ(s.probe12.rises, 1u);
}

struct ChainedTimerTest : TimerTest {
  /// PRD34 9, PRD12 100; 23 ticks: TIM12 2, TIM34 3.
  std::uint64_t start() {
    bus.write(kPrd34, 9);
    bus.write(kPrd12, 100);
    bus.write(kTgcr, 0xF);
    const std::uint64_t k = edges();
    bus.write(kTcr, 2u << 6);
    run_until(edge(k + 23));
    EXPECT_EQ(bus.read(kTim12), 2u);
    EXPECT_EQ(bus.read(kTim34), 3u);
    return k + 23;
  }
};

TEST_F(ChainedTimerTest, AWriteOfTim34MovesThePrescaler) {
  const std::uint64_t k = start();
  bus.write(kTim34, 8);  // two ticks before the next count
  run_until(edge(k + 1));
  EXPECT_EQ(bus.read(kTim12), 2u);
  EXPECT_EQ(bus.read(kTim34), 9u);
  run_until(edge(k + 2));
  EXPECT_EQ(bus.read(kTim12), 3u);
  EXPECT_EQ(bus.read(kTim34), 0u);
}

TEST_F(ChainedTimerTest, Tim34KeepsItsPlaceWhileStopped) {
  const std::uint64_t k = start();
  bus.write(kTcr, 0);
  run_until(edge(k + 50));
  EXPECT_EQ(bus.read(kTim12), 2u);
  EXPECT_EQ(bus.read(kTim34), 3u);
  bus.write(kTcr, 2u << 6);
  run_until(edge(k + 56));
  EXPECT_EQ(bus.read(kTim12), 2u);
  run_until(edge(k + 57));
  EXPECT_EQ(bus.read(kTim12), 3u);
}

TEST_F(TimerTest, GatedClockStopsTheCountAndClosesTheRegisters) {
  bus.write(kPrd12, 0xFFFF);
  bus.write(kTgcr, 0x5);
  const std::uint64_t k = edges();
  bus.write(kTcr, 2u << 6);
  run_until(edge(k + 50));
  s.gate.write(false);
  run_until(now() + 1'000'000);
  EXPECT_EQ(bus.read(kTim12), 0u);  // no answer while gated
  s.gate.write(true);
  test::settle();
  const std::uint32_t resumed = bus.read(kTim12);
  EXPECT_GE(resumed, 50u);
  EXPECT_LE(resumed, 51u);  // the interrupted period ends with the restart
  const Picoseconds restart = now();
  run_until(restart + edge(10));
  EXPECT_EQ(bus.read(kTim12), resumed + 10);
}

struct Watcher : RegisterObserver {
  std::vector<RegisterAccess> seen;
  void accessed(const RegisterAccess& a) override { seen.push_back(a); }
};

TEST_F(TimerTest, WhoLooksOnSeesAccessesAndWarningsAreCounted) {
  auto& notes = s.diagnostics;
  const auto count = [&notes](const std::string& part) {
    std::uint64_t n = 0;
    for (const auto& [what, times] : notes.counts())
      if (what.second.find(part) != std::string::npos) n += times;
    return n;
  };
  notes.clear();
  Watcher watcher;
  Subscription watching = s.timer.observe(watcher);
  bus.write(kPrd12, 0x1234);
  EXPECT_EQ(bus.read(kPrd12, 2), 0x1234u);
  EXPECT_EQ(count("reserved bits"), 0u);
  bus.write(kTgcr, 0x8000'0000);
  bus.write(kTgcr, 0x8000'0000);
  bus.write(kTgcr + 3, 0x80, 1);
  bus.write(kTgcr, 0);
  EXPECT_EQ(count("1 written to reserved bits of TIMER64 TGCR"), 3u);
  s.gate.write(false);
  test::settle();
  bus.write(kPrd12, 7);
  s.gate.write(true);
  test::settle();
  EXPECT_EQ(count("while its clock is gated"), 1u);
  watching.reset();
  bus.read(kPrd12);
  ASSERT_EQ(watcher.seen.size(), 7u);
  EXPECT_EQ(watcher.seen[0].offset, kPrd12);
  EXPECT_EQ(watcher.seen[0].value, 0x1234u);
  EXPECT_TRUE(watcher.seen[0].write);
  EXPECT_FALSE(watcher.seen[1].write);
  EXPECT_EQ(watcher.seen[1].bytes, 2u);
  EXPECT_EQ(watcher.seen[1].value, 0x1234u);
  EXPECT_FALSE(watcher.seen[1].gated);
  EXPECT_TRUE(watcher.seen[6].gated);
  EXPECT_EQ(watcher.seen[6].value, 7u);
}

TEST_F(TimerTest, HalfTheClockIsTwiceTheTime) {
  bus.write(kPrd12, 100);
  bus.write(kTgcr, 0x5);
  s.clk.write(Frequency(12'000'000));
  test::settle();
  const Picoseconds start = now();  // an edge: the clock restarts with the change
  bus.write(kTcr, 1u << 6);
  run_until(start + 20'000'000);
  EXPECT_EQ(s.probe12.last_rise, start + 100 * 250'000 / 3);
  s.clk.write(Frequency(kMhz24));
  test::settle();
}

TEST(AintcPinTest, TimerPulseReachesThePinInTheSameInstantAndStaysUntilAcknowledged) {
  System& s = TimerTest::system();
  s.aintc_bus.write(0x0C, ~0u);
  s.aintc_bus.write(0x1C, 1);  // source 32
  s.bus.write(kTcr, 0);
  s.bus.write(kTim12, 0);
  s.bus.write(kPrd12, 10);
  s.bus.write(kTgcr, 0x5);
  const unsigned before = s.probe_irq.rises;
  s.bus.write(kTcr, 1u << 6);
  run_until(now() + 10'000'000);
  EXPECT_EQ(s.probe_irq.rises, before + 1);
  EXPECT_EQ(s.probe_irq.last_rise, s.probe12.last_rise);
  EXPECT_FALSE(s.tint12.read());
  EXPECT_TRUE(s.irq.read());
  EXPECT_EQ(s.aintc_bus.read(0x14), 33u * 4);
  s.aintc_bus.write(0x0C, 1);
  EXPECT_FALSE(s.irq.read());
  EXPECT_EQ(s.aintc_bus.read(0x14), 0u);
}

TEST(AintcPinTest, EachSourceIsTheBitOfItsNumber) {
  System& s = TimerTest::system();
  const std::uint32_t enabled0 = s.aintc_bus.read(0x18), enabled1 = s.aintc_bus.read(0x1C);
  s.aintc_bus.write(0x18, ~0u);
  s.aintc_bus.write(0x1C, ~0u);
  for (unsigned n = 0; n < kInterruptCount; ++n) {
    if (n == 32 || n == 33) continue;  // the timer's
    s.aintc_bus.write(0x08, ~0u);
    s.aintc_bus.write(0x0C, ~0u);
    ASSERT_FALSE(s.irq.read()) << n;
    s.sources[n].write(true);
    EXPECT_EQ(s.aintc_bus.read(0x14), 4 * (n + 1));
    EXPECT_TRUE(s.irq.read()) << n;
    EXPECT_EQ(s.aintc_bus.read(0x08), n < 32 ? ~(1u << n) : ~0u);
    EXPECT_EQ(s.aintc_bus.read(0x0C), n < 32 ? ~0u : ~(1u << (n - 32)));
    s.sources[n].write(false);
    test::settle();
  }
  s.aintc_bus.write(0x08, ~0u);
  s.aintc_bus.write(0x0C, ~0u);
  s.aintc_bus.write(0x18, enabled0);
  s.aintc_bus.write(0x1C, enabled1);
}

TEST_F(TimerTest, WrongKeyExpiresAnActiveWatchdogAtOnce) {
  s.wdt_bus.write(kWdtcr, 0x1234'4000);  // before activation a wrong key is only ignored
  EXPECT_FALSE(s.bitten.read());
  s.wdt_bus.write(kWdtcr, 0xA5C6'4000);
  s.wdt_bus.write(kWdtcr, 0xDA7E'4000);
  EXPECT_FALSE(s.bitten.read());
  s.wdt_bus.write(kWdtcr, 0x1234'4000);
  EXPECT_TRUE(s.bitten.read());
  EXPECT_STREQ(s.watchdog.reset_cause(),
               "a wrong key was written to the active watchdog, as Linux does to restart");
}

TEST_F(TimerTest, TimerPinAsBootLoadersUseItResetsTheBoard) {
  s.pin_bus.write(0x08, 0x00020000);
  EXPECT_FALSE(s.pin_reset.read());
  s.pin_bus.write(0x0C, 0x00020002);
  EXPECT_TRUE(s.pin_reset.read());
  EXPECT_STREQ(s.pin_timer.reset_cause(),
               "the watchdog timer's pin was driven high, as boot loaders do");
}

/// What an armed watchdog locks: SPRUH82C 30.1.6 and Linux drivers/watchdog/davinci_wdt.c ("write protected ... except
/// for the WDKEY field"). All other registers of the block can be written.
const std::set<std::string> kLockedByTheWatchdog = {"TIM12", "TIM34", "PRD12", "PRD34", "TCR", "TGCR"};

// In each state of an armed one every register is written, in every byte lane.
TEST_F(TimerTest, AnArmedWatchdogEndsByAResetOnly) {
  test::Bus& wdt = s.lock_bus;
  std::mt19937 rng(1);
  enum { kPreActive, kActive, kServing };
  wdt.write(kTgcr, 0xB);
  wdt.write(kPrd12, 100'000);
  wdt.write(kTcr, 2u << 6);
  wdt.write(kWdtcr, 0xA5C6'4000);
  Picoseconds served = 0;
  for (const int state : {kPreActive, kActive, kServing}) {
    if (state == kActive) {
      wdt.write(kWdtcr, 0xDA7E'4000);
      served = now();
    }
    if (state == kServing) wdt.write(kWdtcr, 0xA5C6'4000);
    for (const Reg* reg : s.lock_timer.regs.regs()) {
      if (reg->name() == "WDTCR" || reg->name().starts_with("GP")) continue;  // the keys; the pin's reset
      const bool locked = kLockedByTheWatchdog.count(reg->name()) > 0;
      std::uint32_t writable = 0;
      for (const Field* f : reg->fields())
        if (f->mode() == Mode::kRw) writable |= f->mask();
      for (const unsigned bytes : {4u, 2u, 1u})
        for (std::uint32_t at = reg->offset(); at < reg->offset() + 4; at += bytes) {
          const std::uint32_t before = wdt.read(reg->offset()), word = static_cast<std::uint32_t>(rng());
          wdt.write(at, word, bytes);
          const unsigned shift = 8 * (at & 3u);
          const std::uint32_t lanes = (bytes == 4 ? ~0u : (1u << 8 * bytes) - 1u) << shift, mask = writable & lanes;
          const std::uint32_t now_is = wdt.read(reg->offset());
          if (locked)
            EXPECT_EQ(now_is, before) << reg->name() << " state " << state << " bytes " << bytes << " at " << at;
          else
            EXPECT_EQ(now_is & mask, word << shift & mask) << reg->name() << " state " << state;
        }
    }
    wdt.write(kWdtcr, state == kPreActive ? 0xA5C6'4000 : 0xDA7E'0000, 4);  // neither of the words is wrong
    if (state == kServing) served = now();
    EXPECT_EQ(wdt.read(kWdtcr) & 0x4000, 0x4000u) << "WDEN";
    EXPECT_FALSE(s.lock_expired.read());
  }
  run_until(served + 4'166'000'000);  // 100,000 clocks of 24 MHz take 4,166.67 us
  EXPECT_FALSE(s.lock_expired.read());
  run_until(served + 4'167'000'000);
  EXPECT_TRUE(s.lock_expired.read());
}

TEST_F(TimerTest, AWatchdogIsServedAndThenExpiresAtItsPeriod) {
  test::Bus& served = s.served_bus;
  served.write(kPrd12, 1000);
  served.write(kTgcr, 0xB);  // watchdog mode
  served.write(kTcr, 2u << 6);
  run_until(now() + 100'000'000);
  EXPECT_FALSE(s.served_expired.read());  // not active yet: it does not count
  served.write(kWdtcr, 0xA5C6'4000);
  served.write(kWdtcr, 0xDA7E'4000);
  for (int n = 0; n < 5; ++n) {
    run_until(now() + 30'000'000);  // 720 clocks
    EXPECT_FALSE(s.served_expired.read());
    served.write(kWdtcr, 0xA5C6'4000);
    served.write(kWdtcr, 0xDA7E'4000);
  }
  EXPECT_EQ(served.read(kTim12), 0u);
  const std::uint64_t base = now();
  run_until(base + 41'600'000);  // 998 clocks
  EXPECT_FALSE(s.served_expired.read());
  run_until(base + 41'750'000);
  EXPECT_TRUE(s.served_expired.read());
  EXPECT_EQ(served.read(kWdtcr) & 0x8000, 0x8000u);
  EXPECT_STREQ(s.served_timer.reset_cause(), "the watchdog expired");
}

}  // namespace
}  // namespace fovea::periph

FOVEA_SC_TEST_MAIN
