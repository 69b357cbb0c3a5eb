#include "sw/fovea/config/calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/safe_yaml.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxSide = 8192;

class Reader {
 public:
  explicit Reader(const fs::path& file) : file_(file) {
    std::string text = read_file(file, kMaxSettingsBytes);
    // OpenCV's first line, "%YAML:1.0", is not a valid YAML directive. The lines keep their numbers.
    if (text.starts_with("%YAML")) text.erase(0, std::min(text.find('\n'), text.size()));
    try {
      root_ = load_yaml(text);
    } catch (const YamlFault& e) {
      fail(fmt::format("line {}: {}", e.line, e.what()));
    }
    if (!root_.IsMap()) fail("it has no camera matrix");
    check_model();
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw UserError(fmt::format(
        "calibration '{}': {}; allowed: an OpenCV fisheye calibration with camera_matrix (3x3), "
        "dist_coeffs (4 numbers) and resolution (width, height)",
        one_line(file_.string()), why));
  }

  /// All numbers of the first of `names` that exists: a matrix, a list, or a list of rows.
  std::vector<double> numbers(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      if (!root_[name]) continue;
      std::vector<double> out;
      const YAML::Node node = root_[name];
      append(node.IsMap() && node["data"] ? node["data"] : node, name, out);
      return out;
    }
    return {};
  }

 private:
  /// Four coefficients mean something else in each model, so a file that names another one is not read. Names of:
  /// ROS, Kalibr and OpenVINS (`distortion_model`, `camera_model`), camodocal and VINS (`model_type`), ORB-SLAM3
  /// (`Camera.type`) and OpenCV's sample program (`fisheye_model: 0` or `1`).
  void check_model() const {
    constexpr std::string_view kFisheye[] = {"equidistant",   "equi",           "fisheye",
                                             "kannalabrandt", "kannalabrandt8", "kb4"};
    bool named = false;
    for (const char* key : {"distortion_model", "distortion_type", "model_type", "Camera.type", "fisheye_model",
                            "camera_model"}) {
      const YAML::Node node = root_[key];
      if (!node || !node.IsScalar()) continue;
      std::string name;
      for (const char c : node.Scalar())
        if (std::isalnum(static_cast<unsigned char>(c)))
          name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      const bool flag = std::string_view(key) == "fisheye_model" && (name == "1" || name == "true");
      if (flag || std::find(std::begin(kFisheye), std::end(kFisheye), name) != std::end(kFisheye)) {
        named = true;
        continue;
      }
      // Kalibr's `pinhole` says how it is projected, and only the model beside it how it is distorted.
      if (name == "pinhole" && named) continue;
      fail(fmt::format("line {}: its lens model is '{}: {}', not that of a fisheye (Kannala-Brandt)",
                       node.Mark().line + 1, key, one_line(node.Scalar(), 60)));
    }
  }
  void append(const YAML::Node& node, const char* name, std::vector<double>& out) const {
    if (node.IsSequence()) {
      for (const auto& item : node) append(item, name, out);
      return;
    }
    double value = 0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value))
      fail(fmt::format("'{}' holds something that is not a number", name));
    out.push_back(value);
  }

  fs::path file_;
  YAML::Node root_;
};

}  // namespace

Calibration read_calibration(const fs::path& file) {
  const Reader in(file);
  const auto matrix = in.numbers({"camera_matrix", "K"});
  if (matrix.size() != 9)
    in.fail(matrix.empty() ? std::string("it has no camera matrix")
                           : fmt::format("its camera matrix has {} numbers", matrix.size()));
  if (std::abs(matrix[1]) > 1e-9)
    in.fail(fmt::format("it has a skew of {}, allowed is 0", matrix[1]));
  const auto k = in.numbers({"dist_coeffs", "distortion_coefficients", "D"});
  if (k.size() != 4)
    in.fail(fmt::format("it has {} distortion coefficients{}", k.size(),
                        k.size() > 4 ? ", those of a lens that is not a fisheye" : ""));
  Calibration out;
  out.kb = {matrix[0], matrix[4], matrix[2], matrix[5], k[0], k[1], k[2], k[3]};
  auto size = in.numbers({"resolution", "image_size"});
  if (size.empty()) {
    size = in.numbers({"image_width"});
    const auto height = in.numbers({"image_height"});
    size.insert(size.end(), height.begin(), height.end());
  }
  if (size.empty()) return out;
  if (size.size() != 2) in.fail(fmt::format("its picture size has {} numbers", size.size()));
  for (const double side : size)
    if (side < 16 || side > kMaxSide || side != std::floor(side))
      in.fail(fmt::format("its picture has a side of {}, allowed are 16 to {}", side, kMaxSide));
  out.width = static_cast<unsigned>(size[0]);
  out.height = static_cast<unsigned>(size[1]);
  return out;
}

namespace {

/// Of all cameras, or of one: `camera` is the group of the picture's keys, `lens_group` that of the
/// firmware's.
void apply_calibrations(const ParamSet& params, Experiment& experiment, const std::string& camera_group,
                        const std::string& lens_group) {
  const auto file_of = [&](const std::string& key) {
    const ParamBase* p = params.find(key);
    return p ? p->text() : std::string();
  };
  const auto apply = [&](const std::string& group, const std::string& key, const std::string& file,
                         int rank) {
    const Calibration c = read_calibration(file);
    if (experiment.rank(group + ".kb") > rank) return;
    if (experiment.rank(group + ".kb") == rank)
      DiagnosticsRef::current().configuration(fmt::format("'{0}.kb' is set ({1}) but has no effect with {2} = {3}",
                                                          group, experiment.origin(group + ".kb").text(), key, file));
    if (!c.width && group == lens_group && experiment.rank(lens_group + ".kb_width") < 0)
      throw UserError(fmt::format("calibration '{0}' does not say the size of its picture; set "
                                  "{1}.kb_width and {1}.kb_height",
                                  one_line(file), lens_group));
    experiment.preset(group + ".kb", fmt::format("[{}]", fmt::join(c.kb, ", ")), file);
    if (c.width) {
      experiment.preset(group + ".kb_width", fmt::format("{}px", c.width), file);
      experiment.preset(group + ".kb_height", fmt::format("{}px", c.height), file);
    }
  };
  const std::string camera_key = camera_group + ".calibration", lens_key = lens_group + ".calibration";
  const std::string camera = file_of(camera_key), lens = file_of(lens_key);
  const int camera_rank = experiment.rank(camera_key);
  if (!camera.empty()) apply(camera_group, camera_key, camera, camera_rank);
  if (!lens.empty())
    apply(lens_group, lens_key, lens, experiment.rank(lens_key));
  else if (!camera.empty() && experiment.rank(lens_group + ".kb") < 0)
    apply(lens_group, camera_key, camera, camera_rank);
}

}  // namespace

void apply_calibrations(const ParamSet& params, Experiment& experiment) {
  apply_calibrations(params, experiment, "camera", "lens");
  for (unsigned n = 0; params.find(fmt::format("camera.{}.calibration", n)); ++n)
    apply_calibrations(params, experiment, fmt::format("camera.{}", n),
                       fmt::format("camera.{}.lens", n));
}

}  // namespace fovea::app
