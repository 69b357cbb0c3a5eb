#include "model/video/scene/scene_params.h"

#include <array>

namespace fovea::video {
namespace {

constexpr const char* kFrontCamera =
    "calibration of traces/footage/neozhaoliang-surround/front.yaml";

LensKind closed_form_kind(const EnumParam& lens) {
  if (lens.is("linear")) return LensKind::kLinear;
  if (lens.is("orthographic")) return LensKind::kOrthographic;
  if (lens.is("equisolid")) return LensKind::kEquisolid;
  return LensKind::kStereographic;
}

}  // namespace

SceneParams::SceneParams()
    : ParamGroup("camera"),
      file(*this, "file", "",
           "still or video that the camera shows: PNG, or anything that the ffmpeg program reads"),
      kind(*this, "kind", "sphere", {"sphere", "video", "chart"},
           "sphere: a still on a swaying view sphere; video: frames as they are; chart: a test "
           "pattern in which every byte tells its place and field",
           Origin::kChoice, ""),
      motion_period(*this, "motion_period", IntParam::Unit::kCount, 60, 1, 600,
                    "fields until the sway of a still repeats; each is kept as a picture",
                    Origin::kChoice, ""),
      motion_amplitude(*this, "motion_amplitude", "deg", 1.5, 0, 20,
                       "largest turn of the view to each side; 0 deg shows the still unmoved",
                       Origin::kChoice, ""),
      stamp(*this, "stamp", true, "draw field number and moving marker into the picture",
            Origin::kChoice, ""),
      lens(*this, "lens", "kannala_brandt",
           {"kannala_brandt", "linear", "orthographic", "equisolid", "stereographic"},
           "mapping of the lens that took the still, or that a video is bent by", Origin::kSourced,
           kFrontCamera),
      fov(*this, "fov", "deg", 180, 1, 360,
          "full angle across the width of the picture, for the closed mappings", Origin::kChoice,
          ""),
      kb(*this, "kb",
         {302.45305983229298, 320.74618594392325, 496.64001463163459, 331.19980984361649,
          -0.043735601598704078, 0.021692522970939803, -0.026388839028513571,
          0.0084123126605702321},
         {8}, "Kannala-Brandt lens: fx fy cx cy in pixels of the still, k1 k2 k3 k4",
         Origin::kSourced, kFrontCamera),
      video_fov(*this, "video_fov", "deg", 0, 0, 170,
                "horizontal angle of a flat video to be bent into camera.lens; 0 deg: as it is",
                Origin::kChoice, "") {}

LensModel SceneParams::lens_model(unsigned width, unsigned height) const {
  if (!lens.is("kannala_brandt"))
    return LensModel::closed_form(closed_form_kind(lens), fov(), width, height);
  const auto& v = kb();
  return LensModel::kannala_brandt(v[0], v[1], v[2], v[3],
                                   std::array<double, 4>{v[4], v[5], v[6], v[7]});
}

std::unique_ptr<StampedSource> make_picture_source(const SceneParams& params,
                                                   std::vector<RgbImage> frames, unsigned width,
                                                   unsigned height) {
  const Raster raster{width, height, params.stamp()};
  if (params.kind.is("chart")) return std::make_unique<ChartSource>(raster);
  if (frames.empty())
    throw UserError("camera.file: '" + params.file() + "' gave no picture; camera.kind " +
                    params.kind() + " needs a still or a video (chart needs none)");
  if (params.kind.is("sphere"))
    return std::make_unique<SphereSource>(
        frames.front(), params.lens_model(frames.front().width, frames.front().height), raster,
        Motion{static_cast<unsigned>(params.motion_period()), params.motion_amplitude()});
  if (params.video_fov() == 0) return std::make_unique<VideoSource>(std::move(frames), raster);
  if (params.lens.is("kannala_brandt"))
    throw UserError(
        "camera.lens: a flat video (camera.video_fov) can be bent into linear, orthographic, "
        "equisolid or stereographic, not kannala_brandt");
  return std::make_unique<VideoSource>(std::move(frames), raster,
                                       Warp{params.lens_model(width, height), params.video_fov()});
}

}  // namespace fovea::video
