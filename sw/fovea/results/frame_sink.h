// What takes the frames of a run.
#pragma once
#include <cstdint>

#include "model/video/core/frame.h"
#include "sw/fovea/files/rgb_image.h"

namespace fovea::app {

/// Takes the frames of a run in order, each one valid only during the call. Its functions may throw UserError (disk
/// full), which the board passes on.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// @param pixel of the picture on the screen
  virtual void displayed(const video::Frame& frame, PixelShape pixel) = 0;
  /// Whether sent() is to be called. It costs host time, so it is asked before the run.
  virtual bool wants_sent() const { return false; }
  /// What the camera sent of the frame that was displayed last, woven from its two fields; not for a frame whose
  /// picture is not kept any more (one that is shown very late).
  /// @param index of the displayed frame
  virtual void sent(std::uint64_t /*index*/, const video::Picture& /*picture*/, PixelShape /*pixel*/) {}
};

}  // namespace fovea::app
