// The chip's clocks by `clocks.preset`.
#pragma once
#include <array>
#include <string_view>

#include "model/common/units.h"

namespace fovea::app {

struct ClockPreset {
  std::string_view name;
  Frequency core, ddr;
  /// SYSCLK4, the crossbar's clock. SYSCLK7 is the SDRAM's, and PLL1 makes one of twice the other.
  Frequency scr() const { return half(ddr); }
  static Frequency half(Frequency f) { return Frequency(f.num, 2 * f.den); }
};

inline constexpr std::size_t kClockPresets = 5;
/// In the order of the DIP switches 12 to 14; the first is the default.
const std::array<ClockPreset, kClockPresets>& clock_presets();
/// An unknown name is that of the first.
const ClockPreset& clock_preset(std::string_view name);

}  // namespace fovea::app
