// The score of a run's bird's-eye view, where the scene is known: a synthetic car park.
#pragma once
#include <memory>
#include <vector>

#include "model/board/board.h"
#include "model/video/scene/plan_score.h"
#include "sw/fovea/machine/machine.h"

namespace fovea::app {

class MosaicScore {
 public:
  /// Null for anything but mosaics of a synthetic car park whose pictures have no stamps.
  static std::unique_ptr<MosaicScore> of(const board::BoardParams& params);

  /// Remembers the mosaic in the middle of a displayed frame.
  void displayed(const video::Frame& frame);
  /// Adds quality.*: the last mosaic against the plan. Nothing while the picture of a camera has not been shown, as its
  /// part is black.
  void add(std::vector<StatRow>& rows, const std::vector<board::CameraFrameStats>& cameras) const;

 private:
  explicit MosaicScore(const board::BoardParams& params);
  video::PlanScore score_;
  video::Picture mosaic_;
};

}  // namespace fovea::app
