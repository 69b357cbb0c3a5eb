#include "model/board/analogue_multiplexer.h"

namespace fovea::board {

void AnalogueMultiplexer::select(unsigned levels) {
  levels_ = levels;
  update();
}

void AnalogueMultiplexer::stick(unsigned line, std::optional<bool> level) {
  stuck_.at(line) = level;
  update();
}

void AnalogueMultiplexer::update() {
  unsigned channel = 0;
  for (unsigned n = 0; n < stuck_.size(); ++n)
    if (stuck_[n].value_or((levels_ >> n & 1) != 0)) channel |= 1u << n;
  if (channel == channel_) return;
  channel_ = channel;
  switched_(channel);
}

}  // namespace fovea::board
