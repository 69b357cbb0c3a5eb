// The frequencies of a PLL controller. No SystemC.
#pragma once
#include <array>
#include <cstdint>

#include "model/common/units.h"

namespace fovea::periph {

inline constexpr unsigned kMaxSysclks = 9;

/// Applies a divider register: bits 4:0 ratio - 1, bit 15 enable. Disabled: the clock is stopped.
constexpr Frequency divided(Frequency f, std::uint32_t divider) {
  return divider & 0x8000u ? f / ((divider & 0x1Fu) + 1) : Frequency{};
}

/// osc x 2 PLLM / (PREDIV + 1): the DM365 doubles the multiplier (Linux clk/davinci, PLL_PLLM_2X).
/// Stopped if PREDIV is disabled or PLLM is 0.
Frequency vco(Frequency oscillator, std::uint32_t pllm, std::uint32_t prediv);

}  // namespace fovea::periph
