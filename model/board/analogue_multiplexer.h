// An analogue multiplexer between the cameras and one input of the video decoder.
#pragma once
#include <array>
#include <functional>
#include <optional>

#include "model/contract/multiplexer.h"

namespace fovea::board {

/// Eight inputs, one output, three select lines, as of a CD4051B or a video switch. It switches at once: such a part
/// takes less than a microsecond (TI SCHS047: 720 ns at the most), and the decoder completes the line on the wire,
/// which takes 64 of them. Knows nothing of what is on its inputs.
class AnalogueMultiplexer {
 public:
  /// @param switched called with the channel that is led through from now on, at each change
  explicit AnalogueMultiplexer(std::function<void(unsigned channel)> switched) : switched_(std::move(switched)) {}

  /// The levels on the select lines, line n in bit n; a line that nothing drives is low.
  void select(unsigned levels);
  /// A line is broken: it has this level, whatever drives it; nothing: it is whole again.
  void stick(unsigned line, std::optional<bool> level);
  unsigned channel() const { return channel_; }

 private:
  void update();

  std::function<void(unsigned)> switched_;
  unsigned levels_ = 0, channel_ = 0;
  std::array<std::optional<bool>, MULTIPLEXER_LINES> stuck_;
};

}  // namespace fovea::board
