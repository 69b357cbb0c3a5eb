// Where the remap engine's registers and their fields are, as constants for the model's hot paths; EngineRegs declares
// with them what is there.
#pragma once
#include <cstdint>

namespace fovea::engine::at {

inline constexpr std::uint32_t kId = 0x00, kCtrl = 0x04, kStatus = 0x08, kEvents = 0x0C, kEnables = 0x10,
                               kSubmit = 0x14, kEnded = 0x18;
inline constexpr std::uint32_t kClocks = 0x20, kLines = 0x24, kWrites = 0x28, kBad = 0x2C;
/// The job window: from kMode to kC2.
inline constexpr std::uint32_t kMode = 0x40, kSize = 0x44, kSrcBase = 0x48, kSrcPitch = 0x4C, kSrcSize = 0x50,
                               kDstBase = 0x54, kDstPitch = 0x58, kMapBase = 0x5C, kMapWords = 0x60, kBorder = 0x64,
                               kRadiusLimit = 0x68, kCentreX = 0x6C, kCentreY = 0x70;
/// Linear forms: first value, step of a pair, step of a row.
inline constexpr std::uint32_t kA0 = 0x74, kA1 = 0x78, kA2 = 0x7C, kB0 = 0x80, kB1 = 0x84, kB2 = 0x88, kC0 = 0x8C,
                               kC1 = 0x90, kC2 = 0x94;
inline constexpr std::uint32_t kRegisterWords = kC2 / 4 + 1;  ///< up to the last register

}  // namespace fovea::engine::at

namespace fovea::engine {

/// Some bits of a register.
struct Bits {
  unsigned lsb, width;
  constexpr std::uint32_t low() const { return width == 32 ? ~0u : (1u << width) - 1; }
  constexpr std::uint32_t mask() const { return low() << lsb; }
  constexpr std::uint32_t of(std::uint32_t word) const { return word >> lsb & low(); }
  constexpr std::uint32_t put(std::uint32_t value) const { return (value & low()) << lsb; }
};

namespace bits {

inline constexpr Bits kEnable{0, 1}, kAbort{1, 1};                                      // CTRL
inline constexpr Bits kBusy{0, 1}, kQueued{4, 4}, kFull{8, 1};                          // STATUS
inline constexpr Bits kDone{0, 1}, kRefused{1, 1}, kReadError{2, 1}, kWriteError{3, 1}, kAborted{4, 1},
    kOverflow{5, 1}, kDropped{6, 1}, kAllEvents{0, 7};                                  // EVENTS, ENABLES
inline constexpr Bits kTag{0, 8};                                                       // SUBMIT
inline constexpr Bits kEndedTag{0, 8}, kEndedEvents{8, 8}, kEndedCount{16, 16};         // ENDED
inline constexpr Bits kRemapMode{0, 2}, kBilinear{2, 1}, kGridLog2{8, 3}, kPieces{16, 8}, kPieceLog2{24, 5};  // MODE
inline constexpr Bits kPairs{0, 12}, kRows{16, 13};                                     // SIZE
inline constexpr Bits kWidth{0, 13}, kHeight{16, 13};                                   // SRC_SIZE
inline constexpr Bits kBase{2, 30}, kPitch{2, 13}, kMapBase{6, 26};  // of the registers with addresses and pitches
inline constexpr Bits kMapWords{0, 24};                                                 // MAP_WORDS

}  // namespace bits
}  // namespace fovea::engine
