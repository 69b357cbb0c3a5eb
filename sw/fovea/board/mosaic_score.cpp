#include "sw/fovea/board/mosaic_score.h"

#include <algorithm>

#include "sw/fovea/board/board_figures.h"

namespace fovea::app {
namespace {

void add_quality(std::vector<StatRow>& rows, const video::PlanScore::Result& score) {
  const std::string what = "of the last displayed mosaic against the plan of the car park, without the car: ";
  rows.push_back(row("quality.psnr_y", score.psnr_y, "dB", what + "peak signal-to-noise ratio of luma"));
  rows.push_back(row("quality.ssim_y", score.ssim_y, "1", what + "structural similarity of luma"));
  if (score.lines)
    rows.push_back(row("quality.line_error", score.line_error, "px",
                       what + "distance of the marked lines from their places, root mean square"));
  rows.push_back(row("quality.lines", score.lines, "1", what + "rows of lines that were found"));
  rows.push_back(row("quality.lines_missed", score.missed, "1", what + "rows of lines that were not"));
}

}  // namespace

MosaicScore::MosaicScore(const board::BoardParams& params)
    : score_({params.width(), params.height(), params.birds_eye.width(), params.birds_eye.height()},
             params.birds_eye.car_length(), params.birds_eye.car_width()),
      mosaic_(params.width(), params.height()) {}

std::unique_ptr<MosaicScore> MosaicScore::of(const board::BoardParams& params) {
  if (!params.firmware.view.is("birds_eye") || params.camera_count() != VIEW_CAMERAS) return nullptr;
  for (unsigned n = 0; n < VIEW_CAMERAS; ++n) {
    const board::CameraSetup camera = params.camera_setup(n);
    if (!camera.scene->kind.is("car_park") || camera.scene->stamp()) return nullptr;
  }
  return std::unique_ptr<MosaicScore>(new MosaicScore(params));
}

void MosaicScore::displayed(const video::Frame& frame) {
  const unsigned x = (frame.picture.width - mosaic_.width) / 2, y = (frame.picture.height - mosaic_.height) / 2;
  for (unsigned v = 0; v < mosaic_.height; ++v)
    std::copy_n(frame.picture.row(y + v) + 2 * x, mosaic_.row_bytes(), mosaic_.row(v));
}

void MosaicScore::add(std::vector<StatRow>& rows, const std::vector<board::CameraFrameStats>& cameras) const {
  if (std::all_of(cameras.begin(), cameras.end(), [](const auto& c) { return c.displayed > 0; }))
    add_quality(rows, score_(mosaic_));
}

}  // namespace fovea::app
