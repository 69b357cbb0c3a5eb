// Memory masters of the chip: each is a port of the crossbar, ordered and arbitrated by itself.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace fovea {

/// Equal priorities take turns in the order of these numbers. They stand in bus traces: a new master
/// goes to the end. Read and write side of a transfer controller are masters of their own.
enum class Master : std::uint8_t {
  kArmI, kArmD,
  kEdmaTc0Read, kEdmaTc1Read, kEdmaTc2Read, kEdmaTc3Read,
  kVpfe, kVpbe, kRemapEngine,
  kLoad,  // synthetic traffic for experiments; no such master on the chip
  kEdmaTc0Write, kEdmaTc1Write, kEdmaTc2Write, kEdmaTc3Write,
  kCount
};
inline constexpr std::size_t kMasterCount = static_cast<std::size_t>(Master::kCount);
constexpr std::size_t index(Master m) { return static_cast<std::size_t>(m); }
/// Of ports.
inline constexpr std::array<std::string_view, kMasterCount> kMasterNames = {
    "arm_i", "arm_d", "edma_tc0_read", "edma_tc1_read", "edma_tc2_read", "edma_tc3_read",
    "vpfe", "vpbe", "remap_engine", "load",
    "edma_tc0_write", "edma_tc1_write", "edma_tc2_write", "edma_tc3_write"};

inline constexpr unsigned kTransferControllers = 4;
constexpr Master edma_read(unsigned tc) {
  return static_cast<Master>(index(Master::kEdmaTc0Read) + tc);
}
constexpr Master edma_write(unsigned tc) {
  return static_cast<Master>(index(Master::kEdmaTc0Write) + tc);
}

/// Names as they appear in statistics and parameters, `bus.<name>.read_bytes`: both sides of a
/// transfer controller go by one.
inline constexpr std::size_t kStatCount = kMasterCount - kTransferControllers;
inline constexpr std::array<std::string_view, kStatCount> kStatNames = {
    "arm_i", "arm_d", "edma_tc0", "edma_tc1", "edma_tc2", "edma_tc3",
    "vpfe", "vpbe", "remap_engine", "load"};
constexpr std::size_t stat_index(Master m) {
  return index(m) < kStatCount ? index(m)
                               : index(m) - index(Master::kEdmaTc0Write) +
                                     index(Master::kEdmaTc0Read);
}
constexpr std::string_view stat_name(Master m) { return kStatNames[stat_index(m)]; }

}  // namespace fovea
