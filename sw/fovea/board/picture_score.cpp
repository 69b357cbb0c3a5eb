#include "sw/fovea/board/picture_score.h"

#include <algorithm>

#include "model/video/scene/picture_quality.h"
#include "sw/fovea/board/board_figures.h"
#include "sw/fovea/board/meant_view.h"

namespace fovea::app {
namespace {

/// The middle of a picture.
void crop(const video::Picture& from, video::Picture& to) {
  const unsigned x = (from.width - to.width) / 2, y = (from.height - to.height) / 2;
  for (unsigned v = 0; v < to.height; ++v) std::copy_n(from.row(y + v) + 2 * x, to.row_bytes(), to.row(v));
}

/// The two figures of likeness. A ratio that is infinite, as of equal pictures, is written as null.
void add_likeness(std::vector<StatRow>& rows, const std::string& name, double psnr, double ssim,
                  const std::string& what) {
  rows.push_back(row("quality." + name + "psnr_y", psnr, "dB", what + "peak signal-to-noise ratio of luma"));
  rows.push_back(row("quality." + name + "ssim_y", ssim, "1", what + "structural similarity of luma"));
}

constexpr const char* kOfPixels =
    "of a remap of each pixel by itself, of the frame that the last displayed picture shows, ";
constexpr const char* kStraightness =
    "(distance of points of lines from the best straight line, root mean square)";

void add_places(std::vector<StatRow>& rows, const video::LineScore::Result& score) {
  const std::string what = "of the last displayed picture of the chart of lines ";
  if (score.places) rows.push_back(row("quality.straightness", score.straightness, "px", what + kStraightness));
  rows.push_back(row("quality.places", score.places, "1", what + "(rows and columns of lines that were found)"));
  rows.push_back(row("quality.places_missed", score.missed, "1",
                     what + "(rows and columns of lines that a pin-hole camera sees, and that were not found)"));
}

}  // namespace

PictureScore::PictureScore(const board::BoardParams& params)
    : pairs_(params.firmware.tables() == 1 && !params.firmware.kernel.is("copy")),
      digital_(params.video.format().digital),
      picture_(params.width(), params.height()),
      sent_(digital_ ? params.raster_width() : params.width(), digital_ ? params.raster_height() : params.height()) {}

bool PictureScore::possible(const board::BoardParams& params) {
  return params.firmware.view.is("single") && !params.firmware.overlay() && params.width() >= video::kSsimWindow &&
         params.height() >= video::kSsimWindow;
}

std::unique_ptr<PictureScore> PictureScore::of(const board::BoardParams& params,
                                               const std::vector<const video::StampedSource*>& cameras) {
  if (!possible(params)) return nullptr;
  std::unique_ptr<PictureScore> out(new PictureScore(params));
  for (unsigned n = 0; n < params.camera_count(); ++n) {
    const board::CameraSetup setup = params.camera_setup(n);
    const video::SceneParams& scene = *setup.scene;
    Camera& camera = out->cameras_.emplace_back();
    camera.view = meant_view(params, n);
    camera.lens = told_lens(params, n);
    if (scene.stamp()) continue;
    if (scene.kind.is("lines") && video::LineScore::can_score(camera.view))
      camera.lines = std::make_unique<video::LineScore>(camera.view);
    camera.video = dynamic_cast<const video::VideoSource*>(cameras.at(n));
    if (camera.video && scene.video_fov() > 0) camera.film.emplace(scene.video_fov(), camera.view);
  }
  out->any_known_ = std::ranges::any_of(out->cameras_, &Camera::known);
  if (!out->any_known_ && !out->pairs_) return nullptr;
  return out;
}

void PictureScore::displayed(const video::Frame& frame, const CameraInputs::Sent& sent) {
  const unsigned camera = frame.times.camera;
  if (camera >= cameras_.size() || (any_known_ && !cameras_[camera].known())) return;
  last_ = &cameras_[camera];
  crop(frame.picture, picture_);
  take_sent(sent);
}

void PictureScore::take_sent(const CameraInputs::Sent& sent) {
  field_.reset();
  if (!sent.picture || sent.picture->width < sent_.width || sent.picture->height < sent_.height) return;
  crop(*sent.picture, sent_);
  field_ = sent.field;
}

/// What the film had flat; null if that is not one frame of it.
const video::RgbImage* PictureScore::flat_frame() const {
  if (!last_->film || !field_ || (!digital_ && *field_ % 2)) return nullptr;
  return &last_->video->flat_frame(*field_ / 2);
}

void PictureScore::add_of_scene(std::vector<StatRow>& rows) const {
  if (last_->lines) {
    const auto score = (*last_->lines)(picture_);
    add_likeness(rows, "", score.psnr_y, score.ssim_y,
                 "of the last displayed picture of the chart of lines against that of a pin-hole camera: ");
    add_places(rows, score);
  }
  if (const video::RgbImage* flat = flat_frame()) {
    const auto score = (*last_->film)(picture_, *flat);
    add_likeness(rows, "", score.psnr_y, score.ssim_y,
                 "of the last displayed picture of the film against the flat film: ");
  }
}

void PictureScore::add_of_pixels(std::vector<StatRow>& rows) const {
  const video::Picture pixels = video::remap_pixels(sent_, last_->view, last_->lens);
  add_likeness(rows, "pair_", video::psnr_y(picture_, pixels), video::ssim_y(picture_, pixels),
               "of the last displayed picture, whose pairs of pixels move as a whole, against a remap of each pixel by "
               "itself: ");
  const std::string what = kOfPixels;
  if (last_->lines) {
    const auto score = (*last_->lines)(pixels);
    add_likeness(rows, "pixel_", score.psnr_y, score.ssim_y, what + "against the chart that a pin-hole camera sees: ");
    if (score.places) rows.push_back(row("quality.pixel_straightness", score.straightness, "px", what + kStraightness));
  }
  if (const video::RgbImage* flat = flat_frame()) {
    const auto score = (*last_->film)(pixels, *flat);
    add_likeness(rows, "pixel_", score.psnr_y, score.ssim_y, what + "against the flat film: ");
  }
}

void PictureScore::add(std::vector<StatRow>& rows) const {
  if (!last_) return;
  add_of_scene(rows);
  if (pairs_ && field_) add_of_pixels(rows);
}

}  // namespace fovea::app
