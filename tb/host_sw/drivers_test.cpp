// Drivers against a recorder. Addresses and values are literals from TI's register header and Linux
// drivers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "register_recorder.h"

extern "C" {
#include "sw/firmware/drivers/display.h"
#include "sw/firmware/drivers/i2c.h"
#include "sw/firmware/drivers/intc.h"
#include "sw/firmware/drivers/isif.h"
#include "sw/firmware/drivers/multiplexer.h"
#include "sw/firmware/drivers/psc.h"
#include "sw/firmware/drivers/timer.h"
#include "sw/firmware/drivers/tvp5146_inputs.h"
#include "sw/firmware/drivers/uart.h"
#include "sw/firmware/drivers/vpss.h"
#include "sw/firmware/drivers/watchdog.h"

uint32_t mmio_read32(uint32_t address) { return RegisterRecorder::current()->read(address); }
void mmio_write32(uint32_t address, uint32_t value) {
  RegisterRecorder::current()->write(address, value);
}
}

namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::IsEmpty;
using testing::Not;
using A = RegisterAccess;

TEST(IsifTest, PalFrameIsProgrammedAsTheLinuxDriverDoes) {
  RegisterRecorder chip;
  const isif_window_t window = {0, 0, 720, 576, isif_pitch(720), 0};
  ASSERT_EQ(isif_configure(&window), ISIF_OK);
  EXPECT_THAT(chip.accesses,
              ElementsAreArray<A>({{'w', 0x01C71000, 0},       // SYNCEN: off while changing
                                   {'w', 0x01C71084, 3},       // REC656IF
                                   {'w', 0x01C71004, 0x2084},  // YC 8 bit, interlaced, VD negative
                                   {'w', 0x01C71088, 0x0812},  // 8-bit packing, swap, UYVY order
                                   {'w', 0x01C7102C, 0xFFFF},
                                   {'w', 0x01C71030, 0xFF},
                                   {'w', 0x01C71018, 0},
                                   {'w', 0x01C7101C, 1439},
                                   {'w', 0x01C71020, 1},
                                   {'w', 0x01C71024, 1},
                                   {'w', 0x01C71028, 287},
                                   {'w', 0x01C71070, 290},  // two lines after line 288
                                   {'w', 0x01C71034, 45},
                                   {'w', 0x01C71038, 0x249}}));
}

TEST(IsifTest, VgaWindowStartsInTheMiddleOfTheRaster) {
  RegisterRecorder chip;
  const isif_window_t window = {40, 20, 640, 440, isif_pitch(640), 0};
  ASSERT_EQ(isif_configure(&window), ISIF_OK);
  EXPECT_EQ(chip.values[0x01C71018], 80u);
  EXPECT_EQ(chip.values[0x01C7101C], 1279u);
  EXPECT_EQ(chip.values[0x01C71020], 11u);
  EXPECT_EQ(chip.values[0x01C71028], 219u);
  EXPECT_EQ(chip.values[0x01C71034], 40u);
}

TEST(IsifTest, PitchIsRoundedUpTo32Bytes) {
  EXPECT_EQ(isif_pitch(720), 1440u);
  EXPECT_EQ(isif_pitch(640), 1280u);
  EXPECT_EQ(isif_pitch(644), 1312u);
}

TEST(IsifTest, ABadWindowWritesNothing) {
  RegisterRecorder chip;
  const isif_window_t bad[] = {{0, 0, 721, 576, 1472, 0}, {0, 0, 720, 575, 1440, 0},
                               {0, 0, 720, 576, 1439, 0}, {0, 0, 720, 576, 1408, 0},
                               {0, 1, 720, 576, 1440, 0}, {0, 0, 0, 576, 1440, 0},
                               {0, 0, 720, 0, 1440, 0}};
  for (const isif_window_t& window : bad) EXPECT_EQ(isif_configure(&window), ISIF_BAD_WINDOW);
  EXPECT_EQ(isif_set_address(0x80123450), ISIF_BAD_ADDRESS);
  EXPECT_THAT(chip.accesses, IsEmpty());
}

// Lines of a field count from 1; the last captured one is behind half of `top` and half of `height`.
TEST(IsifTest, TheFieldEndsTwoLinesBehindItsLastRow) {
  const isif_window_t whole = {0, 0, 720, 576, 1440, 0}, middle = {40, 20, 640, 440, 1280, 0};
  EXPECT_EQ(isif_end_of_field_line(&whole), 290u);
  EXPECT_EQ(isif_end_of_field_line(&middle), 232u);
}

TEST(IsifTest, AddressIsSplitInto32ByteUnits) {
  RegisterRecorder chip;
  ASSERT_EQ(isif_set_address(0x80ABCDE0), ISIF_OK);
  EXPECT_THAT(chip.accesses, ElementsAre(A{'w', 0x01C7103C, 0x80ABCDE0u >> 21},
                                         A{'w', 0x01C71040, (0x80ABCDE0u >> 5) & 0xFFFF}));
  EXPECT_EQ(chip.values[0x01C7103C] << 21 | chip.values[0x01C71040] << 5, 0x80ABCDE0u);
}

TEST(IsifTest, SyncsComeFirstThenData) {
  RegisterRecorder chip;
  isif_watch();
  isif_capture();
  EXPECT_THAT(chip.accesses, ElementsAre(A{'w', 0x01C71000, 1}, A{'w', 0x01C71000, 3}));
  chip.values[0x01C71004] = 0x2084;
  EXPECT_FALSE(isif_second_field());
  chip.values[0x01C71004] = 0xA084;
  EXPECT_TRUE(isif_second_field());
}

TEST(DisplayTest, PalStartsWithTheWindowOff) {
  RegisterRecorder chip;
  const display_mode_t mode = {1, 0, 0, 720, 576, 1440};
  ASSERT_EQ(display_start(&mode), DISPLAY_OK);
  EXPECT_THAT(chip.accesses, ElementsAreArray<A>({{'w', 0x01C71E00, 0},
                                                  {'w', 0x01C4002C, 0x081141CF},
                                                  {'w', 0x01C71F40, 1},
                                                  {'w', 0x01C71E04, 0},
                                                  {'w', 0x01C71F2C, 1},
                                                  {'w', 0x01C71F30, 2},
                                                  {'w', 0x01C71C00, 0},
                                                  {'w', 0x01C71C04, 0},
                                                  {'w', 0x01C71C08, 0},
                                                  {'w', 0x01C71C0C, 0},
                                                  {'w', 0x01C71C10, 0},
                                                  {'w', 0x01C71C40, 0x7E},
                                                  {'w', 0x01C71C44, 0x16},
                                                  {'w', 0x01C71C48, 0},
                                                  {'w', 0x01C71C4C, 0},
                                                  {'w', 0x01C71C50, 720},
                                                  {'w', 0x01C71C54, 288},  // lines of a field
                                                  {'w', 0x01C71E00, 0x43}}));
}

TEST(DisplayTest, VgaWindowIsCentredInThe525Raster) {
  RegisterRecorder chip;
  const display_mode_t mode = {0, 40, 0, 640, 480, 1280};
  ASSERT_EQ(display_start(&mode), DISPLAY_OK);
  EXPECT_EQ(chip.values[0x01C71C40], 0x79u);
  EXPECT_EQ(chip.values[0x01C71C44], 0x10u);
  EXPECT_EQ(chip.values[0x01C71C48], 40u);
  EXPECT_EQ(chip.values[0x01C71C50], 640u);
  EXPECT_EQ(chip.values[0x01C71C54], 240u);
  EXPECT_EQ(chip.values[0x01C71E00], 0x03u);
}

TEST(DisplayTest, AddressFollowsTheOsdEncoding) {
  RegisterRecorder chip;
  ASSERT_EQ(display_set_address(0x80A5C3E0, 1440), DISPLAY_OK);
  const std::uint32_t units = 0xA5C3E0 / 32;  // 0x52E1F
  EXPECT_THAT(chip.accesses,
              ElementsAre(A{'w', 0x01C71C18, 0x1000 | 45}, A{'w', 0x01C71C28, units >> 16},
                          A{'w', 0x01C71C2C, units & 0xFFFF}));
}

TEST(DisplayTest, WindowIsSwitchedOnInFieldMode) {
  RegisterRecorder chip;
  display_enable_window();
  EXPECT_THAT(chip.accesses, ElementsAre(A{'w', 0x01C71C04, 3}));
}

TEST(DisplayTest, ABadModeOrAddressWritesNothing) {
  RegisterRecorder chip;
  const display_mode_t bad[] = {{1, 0, 0, 724, 576, 1472},
                                {0, 0, 0, 720, 576, 1440},
                                {1, 0, 1, 720, 574, 1440},
                                {1, 0, 0, 720, 576, 1430},
                                {1, 0, 0, 720, 576, 512 * 32},
                                {1, 0, 0, 0, 576, 1440},
                                {1, 0, 0, 720, 0, 1440},
                                {1, 2, 0, 720, 576, 1440},
                                {1, 0, 2, 720, 576, 1440}};
  for (const display_mode_t& mode : bad) EXPECT_EQ(display_start(&mode), DISPLAY_BAD_MODE);
  EXPECT_EQ(display_set_address(0x80000010, 1440), DISPLAY_BAD_ADDRESS);
  EXPECT_EQ(display_set_address(0x00010000, 1440), DISPLAY_BAD_ADDRESS);
  EXPECT_THAT(chip.accesses, IsEmpty());
}

TEST(DisplayTest, LimitsOfTheRasterAndThePitchAreReached) {
  RegisterRecorder chip;
  const display_mode_t good[] = {{1, 0, 0, 720, 576, 511 * 32}, {1, 80, 0, 640, 576, 1280},
                                 {1, 0, 96, 720, 480, 1440},    {0, 0, 0, 720, 480, 1440},
                                 {0, 0, 40, 720, 440, 1440}};
  for (const display_mode_t& mode : good) EXPECT_EQ(display_start(&mode), DISPLAY_OK);
}

TEST(DisplayTest, FieldComesFromVstatBit4) {
  RegisterRecorder chip;
  EXPECT_FALSE(display_second_field());
  chip.values[0x01C71EB8] = 0x10;
  EXPECT_TRUE(display_second_field());
}

TEST(VpssTest, RoutesLikeLinuxAndOpensTheGates) {
  RegisterRecorder chip;
  chip.values[0x01C70200] = 0x18;
  vpss_init(0x38);
  EXPECT_EQ(chip.values[0x01C40044], 0x38u);
  EXPECT_EQ(chip.values[0x01C70200], 0x1Du);
  EXPECT_EQ(chip.values[0x01C70004] & 0x63u, 0x63u);
  EXPECT_EQ(chip.values[0x01C70010], 0x0B1F0100u);
  EXPECT_EQ(chip.values[0x01C70014], 0x1F0A0F1Fu);
  EXPECT_EQ(chip.values[0x01C70018], 0x15u);
}

TEST(IntcTest, AtFirstEverySourceIsClosedAndNothingIsPending) {
  RegisterRecorder chip;
  intc_init();
  EXPECT_THAT(chip.accesses,
              ElementsAre(A{'w', 0x01C48018, 0}, A{'w', 0x01C4801C, 0},   // EINT
                          A{'w', 0x01C48020, 0}, A{'w', 0x01C48024, 0},   // INTCTL, EABASE
                          A{'w', 0x01C48000, ~0u}, A{'w', 0x01C48004, ~0u},   // FIQ
                          A{'w', 0x01C48008, ~0u}, A{'w', 0x01C4800C, ~0u}));  // IRQ
}

TEST(IntcTest, EnableSetsPriorityDropsOldEdgesAndOpensTheSource) {
  RegisterRecorder chip;
  chip.values[0x01C48034] = 0x77777777;  // INTPRI1: sources 8 to 15
  intc_enable(8, 3);
  EXPECT_THAT(chip.writes(), ElementsAre(A{'w', 0x01C48034, 0x77777773}, A{'w', 0x01C48008, 0x100},
                                         A{'w', 0x01C48018, 0x100}));
}

TEST(IntcTest, SourcesAbove31UseTheSecondRegisters) {
  RegisterRecorder chip;
  chip.values[0x01C48040] = 0x77777777;  // INTPRI4: sources 32 to 39
  intc_enable(33, 7);
  EXPECT_THAT(chip.writes(), ElementsAre(A{'w', 0x01C48040, 0x77777777}, A{'w', 0x01C4800C, 2},
                                         A{'w', 0x01C4801C, 2}));
  chip.accesses.clear();
  chip.values[0x01C4801C] = 0x12;
  intc_disable(33);
  EXPECT_THAT(chip.writes(), ElementsAre(A{'w', 0x01C4801C, 0x10}, A{'w', 0x01C4800C, 2}));
}

TEST(IntcTest, EntryIsDecodedToASourceNumber) {
  RegisterRecorder chip;
  chip.values[0x01C48014] = (8 + 1) * 4;
  EXPECT_EQ(intc_pending(), 8u);
  chip.values[0x01C48014] = 4;
  EXPECT_EQ(intc_pending(), 0u);
  chip.values[0x01C48014] = 0;
  EXPECT_EQ(intc_pending(), INTC_NONE);
}

TEST(TimerTest, Timer0CountsFreelyIn32Bits) {
  RegisterRecorder chip;
  timer_start();
  EXPECT_EQ(chip.values[0x01C21418], 0xFFFFFFFFu);
  EXPECT_EQ(chip.values[0x01C21420], 0x80u);  // TIM12 continuous
  EXPECT_EQ(chip.values[0x01C21424], 0x05u);  // two timers, unchained; TIM12 out of reset
}

TEST(TimerTest, TheAlarmIsTim34OnceAndLeavesTim12Running) {
  RegisterRecorder chip;
  timer_start();
  chip.accesses.clear();
  timer_alarm(240'000);
  EXPECT_THAT(chip.writes(), ElementsAre(A{'w', 0x01C21420, 0x80}, A{'w', 0x01C21414, 0},
                                         A{'w', 0x01C2141C, 240'000}, A{'w', 0x01C21424, 0x07},
                                         A{'w', 0x01C21420, 0x00400080}));
}

// The keys, their order and the mode are those of Linux' davinci_wdt.c.
TEST(WatchdogTest, IsStartedWithItsPeriodAndServedByTwoKeys) {
  RegisterRecorder chip;
  watchdog_start(300'000'000);  // 7.2e9 ticks of 24 MHz: more than one half holds
  EXPECT_THAT(chip.writes(),
              ElementsAre(A{'w', 0x01C21C20, 0}, A{'w', 0x01C21C24, 0}, A{'w', 0x01C21C24, 0xB}, A{'w', 0x01C21C10, 0},
                          A{'w', 0x01C21C14, 0}, A{'w', 0x01C21C18, 0xAD27'4800}, A{'w', 0x01C21C1C, 1},
                          A{'w', 0x01C21C20, 0x80}, A{'w', 0x01C21C28, 0xA5C6'4000}, A{'w', 0x01C21C28, 0xDA7E'4000}));
  chip.accesses.clear();
  watchdog_serve();
  EXPECT_THAT(chip.accesses, ElementsAre(A{'w', 0x01C21C28, 0xA5C6'4000}, A{'w', 0x01C21C28, 0xDA7E'4000}));
}

// Decision 0015: 1 power-on, 2 warm, 4 watchdog.
TEST(WatchdogTest, OnlyItsOwnResetIsSaidToBeItsOwn) {
  RegisterRecorder chip;
  for (const auto& [type, own] : {std::pair{0u, 0}, {1u, 0}, {2u, 0}, {3u, 0}, {4u, 1}}) {
    chip.values[0x01C408E4] = type;
    EXPECT_EQ(watchdog_has_reset(), own) << type;
  }
}

TEST(UartTest, DivisorFormatAndText) {
  RegisterRecorder chip;
  chip.values[0x01C20004] = 0xF;     // interrupts of a program that used it before
  chip.values[0x01C20010] = 0x10;    // its loopback
  uart_init(UART_DIVISOR_115200);
  EXPECT_EQ(chip.values[0x01C20004], 0u);
  EXPECT_EQ(chip.values[0x01C20010], 0u);
  EXPECT_EQ(chip.values[0x01C20020], 13u);  // 24 MHz / 16 / 13 = 115385
  EXPECT_EQ(chip.values[0x01C2000C], 3u);
  EXPECT_EQ(chip.values[0x01C20030], 0x6001u);
  chip.values[0x01C20014] = 0x60;
  std::string text;
  chip.on_write = [&](std::uint32_t address, std::uint32_t value) {
    if (address == 0x01C20000) text += static_cast<char>(value);
  };
  uart_puts("a\n");
  uart_put_uint(0);
  uart_putc(' ');
  uart_put_uint(4294967295u);
  uart_putc(' ');
  uart_put_uint(1090);
  uart_putc(' ');
  uart_put_hex(0xC0FFEE);
  EXPECT_EQ(text, "a\r\n0 4294967295 1090 0x00c0ffee");
}

TEST(UartTest, WaitsForTheTransmitter) {
  RegisterRecorder chip;
  int polls = 0;
  chip.on_read = [&](std::uint32_t) { return ++polls < 5 ? 0u : 0x20u; };
  uart_putc('x');
  EXPECT_EQ(polls, 5);
  EXPECT_EQ(chip.accesses.back(), (A{'w', 0x01C20000, 'x'}));
}

TEST(PscTest, TransitionIsRequestedAndAwaited) {
  RegisterRecorder chip;
  int stat_polls = 0;
  chip.on_read = [&](std::uint32_t address) -> std::uint32_t {
    if (address == 0x01C41800 + 4 * 26) return ++stat_polls < 4 ? 0 : 3;
    return address == 0x01C41A00 + 4 * 26 ? 0x100 : 0;
  };
  psc_transition(26, 3);
  EXPECT_THAT(chip.writes(),
              ElementsAre(A{'w', 0x01C41A00 + 4 * 26, 0x103}, A{'w', 0x01C41120, 1}));
  EXPECT_EQ(stat_polls, 4);
}

TEST(PscTest, AModuleAlreadyThereIsLeftAlone) {
  RegisterRecorder chip;
  chip.values[0x01C41800 + 4 * 13] = 0x1E03;
  psc_transition(13, 3);
  EXPECT_THAT(chip.writes(), IsEmpty());
}

// An I2C controller that always accepts, or whose device does not answer.
struct FakeI2c {
  explicit FakeI2c(RegisterRecorder& chip, bool present) {
    chip.on_read = [this, present](std::uint32_t address) -> std::uint32_t {
      if (address == 0x01C21008) return present ? 0x38u : 0x02u;
      if (address == 0x01C21018) return reads.at(next_read++);
      return 0;
    };
    chip.on_write = [this](std::uint32_t address, std::uint32_t value) {
      if (address == 0x01C21020) sent.push_back(static_cast<std::uint8_t>(value));
      if (address == 0x01C2101C) device = value;
    };
  }
  std::vector<std::uint8_t> sent, reads{0x51, 0x46};
  std::size_t next_read = 0;
  std::uint32_t device = 0;
};

TEST(Tvp5146Test, OutputIsEnabledAfterTheStandard) {
  RegisterRecorder chip;
  FakeI2c bus(chip, true);
  std::uint32_t id = 0;
  EXPECT_EQ(tvp5146_start(1, &id), I2C_OK);
  EXPECT_EQ(id, 0x5146u);
  EXPECT_EQ(bus.device, 0x5Du);
  EXPECT_THAT(bus.sent, ElementsAre(0x80, 0x81, 0x02, 2, 0x00, 5, 0x33, 0, 0x03, 0, 0x34, 0x11));
}

// Select lines on pins 40 to 42: DIR23 is at 0x01C67038 and OUT_DATA23 at 0x01C6703C.
TEST(MultiplexerTest, AllSelectLinesChangeInOneWrite) {
  RegisterRecorder chip;
  std::map<std::uint32_t, std::uint32_t> registers{{0x01C67038, 0xFFFFFFFF}, {0x01C6703C, 0x12345678}};
  chip.on_read = [&](std::uint32_t address) { return registers.at(address); };
  std::vector<std::uint32_t> out;
  chip.on_write = [&](std::uint32_t address, std::uint32_t value) {
    if (address == 0x01C6703C) out.push_back(value);
    registers.at(address) = value;
  };
  multiplexer_start();
  EXPECT_EQ(registers.at(0x01C67038), 0xFFFFF8FFu) << "three outputs";
  for (const std::uint32_t camera : {1u, 2u, 7u, 0u}) multiplexer_select(camera);
  EXPECT_THAT(out, ElementsAre(0x12345078u, 0x12345178u, 0x12345278u, 0x12345778u, 0x12345078u));
}

// A wait for the bus or for a status bit ends after 20 ms of the 24 MHz timer: 480,000 ticks are waited for, one more
// are not. The status that is waited for comes at the second look.
TEST(I2cTest, WaitsEndAfterTwentyMilliseconds) {
  constexpr std::uint32_t kBusy = 0x1000, kReady = 0x38;
  for (const bool busy : {true, false}) {  // the bus is taken; the bus is free, but the transmitter is not ready
    for (const std::uint32_t ticks : {480'000u, 480'001u}) {
      RegisterRecorder chip;
      unsigned looks = 0, times = 0;
      chip.on_read = [&](std::uint32_t address) -> std::uint32_t {
        if (address == 0x01C21008) return looks++ < (busy ? 1 : 2) ? (busy ? kBusy | kReady : 0) : kReady;
        if (address != 0x01C21410) return 0;
        return times++ < (busy ? 1 : 2) ? 0xFFFFFFFF : ticks - 1;  // each wait begins with a look at the timer
      };
      EXPECT_EQ(i2c_write_register(0x5D, 1, 2), ticks == 480'000 ? I2C_OK : I2C_TIMEOUT) << busy << " " << ticks;
    }
  }
}

TEST(Tvp5146Test, AnAbsentDecoderIsReported) {
  RegisterRecorder chip;
  FakeI2c bus(chip, false);
  std::uint32_t id = 0;
  EXPECT_EQ(tvp5146_start(0, &id), I2C_NACK);
  EXPECT_THAT(bus.sent, IsEmpty());
}

// Status 1 at 0x3A: bit 1 horizontal lock, bit 2 vertical lock (TI SLES084C). Every pause takes
// 10 ms of the 24 MHz timer at 0x01C21410.
class LockTest : public testing::Test {
 protected:
  LockTest() : bus_(chip_, true) {
    bus_.reads.clear();
    pauses() = 0;
    auto i2c = chip_.on_read;
    chip_.on_read = [i2c](std::uint32_t address) -> std::uint32_t {
      return address == 0x01C21410 ? 0xFFFFFF00u + pauses() * 240'000u : i2c(address);
    };
  }
  i2c_result_t wait(std::uint32_t timeout_ms) {
    return tvp5146_wait_lock(timeout_ms * 24'000u, [] { ++pauses(); });
  }
  static unsigned& pauses() {
    static unsigned count;
    return count;
  }
  RegisterRecorder chip_;
  FakeI2c bus_;
};

TEST_F(LockTest, ALockedDecoderCostsOneLook) {
  bus_.reads = {0x0E};
  EXPECT_EQ(wait(1000), I2C_OK);
  EXPECT_EQ(pauses(), 0u);
  EXPECT_EQ(bus_.device, 0x5Du);
  EXPECT_THAT(bus_.sent, ElementsAre(0x3A));
}

TEST_F(LockTest, BothSyncsMustBeLocked) {
  bus_.reads = {0x00, 0x02, 0x04, 0xF9, 0x06};
  EXPECT_EQ(wait(1000), I2C_OK);
  EXPECT_EQ(pauses(), 4u);
  EXPECT_THAT(bus_.sent, ElementsAre(0x3A, 0x3A, 0x3A, 0x3A, 0x3A));
}

TEST_F(LockTest, ADecoderThatNeverLocksEndsTheWaitAtItsTime) {
  bus_.reads.assign(200, 0x80);
  EXPECT_EQ(wait(1000), I2C_TIMEOUT);
  EXPECT_EQ(pauses(), 100u);  // the timer wraps on the way
}

TEST_F(LockTest, LockAtTheLastLookCounts) {
  bus_.reads.assign(100, 0);
  bus_.reads.push_back(0x06);
  EXPECT_EQ(wait(1000), I2C_OK);
}

TEST(Tvp5146Test, AnAbsentDecoderIsNotWaitedFor) {
  RegisterRecorder chip;
  FakeI2c bus(chip, false);
  EXPECT_EQ(tvp5146_wait_lock(24'000'000, [] { FAIL() << "a pause"; }), I2C_NACK);
}

// Registers 97 (request), 9A and 9B (count): Linux, tvp514x_regs.h; data manual of the TVP5147M1 (TI SLES140).
TEST(Tvp5146Test, TheLinesOfAFrameAreAskedForAndReadWhenTheDecoderHasThem) {
  RegisterRecorder chip;
  FakeI2c bus(chip, true);
  EXPECT_EQ(tvp5146_keep_line_count(), I2C_OK);
  EXPECT_THAT(bus.sent, ElementsAre(0x97, 1));
  struct Case {
    std::uint32_t expected;
    std::uint8_t low;
    std::int32_t more;
  };
  // 625 is 0x271 and 525 is 0x20D.
  for (const Case& c : {Case{625, 0x71, 0}, Case{625, 0x70, -1}, Case{625, 0x0D, -100}, Case{625, 0x75, 4},
                        Case{525, 0x0D, 0}, Case{525, 0xFC, -17}, Case{525, 0x71, 100}}) {
    bus.sent.clear();
    bus.reads = {0xFF, 0x01, 0xFE, c.low};
    bus.next_read = 0;
    std::int32_t more = 77;
    EXPECT_EQ(tvp5146_line_count(c.expected, &more), I2C_OK);
    EXPECT_EQ(more, c.more) << c.expected << ' ' << +c.low;
    EXPECT_THAT(bus.sent, ElementsAre(0x97, 0x97, 0x97, 0x9A));
  }
}

TEST(Tvp5146Test, ADecoderWithoutALineCountIsNotWaitedForForever) {
  RegisterRecorder chip;
  FakeI2c bus(chip, true);
  bus.reads.assign(100, 1);
  std::int32_t more = 77;
  EXPECT_EQ(tvp5146_line_count(625, &more), I2C_TIMEOUT);
  EXPECT_EQ(bus.next_read, 8u) << "a millisecond";
  bus.reads = {1, 1, 1, 1, 1, 1, 1, 0, 0x71};
  bus.next_read = 0;
  EXPECT_EQ(tvp5146_line_count(624, &more), I2C_OK) << "just in time";
  EXPECT_EQ(more, 1);
  FakeI2c absent(chip, false);
  more = 77;
  EXPECT_EQ(tvp5146_line_count(625, &more), I2C_NACK);
  EXPECT_EQ(more, 77) << "left alone";
}

// The device takes its address and the register's number, and then refuses to be read.
TEST(I2cTest, ARefusedReadIsReportedAndEndsWithAStop) {
  constexpr std::uint32_t kIcmdr = 0x01C21024, kStt = 0x2000, kStp = 0x800, kTrx = 0x200;
  RegisterRecorder chip;
  bool refuses = false;
  chip.on_write = [&](std::uint32_t address, std::uint32_t value) {
    if (address == kIcmdr) refuses = (value & kStt) && !(value & kTrx);
  };
  chip.on_read = [&](std::uint32_t address) -> std::uint32_t {
    return address == 0x01C21008 ? (refuses ? 0x02u : 0x38u) : 0;
  };
  std::uint8_t value = 0xEE;
  EXPECT_EQ(i2c_read_register(0x5D, 0x3A, &value), I2C_NACK);
  EXPECT_EQ(value, 0xEE) << "left alone";
  const auto writes = chip.writes();
  EXPECT_THAT(writes, Contains(A{'w', kIcmdr, kStp}));
  EXPECT_EQ(writes.back(), (A{'w', kIcmdr, 0x20})) << "the controller starts anew";
  chip.on_read = [](std::uint32_t address) -> std::uint32_t {
    return address == 0x01C21008 ? 0x38u : address == 0x01C21018 ? 0x51u : 0;
  };
  chip.accesses.clear();
  EXPECT_EQ(i2c_read_register(0x5D, 0x3A, &value), I2C_OK);
  EXPECT_EQ(value, 0x51);
  EXPECT_THAT(chip.writes(), Not(Contains(A{'w', kIcmdr, kStp}))) << "nothing to be given up";
}

TEST(I2cTest, ADeadBusTimesOut) {
  RegisterRecorder chip;
  std::uint32_t ticks = 0;
  chip.on_read = [&](std::uint32_t address) -> std::uint32_t {
    return address == 0x01C21410 ? ticks += 1000 : 0;
  };
  EXPECT_EQ(i2c_write_register(0x5D, 1, 2), I2C_TIMEOUT);
}

}  // namespace
