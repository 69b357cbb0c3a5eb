// What the PLLs can make of the crystal: the rules of the chip, limits at n and n + 1, and the
// nearest clocks.
#include "sw/fovea/config/clock_setting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "model/common/check.h"

namespace fovea::app {
namespace {

using testing::HasSubstr;

Frequency mhz(double f) { return Frequency(static_cast<std::uint64_t>(f * 1e6 + 0.5)); }

/// All that the chip's rules say of a setting, in plain arithmetic.
void expect_right(const board::ClockSetting& s, Frequency core, Frequency ddr) {
  const auto out = [](const param_pll_t& p) {
    return 48e6 * p.multiplier / (p.pre_divider + 1) / (p.post_divider + 1);
  };
  const auto divided = [&](const param_pll_t& p, unsigned n) {
    return out(p) / (p.dividers[n - 1] + 1);
  };
  for (const param_pll_t* p : {&s.pll1, &s.pll2}) {
    EXPECT_GE(p->multiplier, 1);
    EXPECT_LE(p->multiplier, 1023);
    EXPECT_LE(p->pre_divider, 31);
    for (const std::uint8_t d : p->dividers) EXPECT_LE(d, 31);
    EXPECT_GE(out(*p), 270e6);
    EXPECT_LE(out(*p), 680e6);
  }
  EXPECT_NEAR(divided(s.pll2, 2), core.hertz(), 1e-3);
  EXPECT_NEAR(divided(s.pll1, 7), 2 * ddr.hertz(), 1e-3) << "SYSCLK7 is twice the SDRAM clock";
  EXPECT_NEAR(divided(s.pll1, 4), ddr.hertz() / 2, 1e-3) << "EDMA and configuration bus";
  EXPECT_NEAR(divided(s.pll1, 5), ddr.hertz(), 1e-3) << "VPSS";
  EXPECT_NEAR(s.vpss_clk_ctrl == 0x18 ? divided(s.pll1, 6) : divided(s.pll2, 5), 27e6, 1e-3);
}

TEST(ClockSettingTest, PresetsAreThoseOfTheBootLoadersAndTheRulesReachThem) {
  const struct {
    const char* name;
    double core, ddr;
  } rows[] = {{"297/243", 297, 243},
              {"297/270", 297, 270},
              {"270/216", 270, 216},
              {"216/172", 216, 172.5},
              {"432/340", 432, 340}};
  ASSERT_EQ(std::size(rows), board::kClockPresets.size());
  for (std::size_t i = 0; i < std::size(rows); ++i) {
    SCOPED_TRACE(rows[i].name);
    EXPECT_EQ(board::kClockPresets[i].name, rows[i].name);
    expect_right(clock_setting({rows[i].name}), mhz(rows[i].core), mhz(rows[i].ddr));
    const auto found = find_setting(mhz(rows[i].core), mhz(rows[i].ddr));
    ASSERT_TRUE(found);
    expect_right(*found, mhz(rows[i].core), mhz(rows[i].ddr));
  }
  EXPECT_EQ(clock_setting({"297/243"}).pll1.multiplier, 0x51);
}

// Not any setting with the same clocks: that of the boot loader, to the last divider.
TEST(ClockSettingTest, APresetIsTakenAsItIs) {
  const auto all = [](const board::ClockSetting& s) {
    std::vector<unsigned> out{s.vpss_clk_ctrl};
    for (const param_pll_t* p : {&s.pll1, &s.pll2}) {
      out.insert(out.end(), {p->multiplier, p->pre_divider, p->post_divider});
      out.insert(out.end(), std::begin(p->dividers), std::end(p->dividers));
    }
    return out;
  };
  unsigned differ = 0;
  for (const auto& preset : board::kClockPresets) {
    const std::string name(preset.name);
    EXPECT_EQ(all(clock_setting({name})), all(preset.setting)) << name;
    const auto plain = all(preset.setting);
    differ += all(*find_setting(clock_setting({name}).core(), clock_setting({name}).ddr())) != plain;
  }
  EXPECT_GT(differ, 0u) << "some are not what would be found for their clocks";
}

// Clocks of each time, rounded up and less one: tRFC 127.5 ns, tRP and tRCD 20, tWR 15, tRAS 45, tRC 65, a quarter of
// tFAW 12.5, tWTR 10; tXSNR 137.5, tRTP 7.5; a refresh each 7.8 us. In clocks: tRASMAX 8 intervals, tXP 3, tXSRD 200,
// tCKE 4.
TEST(ClockSettingTest, RegistersOfTheSdramHoldThePartsTimes) {
  const DdrRegisters slow = ddr_registers(mhz(243)), fast = ddr_registers(mhz(340));
  EXPECT_EQ(slow.sdtimr, 30u << 25 | 4u << 22 | 4u << 19 | 3u << 16 | 10u << 11 | 15u << 6 | 3u << 3 | 2u);
  EXPECT_EQ(slow.sdtimr2, 7u << 27 | 2u << 25 | 33u << 16 | 199u << 8 | 1u << 5 | 3u);
  EXPECT_EQ(slow.sdrcr, 1895u);
  EXPECT_EQ(fast.sdtimr, 43u << 25 | 6u << 22 | 6u << 19 | 5u << 16 | 15u << 11 | 22u << 6 | 4u << 3 | 3u);
  EXPECT_EQ(fast.sdtimr2, 7u << 27 | 2u << 25 | 46u << 16 | 199u << 8 | 2u << 5 | 3u);
  EXPECT_EQ(fast.sdrcr, 2652u);
}

TEST(ClockSettingTest, OneKeyAloneKeepsTheOtherOfThePreset) {
  expect_right(clock_setting({"297/243", 135'000'000, 0}), mhz(135), mhz(243));
  expect_right(clock_setting({"297/243", 0, 162'000'000}), mhz(297), mhz(162));
  expect_right(clock_setting({"432/340", 0, 135'000'000}), mhz(432), mhz(135));
}

TEST(ClockSettingTest, LimitsHoldAndOneStepBeyondDoesNot) {
  EXPECT_TRUE(find_setting(mhz(297), mhz(125)));
  EXPECT_FALSE(find_setting(mhz(297), mhz(124.875))) << "below the DLL's range; 999/8 can be made";
  EXPECT_TRUE(find_setting(mhz(297), mhz(340)));
  EXPECT_FALSE(find_setting(mhz(297), mhz(340.5))) << "PLL1 would be at 681 MHz";
  EXPECT_TRUE(find_setting(mhz(432), mhz(243)));
  EXPECT_FALSE(find_setting(mhz(432.5), mhz(243)));
  // 270 MHz / 32, the slowest output through the largest divider.
  EXPECT_TRUE(find_setting(Frequency(270'000'000, 32), mhz(243)));
  EXPECT_FALSE(find_setting(Frequency(268'500'000, 32), mhz(243)))
      << "179/32 of 48 MHz can be made";
  // The largest pre-divider, where no multiple of the clock can be the output: 771 MHz are too many.
  EXPECT_TRUE(find_setting(Frequency(48'000'000ull * 257, 32), mhz(243)));
  // 48 MHz M / N with N = 32 and, by 33, not.
  EXPECT_TRUE(find_setting(Frequency(48'000'000ull * 199, 32), mhz(243)));
  EXPECT_FALSE(find_setting(Frequency(48'000'000ull * 205, 33), mhz(243)));
}

TEST(ClockSettingTest, AnUnreachableClockNamesTheNearest) {
  const auto error = [](std::uint64_t core, std::uint64_t ddr) -> std::string {
    try {
      clock_setting({"297/243", core, ddr});
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  };
  // PLL1 at 500 MHz and PLL2 at 300 or 600 are no multiples of 27. 11 and 23 times 27 over 1 and 2
  // are; so are 18 and 19 times 27 over 2 for the SDRAM.
  const std::string both = error(300'000'000, 250'000'000);
  EXPECT_THAT(both, HasSubstr("key 'clocks.arm': "));
  EXPECT_THAT(both, HasSubstr("neither PLL gives the display's 27 MHz"));
  EXPECT_THAT(both, HasSubstr("for clocks.arm: 297MHz and 310.5MHz"));
  EXPECT_THAT(both, HasSubstr("for clocks.ddr: 243MHz and 256.5MHz"));
  // Of what has at most two decimals: 48 M / 4 and 48 M / 25 / 2.
  const std::string core = error(300'000'100, 0);
  EXPECT_THAT(core, HasSubstr("key 'clocks.arm': 300.0001MHz cannot be made"));
  EXPECT_THAT(core, HasSubstr(": 300MHz and 300.48MHz"));
  const std::string ddr = error(0, 120'000'000);
  EXPECT_THAT(ddr, HasSubstr("key 'clocks.ddr': 120MHz"));
  EXPECT_THAT(ddr, HasSubstr(": 125MHz"));
  EXPECT_EQ(error(0, 162'000'000), "");
}

// Every pair of whole megahertz is reached exactly if a search over all registers reaches it.
TEST(ClockSettingTest, AgreesWithASearchOverAllRegisters) {
  /// Outputs 48 M / N in MHz, times 32!-free: N up to 32 has a common multiple that fits into 64
  /// bits.
  const auto reachable = [](std::uint64_t output_mhz) {
    for (std::uint64_t n = 1; n <= 32; ++n)
      for (std::uint64_t m = 1; m <= 1023; ++m)
        if (48 * m == output_mhz * n) return true;
    return false;
  };
  std::array<bool, 681> output{};
  for (std::uint64_t f = 270; f <= 680; ++f) output[f] = reachable(f);
  const auto possible = [&](std::uint64_t core, std::uint64_t ddr) {
    for (std::uint64_t k = 1; k <= 8; ++k)
      for (std::uint64_t d = 1; d <= 32; ++d) {
        const std::uint64_t a = 2 * k * ddr, b = core * d;
        if (a < 270 || a > 680 || b < 270 || b > 680 || !output[a] || !output[b]) continue;
        if (a % 27 == 0 || b % 27 == 0) return true;
      }
    return false;
  };
  unsigned found = 0;
  for (std::uint64_t core = 9; core <= 432; core += 7)
    for (std::uint64_t ddr = 125; ddr <= 340; ++ddr) {
      const auto setting = find_setting(Frequency(core * 1'000'000), Frequency(ddr * 1'000'000));
      ASSERT_EQ(setting.has_value(), possible(core, ddr)) << core << '/' << ddr;
      if (!setting) continue;
      ++found;
      expect_right(*setting, Frequency(core * 1'000'000), Frequency(ddr * 1'000'000));
      if (HasFailure()) return;
    }
  EXPECT_GT(found, 500u);
}

// Times of the part in clocks, by hand: exactly whole clocks, and one step faster.
TEST(DdrRegistersTest, TimesAreRoundedUpAndTheRefreshIntervalDown) {
  const auto field = [](std::uint32_t word, unsigned low, unsigned bits) {
    return word >> low & ((1u << bits) - 1);
  };
  const DdrRegisters at_200 = ddr_registers(mhz(200)), above = ddr_registers(mhz(200.001));
  EXPECT_EQ(field(at_200.sdtimr, 22, 3), 3u) << "tRP 20 ns: 4 clocks";
  EXPECT_EQ(field(above.sdtimr, 22, 3), 4u);
  EXPECT_EQ(field(at_200.sdtimr, 19, 3), 3u) << "tRCD 20 ns";
  EXPECT_EQ(field(above.sdtimr, 19, 3), 4u);
  EXPECT_EQ(field(at_200.sdtimr, 16, 3), 2u) << "tWR 15 ns: 3";
  EXPECT_EQ(field(above.sdtimr, 16, 3), 3u);
  EXPECT_EQ(field(at_200.sdtimr, 11, 5), 8u) << "tRAS 45 ns: 9";
  EXPECT_EQ(field(above.sdtimr, 11, 5), 9u);
  EXPECT_EQ(field(at_200.sdtimr, 6, 5), 12u) << "tRC 65 ns: 13";
  EXPECT_EQ(field(above.sdtimr, 6, 5), 13u);
  EXPECT_EQ(field(at_200.sdtimr, 0, 3), 1u) << "tWTR 10 ns: 2";
  EXPECT_EQ(field(above.sdtimr, 0, 3), 2u);
  EXPECT_EQ(field(at_200.sdtimr, 25, 7), 25u) << "tRFC 127.5 ns: 25.5";
  const DdrRegisters at_160 = ddr_registers(mhz(160)), above_160 = ddr_registers(mhz(160.001));
  EXPECT_EQ(field(at_160.sdtimr, 3, 3), 1u) << "a quarter of tFAW, 12.5 ns: 2";
  EXPECT_EQ(field(above_160.sdtimr, 3, 3), 2u);
  EXPECT_EQ(field(at_160.sdtimr2, 16, 7), 21u) << "tXSNR 137.5 ns: 22";
  EXPECT_EQ(field(above_160.sdtimr2, 16, 7), 22u);
  EXPECT_EQ(field(ddr_registers(Frequency(400'000'000, 3)).sdtimr2, 5, 3), 0u) << "tRTP 7.5 ns: 1";
  EXPECT_EQ(field(ddr_registers(mhz(133.334)).sdtimr2, 5, 3), 1u);
  EXPECT_EQ(field(at_160.sdtimr2, 8, 8), 199u);
  EXPECT_EQ(ddr_registers(mhz(250)).sdrcr, 1950u) << "7.8 us";
  EXPECT_EQ(ddr_registers(mhz(249.999)).sdrcr, 1949u);
  EXPECT_EQ(ddr_registers(mhz(243)).sdrcr, 1895u);
}

}  // namespace
}  // namespace fovea::app
