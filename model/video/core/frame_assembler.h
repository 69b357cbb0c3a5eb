// What a display does with the lines it gets: checks their timing and order, builds frames.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "model/common/units.h"
#include "model/video/core/bt656.h"
#include "model/video/core/picture.h"

namespace fovea::video {

/// One active line as the display receives it.
struct DisplayLine {
  const Standard* standard;
  unsigned number;           ///< line number in the standard
  bool f;                    ///< field bit
  Picoseconds start, end;    ///< first active sample; end of the last one
  const std::uint8_t* uyvy;  ///< kActiveBytes bytes, valid during the call; null: black
  bool window;               ///< the video window was on in this field
  std::uint32_t address;     ///< window 0's base address latched for this field, 0 if off
  unsigned underflows;       ///< bursts that came too late for this line
};

/// A complete displayed frame.
struct DisplayFrame {
  std::uint64_t index;                   ///< frames completed before it
  Picoseconds start, end;                ///< first sample of the first field; end of the last row
  Picture picture;                       ///< 720 x 576 or 720 x 480
  std::array<std::uint32_t, 2> address;  ///< latched buffer address by field
  bool window;                           ///< the video window was on in both fields
  unsigned underflows;                   ///< late bursts in it
  bool repeated;  ///< window on, same addresses and same pixels as in the frame before
};

/// Builds frames of 576 or 480 rows (the first 240 active lines of each field) and checks that
/// lines come in the standard's order, with the right field bit, at the line period of a 27 MHz
/// byte clock (within 2 ps of an unbroken count: edges are rounded down) and of the right length.
class FrameAssembler {
 public:
  std::function<void(const DisplayFrame&)> on_frame;

  void line(const DisplayLine& line);
  /// The raster stopped: the frame under way is dropped, the next line may come at any time.
  void raster_off();

  std::uint64_t frames() const { return frames_; }
  std::uint64_t repeated() const { return repeated_; }
  std::uint64_t broken_frames() const { return broken_; }
  std::uint64_t underflows() const { return underflows_; }
  std::uint64_t violations() const { return violations_; }
  /// The first few violations in words.
  const std::vector<std::string>& messages() const { return messages_; }

 private:
  void check(const DisplayLine& line);
  void violation(const DisplayLine& line, const std::string& what);

  const Standard* standard_ = nullptr;  // null: no line yet
  unsigned last_number_ = 0;
  Picoseconds anchor_ = 0;  // start of the line with count 0
  std::uint64_t lines_since_anchor_ = 0;

  bool open_ = false;
  unsigned rows_ = 0;  // received of the frame under way
  DisplayFrame frame_{};
  Picture previous_;
  std::array<std::uint32_t, 2> previous_address_{};
  bool previous_window_ = false;

  std::uint64_t frames_ = 0, repeated_ = 0, broken_ = 0, underflows_ = 0, violations_ = 0;
  std::vector<std::string> messages_;
};

}  // namespace fovea::video
