#include "sw/fovea/config/shared_pictures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace fovea::app {
namespace {

std::string row(unsigned camera) { return fmt::format("camera.{}.", camera); }

/// The value of a key of one camera: that of its row, or else that of all cameras.
std::string value_of(const ParamSet& params, const Experiment& experiment, unsigned camera,
                     const std::string& key) {
  const std::string own = row(camera) + key;
  return params.find(experiment.rank(own) >= 0 ? own : "camera." + key)->text();
}

bool shows_footage(const ParamSet& params, const Experiment& experiment, unsigned camera) {
  const std::string kind = value_of(params, experiment, camera, "kind");
  return kind == "sphere" || kind == "video";
}

/// Keys of the row's picture and lens, without "camera.N.": those that there are for all cameras too. The file of a
/// calibration is not among them, as its numbers are.
std::vector<std::string> picture_keys(const ParamSet& params) {
  std::vector<std::string> out;
  for (const ParamBase* p : params.all()) {
    if (!p->key().starts_with(row(0))) continue;
    std::string key = p->key().substr(row(0).size());
    if (key.ends_with("calibration")) continue;
    if (params.find(key.starts_with("lens.") ? key : "camera." + key)) out.push_back(std::move(key));
  }
  return out;
}

void take_over(const ParamSet& params, Experiment& experiment, unsigned to, unsigned from) {
  // A lens model of the camera's own, as numbers or by a calibration, stays whole.
  const bool own = experiment.rank(row(to) + "kb") >= 0, own_lens = experiment.rank(row(to) + "lens.kb") >= 0;
  for (const std::string& key : picture_keys(params)) {
    const bool of_own = key.starts_with("kb") ? own : key.starts_with("lens.kb") && own_lens;
    if (of_own || experiment.rank(row(from) + key) < 0 || experiment.rank(row(to) + key) >= 0) continue;
    experiment.take_over(row(to) + key, row(from) + key);
  }
}

}  // namespace

std::string share_pictures(const ParamSet& params, Experiment& experiment) {
  const auto* count = dynamic_cast<const IntParam*>(params.find("cameras.count"));
  if (!count) return "";
  std::vector<unsigned> with, without;
  for (unsigned n = 0; n < (*count)(); ++n) {
    if (!shows_footage(params, experiment, n)) continue;
    if (value_of(params, experiment, n, "file").empty())
      without.push_back(n);
    else if (experiment.rank(row(n) + "file") >= 0)
      with.push_back(n);
  }
  if (with.empty() || without.empty()) return "";
  std::vector<std::string> said;
  for (std::size_t k = 0; k < without.size(); ++k) {
    const unsigned from = with[k % with.size()];
    take_over(params, experiment, without[k], from);
    said.push_back(fmt::format("{} that of {}", without[k], from));
  }
  return fmt::format("cameras without a picture of their own take that of another one: {}", fmt::join(said, ", "));
}

}  // namespace fovea::app
