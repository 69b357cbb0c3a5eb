// The PLLs' settings: what they make of the board's 24 MHz crystal, and the pairs of clocks that public boot loaders
// program. One declaration for the words of `clocks.preset`, the parameter page, `fovea exec` and `fovea replay`.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/units.h"
#include "model/contract/param_page.h"

namespace fovea::board {

inline constexpr Frequency kCrystal{24'000'000};
/// What the display's encoder needs.
inline constexpr Frequency kEncoderClock{27'000'000};

/// The PLL doubles its multiplier (Linux clk/davinci, PLL_PLLM_2X).
constexpr Frequency pll_output(const param_pll_t& p) {
  return kCrystal * (2ull * p.multiplier) / (p.pre_divider + 1ull) / (p.post_divider + 1ull);
}
/// @param n number of the SYSCLK, from 1
constexpr Frequency sysclk(const param_pll_t& p, unsigned n) {
  return pll_output(p) / (p.dividers[n - 1] + 1ull);
}

/// Values of VPSS_CLK_CTRL: the encoder's clock is PLL1 SYSCLK6 or PLL2 SYSCLK5.
inline constexpr std::uint32_t kEncoderFromPll1 = 0x18, kEncoderFromPll2 = 0x38;

/// PLL1 gives the clocks of SDRAM, crossbar and video, PLL2 that of the core.
struct ClockSetting {
  param_pll_t pll1{}, pll2{};
  std::uint32_t vpss_clk_ctrl = 0;
  constexpr Frequency core() const { return sysclk(pll2, 2); }
  /// SYSCLK7 is twice the SDRAM clock.
  constexpr Frequency ddr() const { return sysclk(pll1, 7) / 2; }
  /// Clock of crossbar and configuration bus.
  constexpr Frequency scr() const { return sysclk(pll1, 4); }
  constexpr Frequency encoder() const {
    return vpss_clk_ctrl == kEncoderFromPll1 ? sysclk(pll1, 6) : sysclk(pll2, 5);
  }
  static constexpr Frequency half(Frequency f) { return f / 2; }
};

struct ClockPreset {
  std::string_view name;  ///< core / SDRAM in MHz, rounded down
  ClockSetting setting;
  constexpr Frequency core() const { return setting.core(); }
  constexpr Frequency ddr() const { return setting.ddr(); }
  constexpr Frequency scr() const { return setting.scr(); }
};

/// Settings of TI's boot loader for the DM36x (UBL, device.c) and, for 432/340, of U-Boot (cam_enc_4xx.h). The first
/// one is the default.
inline constexpr std::array<ClockPreset, 5> kClockPresets = {{
    {"297/243", {{0x51, 7, 0, {0x13, 1, 1, 3, 1, 0x11, 0, 4, 1}, {}},
                 {0x63, 7, 0, {0x18, 1, 1, 0x1C, 7}, {}}, kEncoderFromPll1}},
    {"297/270", {{0x2D, 3, 0, {0x0C, 1, 1, 3, 1, 0x13, 0, 5, 1}, {}},
                 {0x63, 7, 0, {0x18, 1, 1, 0x1C, 7}, {}}, kEncoderFromPll1}},
    {"270/216", {{0x09, 0, 0, {0x11, 1, 1, 3, 1, 5, 0, 3, 1}, {}},
                 {0x2D, 7, 0, {0x0A, 0, 0, 5, 9}, {}}, kEncoderFromPll2}},
    {"216/172", {{0x73, 15, 0, {0x0D, 1, 1, 3, 1, 0x0C, 0, 3, 1}, {}},
                 {0x12, 1, 0, {0x11, 1, 1, 0x14, 0x0F}, {}}, kEncoderFromPll2}},
    {"432/340", {{0x55, 5, 0, {0x1B, 1, 1, 3, 1, 8, 0, 6, 0x1B}, {}},
                 {0x09, 0, 0, {0x11, 0, 1, 0x14, 0x0F}, {}}, kEncoderFromPll2}},
}};

/// Whether the name says what the setting gives, and the encoder has its clock.
constexpr bool true_to_its_name(const ClockPreset& p) {
  std::uint64_t named[2] = {};
  unsigned part = 0;
  for (const char c : p.name) {
    if (c == '/')
      ++part;
    else
      named[part] = 10 * named[part] + static_cast<std::uint64_t>(c - '0');
  }
  const auto megahertz = [](Frequency f) { return f.num / (f.den * 1'000'000); };
  return megahertz(p.core()) == named[0] && megahertz(p.ddr()) == named[1] && p.scr() == p.ddr() / 2 &&
         p.setting.encoder() == kEncoderClock;
}
static_assert([] {
  for (const ClockPreset& p : kClockPresets)
    if (!true_to_its_name(p)) return false;
  return true;
}());

/// The preset with this name; the first one if there is none.
constexpr const ClockPreset& clock_preset(std::string_view name) {
  for (const ClockPreset& p : kClockPresets)
    if (p.name == name) return p;
  return kClockPresets.front();
}

inline std::vector<std::string> clock_preset_names(std::vector<std::string> before = {}) {
  for (const ClockPreset& p : kClockPresets) before.emplace_back(p.name);
  return before;
}

/// The slowest and the fastest of the presets.
constexpr Frequency least(Frequency (*of)(const ClockPreset&)) {
  Frequency f = of(kClockPresets.front());
  for (const ClockPreset& p : kClockPresets)
    if (const Frequency x = of(p); x.num * f.den < f.num * x.den) f = x;
  return f;
}
constexpr Frequency most(Frequency (*of)(const ClockPreset&)) {
  Frequency f = of(kClockPresets.front());
  for (const ClockPreset& p : kClockPresets)
    if (const Frequency x = of(p); x.num * f.den > f.num * x.den) f = x;
  return f;
}

}  // namespace fovea::board
