// Writes frames.csv and timeline.csv during the run.
#pragma once
#include <memory>
#include <span>
#include <string>

#include "sw/fovea/results/frame_sink.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/results/run_dir.h"

namespace fovea::app {

/// Writes rows when they become final, so that memory does not grow with the length of the run.
class RowFiles : public FrameSink {
 public:
  /// Creates both files. @throws UserError
  explicit RowFiles(RunDir& dir);
  void displayed(const video::Frame& frame, PixelShape pixel) override;
  void timeline(std::span<const std::string> masters, const TimelineRow& row);
  /// Writes the last rows of the timeline, which come with the result, and closes the files. @throws UserError
  void finish(std::span<const std::string> masters, std::span<const TimelineRow> timeline);

 private:
  void timeline_header(std::span<const std::string> masters);
  std::unique_ptr<CheckedFile> frames_, timeline_;
  bool has_header_ = false;  ///< for timeline.csv, whose header names the masters
};

}  // namespace fovea::app
