// The display: checks the timing and order of the lines that it receives, and assembles frames.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "model/common/units.h"
#include "model/video/core/bt656.h"
#include "model/video/core/frame.h"

namespace fovea::video {

/// An active line as the display receives it.
struct DisplayLine {
  const Standard* standard;
  unsigned number;           ///< line number in the standard
  bool f;                    ///< field bit
  Picoseconds start, end;    ///< start of the first active sample and end of the last one
  const std::uint8_t* uyvy;  ///< kActiveBytes bytes, valid during the call; null: a black line
};

/// Assembles frames of 576 or 480 rows (for 525/60 the first 240 active lines of each field, or 243: `rows_525`).
/// Checks that lines come in the order of the standard with the right field bit, that they have the
/// right length, and that they start at the line period of a 27 MHz byte clock (within 2 ps of an
/// uninterrupted count, because edges are rounded down).
class FrameAssembler {
 public:
  /// Called for each whole frame with its picture, the times of its display and, as its index, the number of frames
  /// before it. The receiver may complete it.
  std::function<void(Frame&)> on_frame;
  unsigned rows_525 = 480;  ///< rows of a picture in 525/60: 480, or the 486 of all lines that both fields have

  void line(const DisplayLine& line);
  /// The raster has stopped: the incomplete frame is dropped, and the next line may come at any
  /// time.
  void raster_off();

  /// During on_frame: whether the frame's pixels are those of the whole frame before it.
  bool unchanged() const { return frame_.picture == previous_; }
  std::uint64_t frames() const { return frames_; }
  std::uint64_t broken_frames() const { return broken_; }
  std::uint64_t violations() const { return violations_; }
  /// Descriptions of the first few violations.
  const std::vector<std::string>& messages() const { return messages_; }

 private:
  void check(const DisplayLine& line);
  void violation(const DisplayLine& line, const std::string& what);

  const Standard* standard_ = nullptr;  // null: no line so far
  unsigned last_number_ = 0;
  Picoseconds anchor_ = 0;  // start of the line with count 0
  std::uint64_t lines_since_anchor_ = 0;

  bool open_ = false;
  unsigned rows_ = 0;  // rows of the current frame received so far
  Frame frame_;
  Picture previous_;

  std::uint64_t frames_ = 0, broken_ = 0, violations_ = 0;
  std::vector<std::string> messages_;
};

}  // namespace fovea::video
