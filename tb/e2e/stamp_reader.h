// Reads the camera's marks back from a corrected picture, by the oracle's geometry alone.
#pragma once
#include <cstdint>
#include <optional>

#include "model/video/scene/stamp.h"
#include "tb/oracle/frame_compare.h"
#include "tb/oracle/lens_oracle.h"

namespace fovea::e2e {

/// Field numbers, modulo 65536, that a displayed frame shows in the pixels that come from even and
/// from odd rows of the camera's picture; nothing where the code cannot be read.
struct ShownFields {
  std::optional<std::uint16_t> even, odd;
};

/// @param shown the displayed region; `geometry` says which camera pixel each of its pixels shows
/// @param x, y  where that region begins in the camera's picture, whose marks `layout` describes
ShownFields read_stamps(const oracle::Frame& shown, const oracle::Geometry& geometry,
                        const video::StampLayout& layout, unsigned x, unsigned y);

}  // namespace fovea::e2e
