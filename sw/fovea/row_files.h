// frames.csv and timeline.csv, written as the run goes on.
#pragma once
#include <memory>
#include <span>
#include <string>

#include "sw/fovea/run_dir.h"
#include "sw/fovea/simulation.h"

namespace fovea::app {

/// The rows of a run, however long it is, never lie in memory all at once.
class RowFiles {
 public:
  /// Creates both files. @throws UserError
  explicit RowFiles(RunDir& dir);
  /// Has the board hand over its rows. The request must not outlive this object.
  void attach(RunRequest& request);
  /// Writes the rows that came with the result, and closes the files. @throws UserError
  void finish(const RunResult& result);

 private:
  void frame(const FrameRow& row);
  void timeline(std::span<const std::string> masters, const TimelineRow& row);
  void timeline_header(std::span<const std::string> masters);
  std::unique_ptr<CheckedFile> frames_, timeline_;
  bool has_header_ = false;  ///< of timeline.csv, which names the masters
};

}  // namespace fovea::app
