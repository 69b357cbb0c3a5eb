#include "model/video/scene/scene_params.h"

#include <array>
#include <cmath>
#include <initializer_list>

#include "model/video/scene/bars.h"

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

SceneParams::SceneParams(std::string prefix, bool rules)
    : ParamGroup(std::move(prefix)),
      file(*this, "file", "",
           "still or video that the camera shows: PNG, or anything that the ffmpeg program reads"),
      kind(*this, "kind", "sphere", {"sphere", "video", "chart", "car_park", "lines", "bars"},
           "sphere: a still on a swaying view sphere; video: frames as they are; chart: a test "
           "pattern in which every byte tells its place and field; car_park: marked ground, seen by "
           "a camera on a car (camera.N.mount); lines: squares on a wall at right angles to the optical "
           "axis; bars: colour bars (100/0/75/0)",
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
      kb_width(*this, "kb_width", "px", 0, 0, 8192,
               "picture width that camera.kb belongs to; 0: that of the still", Origin::kChoice,
               ""),
      kb_height(*this, "kb_height", "px", 0, 0, 8192,
                "picture height that camera.kb belongs to; 0: that of the still", Origin::kChoice,
                ""),
      video_fov(*this, "video_fov", "deg", 0, 0, 170,
                "horizontal angle of a flat video to be bent into camera.lens; 0 deg: as it is",
                Origin::kChoice, ""),
      calibration(*this, "calibration", "",
                  "OpenCV fisheye calibration (YAML) of the lens that took the still, in place of "
                  "camera.kb; the firmware's lens defaults to it (lens.calibration)") {
  if (!rules) return;
  const auto sphere = [this] { return kind.is("sphere"); };
  const auto bent = [this] { return bends(); };
  file.matters_only("camera.kind = sphere or video", {&kind},
                    [this] { return kind.is("sphere") || kind.is("video"); });
  motion_amplitude.matters_only("camera.kind = sphere", {&kind}, sphere);
  motion_period.matters_only("camera.kind = sphere", {&kind}, sphere);
  motion_period.matters_only("a camera.motion_amplitude above 0deg", {&motion_amplitude},
                             [this] { return motion_amplitude() > 0; });
  video_fov.matters_only("camera.kind = video", {&kind}, [this] { return kind.is("video"); });
  const char* const kBent = "camera.kind = sphere, car_park or lines, or video with a camera.video_fov above 0deg";
  lens.matters_only(kBent, {&kind, &video_fov}, bent);
  fov.matters_only(kBent, {&kind, &video_fov}, bent);
  fov.matters_only("a camera.lens other than kannala_brandt", {&lens},
                   [this] { return !lens.is("kannala_brandt"); });
  for (ParamBase* p : std::initializer_list<ParamBase*>{&kb, &kb_width, &kb_height, &calibration}) {
    p->matters_only("camera.kind = sphere", {&kind}, sphere);
    p->matters_only("camera.lens = kannala_brandt", {&lens},
                    [this] { return lens.is("kannala_brandt"); });
  }
}

bool SceneParams::bends() const {
  return kind.is("sphere") || kind.is("car_park") || kind.is("lines") || (kind.is("video") && video_fov() > 0);
}

LensModel SceneParams::lens_model(unsigned width, unsigned height) const {
  if (!lens.is("kannala_brandt"))
    return LensModel::closed_form(closed_form_kind(lens), fov(), width, height);
  const auto& v = kb();
  const LensModel lens_of_kb = LensModel::kannala_brandt(
      v[0], v[1], v[2], v[3], std::array<double, 4>{v[4], v[5], v[6], v[7]}, kb.key());
  const double w = kb_width() > 0 ? kb_width() : width, h = kb_height() > 0 ? kb_height() : height;
  return w == width && h == height ? lens_of_kb : lens_of_kb.scaled(width / w, height / h);
}

void SceneParams::check_calibration(unsigned width, unsigned height) const {
  const std::string whose =
      calibration().empty() ? kb.key() : calibration.key() + " '" + calibration() + "'";
  const std::string picture = file.key() + " '" + file() + "' (" + std::to_string(width) + "x" +
                              std::to_string(height) + ")";
  if (kb_width() > 0 && kb_height() > 0) {
    // The same picture in another size has the same aspect ratio, up to one pixel of rounding.
    if (std::abs(width * kb_height() / kb_width() - height) > 1)
      DiagnosticsRef::current().configuration(whose + " is of a picture of " + std::to_string(std::lround(kb_width())) +
                                              "x" + std::to_string(std::lround(kb_height())) +
                                              ", so it does not belong to " + picture + ", which has another shape");
    return;
  }
  const LensModel lens_of_kb = lens_model(width, height);
  const auto off = [](double centre, unsigned side) {
    return std::abs(centre - (side - 1) / 2.0) > side / 6.0;
  };
  if (off(lens_of_kb.cx(), width) || off(lens_of_kb.cy(), height))
    DiagnosticsRef::current().configuration(
        whose + " has its optical centre at " + std::to_string(std::lround(lens_of_kb.cx())) + ", " +
        std::to_string(std::lround(lens_of_kb.cy())) + ", outside the middle third of " + picture +
        ", so it hardly belongs to this picture");
}

std::unique_ptr<StampedSource> make_picture_source(const SceneParams& params,
                                                   std::vector<RgbImage> frames, unsigned width,
                                                   unsigned height, unsigned camera) {
  const Raster raster{width, height, params.stamp(), camera};
  if (params.kind.is("chart")) return std::make_unique<ChartSource>(raster);
  if (params.kind.is("bars")) return std::make_unique<BarsSource>(raster);
  if (frames.empty())
    throw UserError(params.file.key() + ": '" + params.file() + "' gave no picture; " +
                    params.kind.key() + " " + params.kind() + " needs a still or a video (chart and bars need none)");
  if (params.kind.is("sphere") && params.lens.is("kannala_brandt"))
    params.check_calibration(frames.front().width, frames.front().height);
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
