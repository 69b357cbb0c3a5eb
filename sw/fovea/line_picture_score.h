// The score of a run's corrected picture, where the scene is known: a chart of straight lines.
#pragma once
#include <memory>
#include <vector>

#include "model/board/board.h"
#include "model/video/scene/line_score.h"
#include "sw/fovea/simulation.h"

namespace fovea::app {

/// What a pin-hole camera in the place of camera `camera` would have to be to see what the display is to show, by the
/// keys alone. Without a correction (lens.mapping none) it has the focal length of the camera's own lens.
video::PinholeView meant_view(const board::BoardParams& params, unsigned camera);

class LinePictureScore {
 public:
  /// Null where no picture of a camera can be scored: a score needs the chart of lines without stamps, a camera at a
  /// time on the display, no overlay, and the optical axis in the view.
  static std::unique_ptr<LinePictureScore> of(const board::BoardParams& params);

  /// Remembers the picture in the middle of a displayed frame, if it is one of a camera that can be scored.
  void displayed(const video::DisplayFrame& frame, unsigned camera);
  /// Adds quality.*: the last such picture against the chart. Nothing if there was none.
  void add(std::vector<StatRow>& rows) const;

 private:
  explicit LinePictureScore(const board::BoardParams& params) : picture_(params.width(), params.height()) {}
  std::vector<std::unique_ptr<video::LineScore>> scores_;  ///< of each camera; null: cannot be scored
  video::Picture picture_;
  const video::LineScore* last_ = nullptr;
};

}  // namespace fovea::app
