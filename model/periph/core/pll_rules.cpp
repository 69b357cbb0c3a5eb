#include "model/periph/core/pll_rules.h"

namespace fovea::periph {

Frequency vco(Frequency oscillator, std::uint32_t pllm, std::uint32_t prediv) {
  return divided(oscillator * (2ull * (pllm & 0x3FFu)), prediv);
}

}  // namespace fovea::periph
