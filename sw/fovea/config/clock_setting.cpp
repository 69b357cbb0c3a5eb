#include "sw/fovea/config/clock_setting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/common/check.h"

namespace fovea::app {
namespace {

using board::ClockPreset;
using board::ClockSetting;

constexpr bool less(Frequency a, Frequency b) { return a.num * b.den < b.num * a.den; }

// Widths of the registers' fields: PLLM has 10 bits, each divider's ratio - 1 has 5.
constexpr std::uint64_t kMostMultiplier = 1023, kMostDivider = 32;
// What the outputs of the PLLs may be is not public; within what public boot loaders program they
// work.
constexpr auto kOutput1 = [](const ClockPreset& p) { return board::pll_output(p.setting.pll1); };
constexpr auto kOutput2 = [](const ClockPreset& p) { return board::pll_output(p.setting.pll2); };
constexpr Frequency lower(Frequency a, Frequency b) { return less(a, b) ? a : b; }
constexpr Frequency upper(Frequency a, Frequency b) { return less(a, b) ? b : a; }
constexpr Frequency kLeastOutput = lower(board::least(kOutput1), board::least(kOutput2));
constexpr Frequency kMostOutput = upper(board::most(kOutput1), board::most(kOutput2));
constexpr Frequency kMostCore = board::most([](const ClockPreset& p) { return p.core(); });
constexpr Frequency kMostDdr = board::most([](const ClockPreset& p) { return p.ddr(); });
/// JESD79-2: the DLL of a DDR2 part locks with a period of 8 ns at most.
constexpr Frequency kLeastDdr{125'000'000};

std::uint8_t code(std::uint64_t ratio) {
  return static_cast<std::uint8_t>(std::clamp<std::uint64_t>(ratio, 1, kMostDivider) - 1);
}
/// Whole ratios of two frequencies.
std::uint64_t down(Frequency a, Frequency b) { return a.num * b.den / (a.den * b.num); }
std::uint64_t up(Frequency a, Frequency b) {
  return (a.num * b.den + a.den * b.num - 1) / (a.den * b.num);
}
bool divides(Frequency a, Frequency b) {
  return a.num * b.den % (a.den * b.num) == 0 && down(a, b) <= kMostDivider;
}

/// Multiplier and pre-divider for an output, if there are any: the smallest.
std::optional<param_pll_t> pll_for(Frequency output) {
  if (less(output, kLeastOutput) || less(kMostOutput, output)) return std::nullopt;
  const Frequency reference = board::kCrystal * 2;
  const Frequency ratio(output.num * reference.den, output.den * reference.num);
  if (ratio.num > kMostMultiplier || ratio.den > kMostDivider) return std::nullopt;
  param_pll_t pll{};
  pll.multiplier = static_cast<std::uint16_t>(ratio.num);
  pll.pre_divider = code(ratio.den);
  return pll;
}

/// All settings of PLL1 for an SDRAM clock: its output is 2, 4, ... times that clock, and the other
/// ratios follow.
std::vector<param_pll_t> first_plls(Frequency ddr) {
  std::vector<param_pll_t> out;
  for (std::uint64_t k = 1; 4 * k <= kMostDivider; ++k) {
    const Frequency output = ddr * (2 * k);
    auto pll = pll_for(output);
    if (!pll) continue;
    // SYSCLK1 and SYSCLK8 (memory cards) near those of the presets; HDVICP, MJCP, EDMA, VPSS,
    // encoder, SDRAM, CLKOUT.
    const std::uint8_t dividers[9] = {code(down(output, Frequency(24'000'000))),
                                      code(2 * k),
                                      code(2 * k),
                                      code(4 * k),
                                      code(2 * k),
                                      code(up(output, board::kEncoderClock)),
                                      code(k),
                                      code(up(output, Frequency(108'000'000))),
                                      code(2 * k)};
    std::copy(std::begin(dividers), std::end(dividers), pll->dividers);
    out.push_back(*pll);
  }
  return out;
}

/// All settings of PLL2 for a core clock.
std::vector<param_pll_t> second_plls(Frequency core) {
  std::vector<param_pll_t> out;
  for (std::uint64_t d = 1; d <= kMostDivider; ++d) {
    const Frequency output = core * d;
    auto pll = pll_for(output);
    if (!pll) continue;
    // SYSCLK1 near that of the presets; core, SDRAM (not used), voice codec, encoder.
    const std::uint8_t dividers[5] = {code(down(output, Frequency(24'000'000))), code(d), code(2),
                                      code(down(output, Frequency(20'000'000))),
                                      code(up(output, board::kEncoderClock))};
    std::copy(std::begin(dividers), std::end(dividers), pll->dividers);
    out.push_back(*pll);
  }
  return out;
}

std::string megahertz(Frequency f) { return fmt::format("{:.9g}MHz", f.hertz() * 1e-6); }

/// The nearest clock below and above `wanted`, in steps of 10 kHz, for which `possible` holds:
/// clocks that can be written down. Empty if there is none.
template <class Possible>
std::string nearest(Frequency wanted, Frequency most, Possible possible) {
  constexpr std::uint64_t kStep = 10'000;
  const auto hertz = static_cast<std::uint64_t>(wanted.hertz());
  std::string out;
  for (std::uint64_t f = (hertz - 1) / kStep * kStep; f >= kStep; f -= kStep)
    if (possible(Frequency(f))) {
      out = megahertz(Frequency(f));
      break;
    }
  for (std::uint64_t f = (hertz / kStep + 1) * kStep; !less(most, Frequency(f)); f += kStep)
    if (possible(Frequency(f))) {
      out += (out.empty() ? "" : " and ") + megahertz(Frequency(f));
      break;
    }
  return out.empty() ? "none" : out;
}

}  // namespace

std::optional<ClockSetting> find_setting(Frequency core, Frequency ddr) {
  if (less(kMostCore, core) || less(ddr, kLeastDdr) || less(kMostDdr, ddr)) return std::nullopt;
  for (const bool first : {true, false})
    for (const param_pll_t& pll1 : first_plls(ddr))
      for (const param_pll_t& pll2 : second_plls(core))
        if (divides(board::pll_output(first ? pll1 : pll2), board::kEncoderClock))
          return ClockSetting{pll1, pll2,
                              first ? board::kEncoderFromPll1 : board::kEncoderFromPll2};
  return std::nullopt;
}

ClockSetting clock_setting(const WantedClocks& wanted) {
  const ClockPreset& preset = board::clock_preset(wanted.preset);
  if (wanted.core == 0 && wanted.ddr == 0) return preset.setting;
  const Frequency core = wanted.core ? Frequency(wanted.core) : preset.core();
  const Frequency ddr = wanted.ddr ? Frequency(wanted.ddr) : preset.ddr();
  if (const auto found = find_setting(core, ddr)) return *found;
  const auto core_fits = [&](Frequency f) { return find_setting(f, ddr).has_value(); };
  const auto ddr_fits = [&](Frequency f) { return find_setting(core, f).has_value(); };
  if (wanted.ddr && (less(ddr, kLeastDdr) || first_plls(ddr).empty()))
    throw UserError(fmt::format(
        "key 'clocks.ddr': {} cannot be made from the 24 MHz crystal, or is below 125 MHz; "
        "nearest with a core clock of {}: {}",
        megahertz(ddr), megahertz(core), nearest(ddr, kMostDdr, ddr_fits)));
  if (wanted.core && second_plls(core).empty())
    throw UserError(fmt::format(
        "key 'clocks.arm': {} cannot be made from the 24 MHz crystal; nearest with an SDRAM "
        "clock of {}: {}",
        megahertz(core), megahertz(ddr), nearest(core, kMostCore, core_fits)));
  throw UserError(fmt::format(
      "key 'clocks.{}': with {} for the core and {} for the SDRAM neither PLL gives the "
      "display's 27 MHz; nearest for clocks.arm: {}; for clocks.ddr: {}",
      wanted.core ? "arm" : "ddr", megahertz(core), megahertz(ddr),
      nearest(core, kMostCore, core_fits), nearest(ddr, kMostDdr, ddr_fits)));
}

DdrRegisters ddr_registers(Frequency ddr_clock) {
  /// A time in 0.1 ns in clocks, rounded up, minus 1: the encoding of the fields.
  const auto field = [&](std::uint64_t tenths_of_ns) {
    const std::uint64_t den = ddr_clock.den * 10'000'000'000ull;
    return static_cast<std::uint32_t>((tenths_of_ns * ddr_clock.num + den - 1) / den) - 1;
  };
  // T_RRD is a quarter of tFAW (50 ns) instead of tRRD (10 ns): the controller has no field for
  // tFAW, and with T_RRD >= tFAW / 4 any five activations are far enough apart.
  constexpr std::uint64_t kRfc = 1275, kRp = 200, kRcd = 200, kWr = 150, kRas = 450, kRc = 650,
                          kFawQuarter = 125, kWtr = 100, kXsnr = 1375, kRtp = 75;
  // Rows stay open for 70 us at most, in refresh intervals of 7.8 us, minus 1 (TI's loader
  // overflows this field).
  constexpr std::uint32_t kRasMax = 7, kXp = 2, kXsrd = 199, kCke = 3;
  DdrRegisters out;
  out.sdtimr = field(kRfc) << 25 | field(kRp) << 22 | field(kRcd) << 19 | field(kWr) << 16 |
               field(kRas) << 11 | field(kRc) << 6 | field(kFawQuarter) << 3 | field(kWtr);
  out.sdtimr2 =
      kRasMax << 27 | kXp << 25 | field(kXsnr) << 16 | kXsrd << 8 | field(kRtp) << 5 | kCke;
  out.sdrcr = static_cast<std::uint32_t>(ddr_clock.num * 78 / (ddr_clock.den * 10'000'000));
  return out;
}

}  // namespace fovea::app
