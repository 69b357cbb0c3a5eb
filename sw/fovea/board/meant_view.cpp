#include "sw/fovea/board/meant_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fovea::app {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// The lens of lens.mapping; only its radius(theta) is that of the keys.
video::LensModel told_model(const board::BoardParams& params, const board::LensParams& lens) {
  using video::LensKind;
  if (lens.mapping.is("kannala_brandt")) {
    const auto& v = lens.kb();
    return video::LensModel::kannala_brandt(v[0], v[1], v[2], v[3], {v[4], v[5], v[6], v[7]}, lens.kb.key())
        .scaled(params.raster_width() / lens.kb_width(), params.raster_height() / lens.kb_height());
  }
  const LensKind kind = lens.mapping.is("rectilinear")    ? LensKind::kRectilinear
                        : lens.mapping.is("linear")       ? LensKind::kLinear
                        : lens.mapping.is("orthographic") ? LensKind::kOrthographic
                        : lens.mapping.is("equisolid")    ? LensKind::kEquisolid
                                                          : LensKind::kStereographic;
  return video::LensModel::closed_form(kind, 90, params.raster_width(), params.raster_height());
}

/// Focal length for a picture of this width.
double told_focal(const board::LensParams& lens, const video::LensModel& model, unsigned width) {
  if (lens.mapping.is("kannala_brandt")) return model.fx();
  if (lens.focal() > 0) return lens.focal();
  if (lens.mapping.is("equisolid") && lens.paper_literal_focal())
    return width / (4 * std::sin(lens.fov() * kDegree / 2));
  return width / 2.0 / model.radius(lens.fov() * kDegree / 2);
}

double switched(const EnumParam& shift) {
  const std::uint32_t code = board::SwitchParams::code(shift);
  return code == SWITCH_FORWARD ? SWITCH_SHIFT_PIXELS : code == SWITCH_BACK ? -SWITCH_SHIFT_PIXELS : 0;
}

/// lens.roi: the larger side of the region, in pictures, is that of the view; its middle is the view's.
void look_at_region(video::PinholeView& view, const board::LensParams& lens) {
  const auto& roi = lens.roi();
  if (std::ranges::all_of(roi, [](double x) { return x == 0; })) return;
  const double larger = std::max(roi[2] / view.width, roi[3] / view.height);
  view.focal /= larger;
  view.shift_x = (view.shift_x + (roi[0] + roi[2] / 2 - view.width / 2.0)) / larger;
  view.shift_y = (view.shift_y + (roi[1] + roi[3] / 2 - view.height / 2.0)) / larger;
}

/// Of a camera at the digital port the whole picture is captured.
unsigned captured_width(const board::BoardParams& params) {
  return params.video.format().digital ? params.raster_width() : params.width();
}
unsigned captured_height(const board::BoardParams& params) {
  return params.video.format().digital ? params.raster_height() : params.height();
}

}  // namespace

video::PinholeView meant_view(const board::BoardParams& params, unsigned camera) {
  const board::CameraSetup setup = params.camera_setup(camera);
  const board::LensParams& lens = *setup.lens;
  video::PinholeView view{params.width(), params.height(), lens.out_focal(), lens.out_aspect(), lens.shift_x(),
                          lens.shift_y()};
  if (lens.mapping.is("none")) {
    const video::SceneParams& scene = *setup.scene;
    const bool known = scene.kind.is("lines") || (scene.kind.is("video") && scene.video_fov() > 0);
    view.focal = known ? scene.lens_model(params.raster_width(), params.raster_height()).fx() : 1;
    view.aspect = 1;
  } else {
    if (view.focal == 0) {
      view.focal = told_focal(lens, told_model(params, lens), captured_width(params));
      if (const board::VideoFormat& format = params.video.format(); format.digital) {
        // Shown at the display's size.
        const double x = static_cast<double>(format.width) / format.camera_width();
        view.focal *= x;
        view.aspect *= static_cast<double>(format.height) / format.camera_height / x;
      }
    }
    look_at_region(view, lens);
  }
  view.shift_x += switched(params.switches.shift_x);
  view.shift_y += switched(params.switches.shift_y);
  return view;
}

std::optional<video::TakingLens> told_lens(const board::BoardParams& params, unsigned camera) {
  const board::CameraSetup setup = params.camera_setup(camera);
  const board::LensParams& lens = *setup.lens;
  if (lens.mapping.is("none")) return std::nullopt;
  const video::LensModel model = told_model(params, lens);
  const unsigned width = captured_width(params), height = captured_height(params);
  video::TakingLens out{model, told_focal(lens, model, width), lens.in_aspect(),
                        {(width - 1) / 2.0 + lens.centre_x(), (height - 1) / 2.0 + lens.centre_y()}};
  if (lens.mapping.is("kannala_brandt")) {
    out.aspect = model.fy() / model.fx();
    out.centre.x += model.cx() - (params.raster_width() - 1) / 2.0;
    out.centre.y += model.cy() - (params.raster_height() - 1) / 2.0;
    out.theta_max = lens.theta_max() * kDegree;
  }
  return out;
}

}  // namespace fovea::app
