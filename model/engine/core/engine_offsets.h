// Offsets of the remap engine's registers, as constants for switches; EngineRegs declares what is there.
#pragma once
#include <cstdint>

namespace fovea::engine::at {

inline constexpr std::uint32_t kId = 0x00, kCtrl = 0x04, kStatus = 0x08, kEvents = 0x0C, kEnables = 0x10, kSubmit = 0x14,
                               kEnded = 0x18;
inline constexpr std::uint32_t kClocks = 0x20, kLines = 0x24, kWrites = 0x28, kBad = 0x2C;
/// The job window: from kMode to kC2.
inline constexpr std::uint32_t kMode = 0x40, kSize = 0x44, kSrcBase = 0x48, kSrcPitch = 0x4C, kSrcSize = 0x50,
                               kDstBase = 0x54, kDstPitch = 0x58, kMapBase = 0x5C, kMapWords = 0x60, kBorder = 0x64,
                               kRadiusLimit = 0x68, kCentreX = 0x6C, kCentreY = 0x70;
/// Linear forms: first value, step of a pair, step of a row.
inline constexpr std::uint32_t kA0 = 0x74, kA1 = 0x78, kA2 = 0x7C, kB0 = 0x80, kB1 = 0x84, kB2 = 0x88, kC0 = 0x8C,
                               kC1 = 0x90, kC2 = 0x94;

}  // namespace fovea::engine::at
