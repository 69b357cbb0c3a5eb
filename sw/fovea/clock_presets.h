// The chip's clocks for the values of `clocks.preset`.
#pragma once
#include <array>
#include <string_view>

#include "model/common/units.h"

namespace fovea::app {

struct ClockPreset {
  std::string_view name;
  Frequency core, ddr;
  /// Frequency of SYSCLK4, the crossbar's clock. SYSCLK7 is twice the SDRAM clock, and PLL1
  /// generates both.
  Frequency scr() const { return half(ddr); }
  static Frequency half(Frequency f) { return Frequency(f.num, 2 * f.den); }
};

inline constexpr std::size_t kClockPresets = 5;
/// In the order of DIP switches 12 to 14; the first one is the default.
const std::array<ClockPreset, kClockPresets>& clock_presets();
/// The preset with this name; the first one if there is none.
const ClockPreset& clock_preset(std::string_view name);

}  // namespace fovea::app
