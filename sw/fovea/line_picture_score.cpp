#include "sw/fovea/line_picture_score.h"

#include <algorithm>
#include <cmath>

#include "sw/fovea/board_figures.h"

namespace fovea::app {
namespace {

/// Focal length of the lens that the firmware believes in, for a picture of this width; from the definitions of the
/// scene's lenses, so that the score has nothing of the firmware's table.
double believed_focal(const board::BoardParams& params, const board::LensParams& lens, unsigned width) {
  using video::LensKind;
  if (lens.mapping.is("kannala_brandt")) return lens.kb()[0] * params.raster_width() / lens.kb_width();
  if (lens.focal() > 0) return lens.focal();
  if (lens.mapping.is("equisolid") && lens.paper_literal_focal())
    return width / (4 * std::sin(lens.fov() * M_PI / 360));
  const LensKind kind = lens.mapping.is("rectilinear")    ? LensKind::kRectilinear
                        : lens.mapping.is("linear")       ? LensKind::kLinear
                        : lens.mapping.is("orthographic") ? LensKind::kOrthographic
                        : lens.mapping.is("equisolid")    ? LensKind::kEquisolid
                                                          : LensKind::kStereographic;
  return video::LensModel::closed_form(kind, lens.fov(), width, params.raster_height()).fx();
}

double switched(const EnumParam& shift) {
  const std::uint32_t code = board::SwitchParams::code(shift);
  return code == SWITCH_FORWARD ? SWITCH_SHIFT_PIXELS : code == SWITCH_BACK ? -SWITCH_SHIFT_PIXELS : 0;
}

void add_line_quality(std::vector<StatRow>& rows, const video::LineScore::Result& score) {
  const std::string what = "of the last displayed picture of the chart of lines ";
  const std::string ideal = what + "against that of a pin-hole camera: ";
  if (std::isfinite(score.psnr_y))
    rows.push_back(row("quality.psnr_y", score.psnr_y, "dB", ideal + "peak signal-to-noise ratio of luma"));
  rows.push_back(row("quality.ssim_y", score.ssim_y, "1", ideal + "structural similarity of luma"));
  if (score.places)
    rows.push_back(row("quality.straightness", score.straightness, "px",
                       what + "(distance of points of lines from the best straight line, root mean square)"));
  rows.push_back(row("quality.places", score.places, "1", what + "(rows and columns of lines that were found)"));
  rows.push_back(row("quality.places_missed", score.missed, "1",
                     what + "(rows and columns of lines that a pin-hole camera sees, and that were not found)"));
}

}  // namespace

video::PinholeView meant_view(const board::BoardParams& params, unsigned camera) {
  const board::CameraSetup setup = params.camera_setup(camera);
  const board::LensParams& lens = *setup.lens;
  video::PinholeView view{params.width(), params.height(), lens.out_focal(), lens.out_aspect(),
                          lens.shift_x() + switched(params.switches.shift_x),
                          lens.shift_y() + switched(params.switches.shift_y)};
  if (lens.mapping.is("none")) {
    view.focal = setup.scene->lens_model(params.raster_width(), params.raster_height()).fx();
    view.aspect = 1;
  } else if (view.focal == 0) {
    // Of a camera at the digital port the whole picture is captured, and is shown at the display's size by default.
    const board::VideoFormat& format = params.video.format();
    view.focal = believed_focal(params, lens, format.digital ? format.camera_width() : params.width());
    if (format.digital) {
      const double x = static_cast<double>(format.width) / format.camera_width();
      view.focal *= x;
      view.aspect *= static_cast<double>(format.height) / format.camera_height / x;
    }
  }
  return view;
}

std::unique_ptr<LinePictureScore> LinePictureScore::of(const board::BoardParams& params) {
  if (!params.firmware.view.is("single") || params.firmware.overlay()) return nullptr;
  std::unique_ptr<LinePictureScore> out(new LinePictureScore(params));
  for (unsigned n = 0; n < params.camera_count(); ++n) {
    const board::CameraSetup camera = params.camera_setup(n);
    out->scores_.emplace_back();
    if (!camera.scene->kind.is("lines") || camera.scene->stamp()) continue;
    const video::PinholeView view = meant_view(params, n);
    if (video::LineScore::can_score(view)) out->scores_.back() = std::make_unique<video::LineScore>(view);
  }
  if (std::ranges::none_of(out->scores_, [](const auto& score) { return score != nullptr; })) return nullptr;
  return out;
}

void LinePictureScore::displayed(const video::DisplayFrame& frame, unsigned camera) {
  const video::LineScore* score = camera < scores_.size() ? scores_[camera].get() : nullptr;
  if (!score) return;
  last_ = score;
  const unsigned x = (frame.picture.width - picture_.width) / 2, y = (frame.picture.height - picture_.height) / 2;
  for (unsigned v = 0; v < picture_.height; ++v)
    std::copy_n(frame.picture.row(y + v) + 2 * x, picture_.row_bytes(), picture_.row(v));
}

void LinePictureScore::add(std::vector<StatRow>& rows) const {
  if (last_) add_line_quality(rows, (*last_)(picture_));
}

}  // namespace fovea::app
