// A displayed frame: whose it is, when it was captured, corrected and shown, and its picture.
#pragma once
#include <cstdint>
#include <optional>

#include "model/common/units.h"
#include "model/video/core/picture.h"

namespace fovea::video {

/// The way of a frame from the camera to the display: a row of frames.csv. Times are in ps since power-up.
struct FrameTimes {
  std::uint64_t index = 0;      ///< number of the displayed frame, since the first one that the firmware brought
  unsigned camera = kNoCamera;  ///< whose frame it shows; kNoCamera: a black one
  std::optional<std::uint64_t> captured;  ///< number of the captured frame that it shows
  /// Empty where they are not known: a frame that is shown without a remap has no times of one.
  std::optional<Picoseconds> capture_start, capture_end, remap_start, remap_end;
  Picoseconds display_start = 0, display_end = 0;  ///< start of its first sample, end of its last row
  std::uint64_t dropped = 0;  ///< captured frames that were skipped since the frame before
  bool repeated = false;      ///< shows the same captured frame as the one before
  /// Repeated, but no newer frame could be on show yet: the decoder had to find the syncs. Not in frames.csv.
  bool relock = false;
};

/// The display makes it of the lines that it receives, and the board adds what it knows of its way.
struct Frame {
  FrameTimes times;
  Picture picture;          ///< 720 x 576, or 720 x 480 or 486 pixels
  unsigned underflows = 0;  ///< bursts of this frame that arrived too late
};

}  // namespace fovea::video
