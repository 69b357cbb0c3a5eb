// Resets of the chip: registers, memories, clocks, blocks with work under way, and the boot after it.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <systemc>

#include "tb/e2e/expectations.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

constexpr const char* kIdleLoop = PROGRAM_DIR "/idle_loop.elf";
const auto kKinds = testing::Values(ResetKind::kPowerOn, ResetKind::kWarm, ResetKind::kWatchdog);

std::string name_of(ResetKind kind) {
  return kind == ResetKind::kPowerOn ? "PowerOn" : kind == ResetKind::kWarm ? "Warm" : "Watchdog";
}

/// Keys of a board.
using Keys = std::vector<std::pair<std::string, std::string>>;

/// A board whose core loops.
struct Resettable {
  Rig rig{kIdleLoop};
  board::Board& board;
  soc::Dm365& soc;
  explicit Resettable(const Keys& keys = {}) : board(build(keys)), soc(board.dm365) {
    rig.advance(10 * kPsPerUs);
  }
  board::Board& build(const Keys& keys) {
    for (const auto& [key, value] : keys) rig.set(key, value);
    return rig.build();
  }
  void reset(ResetKind kind) {
    board.reset(kind);
    rig.advance(50 * kPsPerUs);
  }
  std::uint32_t read(const std::string& block, std::uint32_t offset) {
    std::uint32_t value = 0;
    board.platform.each_registers([&](const std::string& name, BusTarget& target) {
      if (name != block) return;
      EXPECT_EQ(target.bank().read(offset, 4, value), Access::kOk) << name;
    });
    return value;
  }
  /// What software reads, by block and register.
  std::map<std::string, std::uint32_t> all() {
    std::map<std::string, std::uint32_t> out;
    board.platform.each_registers([&](const std::string& name, BusTarget& target) {
      for (const Reg* r : target.bank().regs()) out[name + "." + r->name()] = read(name, r->offset());
    });
    return out;
  }
  /// Writes the complement of its value to every register.
  void write_all() {
    board.platform.each_registers([&](const std::string&, BusTarget& target) {
      for (const Reg* r : target.bank().regs()) {
        std::uint32_t value = 0;
        target.bank().peek(r->offset(), value);
        target.bank().write(r->offset(), 4, ~value);
      }
    });
  }
};

class EachKind : public testing::TestWithParam<ResetKind> {};
INSTANTIATE_TEST_SUITE_P(Reset, EachKind, kKinds, [](const auto& i) { return name_of(i.param); });

/// The pins that a register of the GPIO shows, "gpio.IN_DATA01" those from 0 on; none if it shows none.
std::optional<unsigned> first_pin(const std::string& name) {
  constexpr std::string_view kName = "gpio.IN_DATA";
  if (!name.starts_with(kName)) return std::nullopt;
  return 16 * static_cast<unsigned>(name[kName.size()] - '0');
}

/// A level for each pin that is neither the reset value nor its complement.
constexpr bool driven(unsigned pin) { return pin * pin % 7 < 3; }

/// The blocks of the default board, and those that only some boards have.
struct ResetCase {
  ResetKind kind;
  const char* board;
  Keys keys;
};
void PrintTo(const ResetCase& c, std::ostream* out) { *out << name_of(c.kind) << c.board; }
class EachKindOnEachBoard : public testing::TestWithParam<ResetCase> {};
const Keys kAll = {{"engine", "tlm"}, {"board.cpld", "true"}};
INSTANTIATE_TEST_SUITE_P(Reset, EachKindOnEachBoard,
                         testing::Values(ResetCase{ResetKind::kPowerOn, "", {}},
                                         ResetCase{ResetKind::kWarm, "", {}},
                                         ResetCase{ResetKind::kWatchdog, "", {}},
                                         ResetCase{ResetKind::kPowerOn, "WithEngineAndCpld", kAll},
                                         ResetCase{ResetKind::kWarm, "WithEngineAndCpld", kAll},
                                         ResetCase{ResetKind::kWatchdog, "WithEngineAndCpld", kAll}),
                         [](const auto& i) { return name_of(i.param.kind) + i.param.board; });

TEST_P(EachKindOnEachBoard, EveryRegisterReadsItsResetValue) {
  Resettable c(GetParam().keys);
  for (unsigned pin = 0; pin < periph::kGpioPins; ++pin) c.soc.gpio.set_pin(pin, driven(pin));
  const auto at_start = c.all();
  std::set<std::string> blocks;
  std::size_t declared = 0;
  c.board.platform.each_registers([&](const std::string& block, BusTarget& target) {
    for (const Reg* r : target.bank().regs()) {
      const std::string name = block + "." + r->name();
      std::uint32_t write_only = 0;
      for (const Field* f : r->fields())
        if (f->mode() == Mode::kWo) write_only |= f->mask();
      std::uint32_t expected = r->reset_value() & ~write_only;  // software cannot tell the two apart
      if (const auto pin = first_pin(name)) {  // the board's levels
        expected = 0;
        for (unsigned k = *pin; k < std::min(*pin + 32, periph::kGpioPins); ++k)
          expected |= std::uint32_t{driven(k)} << (k - *pin);
      }
      EXPECT_EQ(at_start.at(name), expected) << name;
      ++declared;
    }
    blocks.insert(block);
  });
  EXPECT_GT(declared, 300u);
  EXPECT_EQ(blocks.contains("engine"), !GetParam().keys.empty());
  EXPECT_EQ(blocks.contains("cpld"), !GetParam().keys.empty());
  c.write_all();
  std::size_t changed = 0;
  const auto written = c.all();
  for (const auto& [name, value] : written) changed += value != at_start.at(name);
  EXPECT_GT(changed, 250u);
  c.reset(GetParam().kind);
  auto expected = at_start;
  if (GetParam().kind == ResetKind::kWatchdog)  // it does not leave the chip (decision 0015)
    for (const auto& [name, value] : written)
      if (name.starts_with("cpld.")) expected[name] = value;
  expected["pll1.RSTYPE"] = expected["pll2.RSTYPE"] =
      GetParam().kind == ResetKind::kPowerOn ? 1 : GetParam().kind == ResetKind::kWarm ? 2 : 4;
  for (const auto& [name, value] : c.all()) EXPECT_EQ(value, expected[name]) << name;
}

// The same, with time for what was written to take effect: clocks that change or stop, powered blocks,
// interrupts, timers that run.
TEST_P(EachKind, WhatTheRegistersStartedHasNoEffectAfterwards) {
  Resettable c;
  const auto at_start = c.all();
  for (unsigned n = 0; n < periph::kLpscCount; ++n) c.soc.psc.regs.write(0xA00 + 4 * n, 4, 3);
  c.soc.psc.regs.write(0x120, 4, 1);
  c.rig.advance(10 * kPsPerUs);
  for (auto* t : c.soc.timers) {
    t->regs.write(0x24, 4, 7);
    t->regs.write(0x18, 4, 30'000);
    t->regs.write(0x1C, 4, 30'000);
    t->regs.write(0x20, 4, 1u << 6 | 1u << 22);
  }
  c.soc.aintc.regs.regs.write(0x18, 4, ~0u);
  c.soc.aintc.regs.regs.write(0x1C, 4, ~0u);
  c.soc.uart0.regs.write(0x30, 4, 0x6001);
  c.soc.uart0.regs.write(0x20, 4, 13);
  c.soc.uart0.regs.write(0x00, 4, 'x');
  c.soc.gpio.regs.write(0x38, 4, 0);
  c.soc.gpio.regs.write(0x3C, 4, 0xFFFF);
  c.soc.gpio.regs.write(0x08, 4, 1);
  c.soc.gpio.regs.write(0x24, 4, 1u << 3);  // rising edges of GPIO3
  c.soc.gpio.set_pin(3, false);
  c.soc.gpio.set_pin(3, true);
  c.soc.pll1.regs.write(0x118 + 4, 4, 0x8001);  // the core's clock at half
  c.soc.pll1.regs.write(0x138, 4, 1);
  c.rig.advance(20 * kPsPerUs);
  EXPECT_TRUE(c.soc.arm.core().clock().frequency() == Frequency(12'000'000));
  EXPECT_EQ(c.soc.aintc.core().pending(), std::uint64_t{1} << 47);
  c.soc.gpio.set_pin(3, at_start.at("gpio.IN_DATA01") >> 3 & 1);
  const std::string sent = c.board.uart_text();
  c.reset(GetParam());
  EXPECT_TRUE(c.soc.arm.core().clock().frequency() == Frequency(24'000'000));
  c.rig.advance(5 * kPsPerMs);  // longer than each timer
  auto expected = at_start;
  expected["pll1.RSTYPE"] = expected["pll2.RSTYPE"] = c.read("pll1", 0xE4);
  for (const auto& [name, value] : c.all()) EXPECT_EQ(value, expected[name]) << name;
  EXPECT_EQ(c.soc.aintc.core().pending(), 0u);
  EXPECT_EQ(c.board.uart_text(), sent);
  EXPECT_LT(c.soc.arm.core().reg(15), 8u);  // the loop at 0
  EXPECT_GT(c.soc.arm.core().counts().issue, 5000u * 20);
}

/// A register and what software reads from it after a reset.
struct Value {
  const char* block;
  std::uint32_t offset, value;
};

/// Those that do not read 0. From TI's register header and boot loader for the DM36x, its guides of sister
/// chips, Linux 6.1 and U-Boot, as listed in model/SOURCES.md; typed here once more.
std::map<std::pair<std::string, std::uint32_t>, std::uint32_t> values_of_the_manuals() {
  std::map<std::pair<std::string, std::uint32_t>, std::uint32_t> out;
  for (const Value& v : {
           Value{"aintc", 0x00, 0xFFFF'FFFF}, {"aintc", 0x04, 0xFFFF'FFFF}, {"aintc", 0x08, 0xFFFF'FFFF},
           {"aintc", 0x0C, 0xFFFF'FFFF},
           {"system", 0x20, 0x700}, {"system", 0x28, 0x0B83'E02F}, {"system", 0x2C, 0x0011'5500},
           {"system", 0x34, 0xC7}, {"system", 0x38, 0x13}, {"system", 0x3C, 0x0055'0011},
           {"system", 0x40, 0x0444}, {"system", 0x44, 0x10}, {"system", 0x48, 0x003F'0FF8},
           {"system", 0x4C, 0x176B}, {"system", 0x74, 0x0018'2077}, {"system", 0x78, 0xFFFF'FFFF},
           {"system", 0x7C, 0xFFFF'FFFF}, {"system", 0x80, 1},
           {"pll1", 0x150, 0x1FF}, {"pll2", 0x150, 0x1F},
           {"psc", 0x200, 0x301}, {"psc", 0x300, 1},
           {"ddr", 0x04, 0x4}, {"ddr", 0x08, 0x0005'3832}, {"ddr", 0x0C, 0x535}, {"ddr", 0x10, 0xFFFF'FFFF},
           {"ddr", 0x14, 0x7FFF'FFFF}, {"ddr", 0x20, 0xFF}, {"ddr", 0xE4, 0x5000'6405},
           {"gpio", 0x10, 0xFFFF'FFFF}, {"gpio", 0x38, 0xFFFF'FFFF}, {"gpio", 0x60, 0xFFFF'FFFF},
           {"gpio", 0x88, 0xFFFF'FFFF},
           {"uart0", 0x08, 0x01}, {"uart0", 0x14, 0x60}, {"uart1", 0x08, 0x01}, {"uart1", 0x14, 0x60},
           {"i2c", 0x08, 0x410}, {"i2c", 0x1C, 0x3FF}, {"i2c", 0x2C, 1},
           {"vpss", 0x00, 0x4C18'0800}, {"vpss", 0x04, 0x7F}, {"vpss", 0x08, 0x2}, {"vpss", 0x200, 0x19},
           {"isif", 0x04, 0x2000}, {"isif", 0x2C, 0xFFFF}, {"isif", 0x30, 0xFF},
           {"edma", 0x04, 0x0023'4445}, {"edma", 0x280, 0x3210}, {"edma", 0x284, 0x7777},
           {"edma", 0x620, 0x1010'1010},
           {"edma_tc0", 0x04, 0x213}, {"edma_tc1", 0x04, 0x213}, {"edma_tc2", 0x04, 0x213},
           {"edma_tc3", 0x04, 0x213}})
    EXPECT_TRUE(out.emplace(std::pair(v.block, v.offset), v.value).second) << v.block << v.offset;
  for (std::uint32_t priorities = 0; priorities < 8; ++priorities)
    out[{"aintc", 0x30 + 4 * priorities}] = 0x7777'7777;
  for (const char* pll : {"pll1", "pll2"}) {
    out[{pll, 0xE4}] = 4;    // the watchdog
    out[{pll, 0x100}] = 0x68;
    out[{pll, 0x13C}] = 4;   // the oscillator is stable
    out[{pll, 0x140}] = 0x1FF;
    out[{pll, 0x148}] = out[{pll, 0x14C}] = 3;
    for (const std::uint32_t divider : {0x114, 0x118, 0x11C, 0x120, 0x124, 0x128, 0x12C, 0x160, 0x164})
      out[{pll, divider}] = 0x8000;  // enabled, by one
  }
  for (const std::uint32_t divider : {0x168, 0x16C, 0x170, 0x174}) out[{"pll1", divider}] = 0x8000;  // 6 to 9
  for (std::uint32_t module = 0; module < 52; ++module) {
    const bool runs = module == 14 || module == 19 || (module >= 27 && module <= 31);
    out[{"psc", 0x800 + 4 * module}] = runs ? 0x1F03 : 0x0B00;
    out[{"psc", 0xA00 + 4 * module}] = runs ? 0x103 : 0x100;
  }
  return out;
}

TEST(ResetTest, EveryRegisterHasTheManualsValue) {
  Resettable c;
  c.write_all();
  c.reset(ResetKind::kWatchdog);
  auto expected = values_of_the_manuals();
  std::set<std::string> seen;
  c.board.platform.each_registers([&](const std::string& block, BusTarget& target) {
    for (const Reg* r : target.bank().regs()) {
      const std::string name = block + "." + r->name();
      const auto row = expected.extract({block, r->offset()});
      if (first_pin(name)) continue;  // the board's levels
      EXPECT_EQ(c.read(block, r->offset()), row.empty() ? 0 : row.mapped()) << name;
      seen.insert(name);
    }
  });
  EXPECT_GT(seen.size(), 300u);
  for (const auto& [place, value] : expected)
    ADD_FAILURE() << place.first << " has no register at 0x" << std::hex << place.second;
}

TEST_P(EachKind, MemoriesKeepOrLoseTheirContents) {
  Resettable c;
  c.board.load({0x100, {1, 2, 3, 4}, 4});  // as a program's data and cleared memory
  c.soc.internal_ram[0x100] = 99;
  c.soc.internal_ram[0x104] = 77;
  c.soc.internal_ram[0x3F00] = 55;
  *c.soc.ddr.store().at(0x12'3456) = 44;
  c.reset(GetParam());
  const bool lost = GetParam() == ResetKind::kPowerOn;
  EXPECT_EQ(c.soc.internal_ram[0x100], 1);  // the loader brings it again
  EXPECT_EQ(c.soc.internal_ram[0x104], lost ? 0 : 77);
  EXPECT_EQ(c.soc.internal_ram[0x3F00], lost ? 0 : 55);
  EXPECT_EQ(*c.soc.ddr.store().at(0x12'3456), lost ? 0 : 44);
  EXPECT_EQ(c.soc.stats.resets.count(), 1u);
}

// To the picosecond: the core's first instruction comes `system.reset_time` after the reset.
TEST(ResetTest, TheCoreStartsAfterTheResetTime) {
  Rig rig(kIdleLoop);
  rig.set("system.reset_time", "37us");
  board::Board& board = rig.build();
  rig.advance(10 * kPsPerUs);
  Picoseconds booted = 0;
  const Subscription boot = board.dm365.observe_boot([&](ResetKind kind) {
    booted = kernel_time();
    EXPECT_EQ(kind, ResetKind::kWarm);
  });
  board.reset(ResetKind::kWarm);
  rig.advance(37 * kPsPerUs);  // without what happens at its last picosecond
  EXPECT_EQ(booted, 0u);
  const std::uint64_t before = board.dm365.arm.core().instructions_executed();
  rig.advance(1);
  EXPECT_EQ(booted, 47 * kPsPerUs);
  EXPECT_LE(board.dm365.arm.core().instructions_executed(), before + 1);
  rig.advance(kPsPerUs);
  EXPECT_GT(board.dm365.arm.core().instructions_executed(), before);
}

// A second reset while the first is under way does not start the core earlier or twice.
TEST(ResetTest, AResetDuringAResetIsOneOfTheLaterKind) {
  Resettable c;
  unsigned boots = 0;
  const Subscription boot = c.soc.observe_boot([&](ResetKind kind) {
    ++boots;
    EXPECT_EQ(kind, ResetKind::kPowerOn);
  });
  c.board.reset(ResetKind::kWarm);
  c.rig.advance(3 * kPsPerUs);
  c.board.reset(ResetKind::kPowerOn);
  c.rig.advance(50 * kPsPerUs);
  EXPECT_EQ(boots, 1u);
  EXPECT_EQ(c.read("pll1", 0xE4), 1u);
}

/// The camera's firmware is reset in the middle of capture, remap and display.
class FirmwareReset : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Reset, FirmwareReset, testing::Values(0, 7, 13, 26, 39));

TEST_P(FirmwareReset, ShowsRightFramesAgain) {
  Rig rig;
  rig.set("video.width", "64").set("video.height", "16").set("camera.stamp", "false");
  rig.set("run.frames", "40");
  if (GetParam() % 2 == 1) rig.set("firmware.kernel", "gather");  // the EDMA is reset in the middle of its requests
  board::Board& board = rig.build();
  while (rig.shown().size() < 3) rig.advance(kPsPerMs);
  rig.advance(GetParam() * kPsPerMs + 123'456'789);
  const Picoseconds at = kernel_time();
  const std::uint64_t captures = board.log.captures().size();
  EXPECT_GT(captures, 0u);
  board.reset(ResetKind::kWatchdog);
  rig.run(20 * kPsPerSecond);
  ASSERT_EQ(board.dm365.arm.failure(), "");
  ASSERT_TRUE(board.window_end()) << board.uart_text();
  std::size_t again = 0, before = 0;
  for (const Shown& s : rig.shown()) {
    if (!s.record.captured) continue;  // between the reset and the first frame afterwards
    ASSERT_TRUE(s.record.capture_start && s.record.remap_start);
    std::string difference;
    EXPECT_TRUE(sent_as(rig, s, &difference)) << difference;
    EXPECT_EQ(s.record.captured >= captures, s.record.display_start > at);
    EXPECT_EQ(*s.record.capture_start > at, s.record.display_start > at);
    ++(s.record.display_start > at ? again : before);
  }
  EXPECT_GE(before, 3u);
  EXPECT_GT(again, 5u);
  EXPECT_EQ(board.sink.stats.violations.count(), 0u);
  EXPECT_EQ(board.sink.stats.underflows.count(), 0u);
  for (const auto& [what, times] : rig.diagnostics.counts()) ADD_FAILURE() << times << " times: " << what.second;
}

}  // namespace
}  // namespace fovea::e2e
