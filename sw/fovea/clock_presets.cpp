#include "sw/fovea/clock_presets.h"

namespace fovea::app {

const std::array<ClockPreset, kClockPresets>& clock_presets() {
  static const std::array<ClockPreset, kClockPresets> all = {{
      {"297/243", Frequency(297'000'000), Frequency(243'000'000)},
      {"297/270", Frequency(297'000'000), Frequency(270'000'000)},
      {"270/216", Frequency(270'000'000), Frequency(216'000'000)},
      {"216/172", Frequency(216'000'000), Frequency(172'500'000)},
      {"432/340", Frequency(432'000'000), Frequency(340'000'000)},
  }};
  return all;
}

const ClockPreset& clock_preset(std::string_view name) {
  for (const ClockPreset& p : clock_presets())
    if (p.name == name) return p;
  return clock_presets().front();
}

}  // namespace fovea::app
