// The settings of PLLs and SDRAM controller for the clocks that an experiment asks for.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/board/clock_presets.h"

namespace fovea::app {

/// The clocks of an experiment: a preset, or other clocks of core and SDRAM (0: the preset's).
struct WantedClocks {
  std::string_view preset;
  std::uint64_t core = 0, ddr = 0;  // Hz
};

/// How the chip's PLLs give these clocks: from the 24 MHz crystal, with a PLL's output within the
/// range that public boot loaders program, and with 27 MHz for the display's encoder from one of
/// the two PLLs.
/// @throws UserError that names the nearest clocks that can be had
board::ClockSetting clock_setting(const WantedClocks& wanted);

/// The setting without the message; nothing if there is none.
std::optional<board::ClockSetting> find_setting(Frequency core, Frequency ddr);

/// Words of the SDRAM controller's timing registers for the times of the 1 Gb DDR2-667 part that
/// TI's boot loader uses, in clocks of this frequency, rounded up; the refresh interval is rounded
/// down.
struct DdrRegisters {
  std::uint32_t sdtimr = 0, sdtimr2 = 0, sdrcr = 0;
};
DdrRegisters ddr_registers(Frequency ddr_clock);

}  // namespace fovea::app
