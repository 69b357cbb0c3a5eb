// Reads the camera's marks from a corrected picture, using only the oracle's geometry.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>

#include "model/video/scene/stamp.h"
#include "tb/oracle/frame_compare.h"
#include "tb/oracle/lens_oracle.h"

namespace fovea::e2e {

/// Field numbers, modulo 65536, in the pixels of a displayed frame that come from even and odd rows
/// of the camera's picture; empty if the code cannot be read.
struct ShownFields {
  std::optional<std::uint16_t> even, odd;
  std::optional<unsigned> camera;  ///< that both codes name
  std::optional<unsigned> even_camera, odd_camera;  ///< that each names
};

/// @param shown the displayed region; `geometry` maps each of its pixels to a camera pixel
/// @param x, y  position of that region in the camera's picture, whose marks `layout` describes
ShownFields read_stamps(const oracle::Frame& shown, const oracle::Geometry& geometry,
                        const video::StampLayout& layout, unsigned x, unsigned y);

/// The same for any picture. @param position of the camera's pixel that a displayed one shows, in the camera's whole
/// picture; nothing if it shows another camera or none
ShownFields read_stamps(const oracle::Frame& shown, const video::StampLayout& layout,
                        const std::function<std::optional<oracle::Position>(unsigned u, unsigned v)>& position);

/// Where a displayed pixel comes from.
struct SourcePixel {
  oracle::Position at;  ///< in the camera's whole picture
  bool second = false;  ///< of the frame's second field
};
/// A frame's number, modulo 32768, and its camera.
struct ShownFrame {
  unsigned number = 0, camera = 0;
};
/// The same from the rows of both fields together, for a picture that is made smaller, in which neither field shows
/// all cells. Nothing if a cell is in no row, or if the rows of the two fields contradict each other.
std::optional<ShownFrame> read_frame(const oracle::Frame& shown, const video::StampLayout& layout,
                                     const std::function<std::optional<SourcePixel>(unsigned u, unsigned v)>& source);

}  // namespace fovea::e2e
