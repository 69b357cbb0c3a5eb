#include "model/video/core/bt656.h"

#include <bit>
#include <cstring>

#include "model/common/check.h"

namespace fovea::video {

XyCode decode_xy(std::uint8_t byte) {
  // Valid codes differ in at least four bits, so with one wrong bit the nearest code is unique.
  for (unsigned fvh = 0; fvh < 8; ++fvh) {
    const bool f = fvh & 4, v = fvh & 2, h = fvh & 1;
    const int distance = std::popcount(static_cast<unsigned>(encode_xy(f, v, h) ^ byte));
    if (distance <= 1)
      return {distance ? XyCode::Quality::kCorrected : XyCode::Quality::kGood, f, v, h};
  }
  return {XyCode::Quality::kBad, (byte & 0x40) != 0, (byte & 0x20) != 0, (byte & 0x10) != 0};
}

void compose_line(const Standard& standard, std::uint8_t eav_xy, std::uint8_t sav_xy,
                  const std::uint8_t* active, std::span<std::uint8_t> out) {
  FOVEA_CHECK(out.size() == standard.line_bytes, "line buffer of the wrong size");
  const auto blank = [&out](unsigned from, unsigned to) {
    for (unsigned i = from; i < to; i += 2) {
      out[i] = 0x80;
      out[i + 1] = 0x10;
    }
  };
  const auto code = [&out](unsigned at, std::uint8_t xy) {
    out[at] = 0xFF;
    out[at + 1] = out[at + 2] = 0x00;
    out[at + 3] = xy;
  };
  const unsigned offset = standard.active_offset();
  code(0, eav_xy);
  blank(kCodeBytes, offset - kCodeBytes);
  code(offset - kCodeBytes, sav_xy);
  if (active)
    std::memcpy(out.data() + offset, active, standard.active_bytes());
  else
    blank(offset, standard.line_bytes);
}

}  // namespace fovea::video
