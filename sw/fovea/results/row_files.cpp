#include "sw/fovea/results/row_files.h"

namespace fovea::app {

RowFiles::RowFiles(RunDir& dir)
    : frames_(dir.create("frames.csv")), timeline_(dir.create("timeline.csv")) {
  frames_->write(frames_csv_header());
}

void RowFiles::displayed(const video::Frame& frame, PixelShape) { frames_->write(frames_csv_line(frame.times)); }

void RowFiles::timeline(std::span<const std::string> masters, const TimelineRow& row) {
  timeline_header(masters);
  timeline_->write(timeline_csv_line(row, masters.size()));
}

void RowFiles::timeline_header(std::span<const std::string> masters) {
  if (!has_header_) timeline_->write(timeline_csv_header(masters));
  has_header_ = true;
}

void RowFiles::finish(std::span<const std::string> masters, std::span<const TimelineRow> rows) {
  timeline_header(masters);
  for (const TimelineRow& row : rows) timeline(masters, row);
  frames_->close();
  timeline_->close();
}

}  // namespace fovea::app
