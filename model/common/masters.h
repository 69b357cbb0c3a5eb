// Memory masters of the chip, in the order of their master numbers (ties in arbitration go to the
// lower number).
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace fovea {

enum class Master : std::uint8_t {
  kArmI, kArmD,
  kEdmaTc0, kEdmaTc1, kEdmaTc2, kEdmaTc3,
  kVpfe, kVpbe, kRemapEngine,
  kLoad,  // synthetic traffic for experiments; no such master on the chip
  kCount
};
inline constexpr std::size_t kMasterCount = static_cast<std::size_t>(Master::kCount);
/// Names as they appear in statistics: `bus.<name>.read_bytes`.
inline constexpr std::array<std::string_view, kMasterCount> kMasterNames = {
    "arm_i", "arm_d", "edma_tc0", "edma_tc1", "edma_tc2", "edma_tc3",
    "vpfe", "vpbe", "remap_engine", "load"};
constexpr std::size_t index(Master m) { return static_cast<std::size_t>(m); }

}  // namespace fovea
