#include "model/video/tvp5146_settings.h"

namespace fovea::video {
namespace {

/// A field of which the model implements the values `low` to `high`; none at all if low > high.
struct Setting {
  std::uint8_t index;
  const char* name;
  const char* what;
  std::uint8_t mask, low, high;
};
constexpr Setting whole(std::uint8_t index, const char* name, const char* what, std::uint8_t only) {
  return {index, name, what, 0xFF, only, only};
}
/// What a value does depends on the standard or on the signal, and the value that does nothing is not known.
constexpr Setting never(std::uint8_t index, const char* name, const char* what) {
  return {index, name, what, 0xFF, 1, 0};
}

constexpr const char *kLevel = "level of luma or colour", *kLuma = "luma processing", *kColour = "colour processing",
                     *kScart = "SCART and colour transients", *kCodes = "position of the timing codes",
                     *kBlanking = "lines of the vertical blanking", *kGain = "automatic gain",
                     *kBits = "F and V of signals with other numbers of lines", *kUnsteady = "unsteady signals";

/// TI SLES084C; names and subaddresses as in Linux's tvp514x_regs.h, and the values of reset of its tvp514x.c. Those
/// of 33: SLES099C (TVP5147), whose text on this register is the same.
constexpr Setting kSettings[] = {
    whole(0x01, "AFE_GAIN_CTRL", kGain, 0x0F),
    {0x02, "VIDEO_STD", "standard", 0x07, 0, 2},
    whole(0x04, "AUTOSWITCH_MASK", "standards that are recognised", 0x3F),
    whole(0x05, "COLOR_KILLER", kColour, 0x10),
    whole(0x06, "LUMA_CONTROL1", kLuma, 0),
    whole(0x07, "LUMA_CONTROL2", kLuma, 0),
    whole(0x08, "LUMA_CONTROL3", kLuma, 2),
    whole(0x09, "BRIGHTNESS", kLevel, 0x80),
    whole(0x0A, "CONTRAST", kLevel, 0x80),
    whole(0x0B, "SATURATION", kLevel, 0x80),
    whole(0x0C, "HUE", kColour, 0),
    whole(0x0D, "CHROMA_CONTROL1", kColour, 0),
    whole(0x0E, "CHROMA_CONTROL2", kColour, 0x0E),
    whole(0x10, "COMP_PR_SATURATION", kLevel, 0x80),
    whole(0x11, "COMP_Y_CONTRAST", kLevel, 0x80),
    whole(0x12, "COMP_PB_SATURATION", kLevel, 0x80),
    whole(0x14, "COMP_Y_BRIGHTNESS", kLevel, 0x80),
    never(0x16, "AVID_START_PIXEL_LSB", kCodes),
    never(0x17, "AVID_START_PIXEL_MSB", kCodes),
    never(0x18, "AVID_STOP_PIXEL_LSB", kCodes),
    never(0x19, "AVID_STOP_PIXEL_MSB", kCodes),
    never(0x22, "VBLK_START_LINE_LSB", kBlanking),
    never(0x23, "VBLK_START_LINE_MSB", kBlanking),
    never(0x24, "VBLK_STOP_LINE_LSB", kBlanking),
    never(0x25, "VBLK_STOP_LINE_MSB", kBlanking),
    whole(0x28, "FAST_SWITCH_CONTROL", kScart, 0xCC),
    whole(0x2A, "FAST_SWITCH_SCART_DELAY", kScart, 0),
    whole(0x2C, "SCART_DELAY", kScart, 0),
    whole(0x2D, "CTI_DELAY", kScart, 0),
    whole(0x2E, "CTI_CONTROL", kScart, 0),
    {0x33, "OUTPUT_FORMATTER1.FORMAT", "output format", 0x07, 0, 0},
    {0x33, "OUTPUT_FORMATTER1.CBCR_CODE", "code of the colour samples", 0x20, 0, 0},
    {0x33, "OUTPUT_FORMATTER1.CODE_RANGE", "range of the samples", 0x40, 0, 0},
    {0x33, "OUTPUT_FORMATTER1.SAMPLING", "sampling rate", 0x80, 0, 0},
    {0x34, "OUTPUT_FORMATTER2.CLK_POLARITY", "edge of the data clock", 0x02, 0, 0},
    never(0x69, "FBIT_VBIT_CONTROL1", kBits),
    never(0x6C, "BACKEND_AGC_CONTROL", kGain),
    never(0x6F, "AGC_DECREMENT_SPEED_CONTROL", kGain),
    never(0x74, "AGC_WHITE_PEAK_PROCESSING", kGain),
    never(0x75, "FBIT_VBIT_CONTROL2", kBits),
    never(0x76, "VCR_TRICK_MODE_CONTROL", kUnsteady),
    never(0x77, "HORIZONTAL_SHAKE_INCREMENT", kUnsteady),
    never(0x78, "AGC_INCREMENT_SPEED", kGain),
    never(0x79, "AGC_INCREMENT_DELAY", kGain),
    never(0x83, "CPLL_SPEED_CONTROL", kColour),
    never(0x9E, "AGC_DECREMENT_DELAY", kGain),
};
/// A field's value, counted from its lowest bit.
unsigned asked_of(const Setting& s, std::uint8_t value) { return (value & s.mask) / (s.mask & -unsigned{s.mask}); }

std::string hex_of(unsigned byte) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  return {kDigits[byte / 16], kDigits[byte % 16]};
}

std::string modelled(const Setting& s) {
  if (s.low > s.high) return "what it does is not modelled";
  if (s.low == s.high) return "only " + (s.mask == 0xFF ? hex_of(s.low) : std::to_string(s.low)) + " is modelled";
  return "only " + std::to_string(s.low) + " to " + std::to_string(s.high) + " are modelled";
}

}  // namespace

std::vector<std::string> decoder_not_modelled(std::uint8_t index, std::uint8_t value) {
  std::vector<std::string> out;
  for (const Setting& s : kSettings) {
    if (s.index != index) continue;
    const unsigned asked = asked_of(s, value);
    if (asked >= s.low && asked <= s.high) continue;
    out.push_back(std::string("TVP5146 ") + s.name + " (" + hex_of(index) + ", " + s.what + "): " + modelled(s));
  }
  return out;
}

std::array<std::uint8_t, 256> decoder_reset_values() {
  std::array<std::uint8_t, 256> out{};
  for (const Setting& s : kSettings)
    if (s.mask == 0xFF && s.low == s.high) out[s.index] = s.low;
  out[0x33] = 0x40;  // the extended range of samples, which is not modelled
  return out;
}

}  // namespace fovea::video
