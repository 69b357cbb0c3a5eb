#include "sw/fovea/limits/figure_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "model/common/nearest.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/results/names.h"

namespace fovea::limits {
namespace {

// Figures that a run without frames lacks. A test compares them with those of whole runs.
constexpr std::array<std::string_view, 12> kWithFrames = {
    names::kDdrEfficiency, names::kLatencyMax,     names::kLatencyMean,       names::kLatencyMin,
    names::kRate,          names::kRemapRate,      names::kRemapTimeMax,      names::kRemapTimeMean,
    names::kRemapTimeMin,  names::kRepeatedRelock, names::kStartupFirstFrame, names::kStartupLutTime};
constexpr std::array<std::string_view, 3> kGroupsWithFrames = {"camera.", "cpu.remap.", "quality."};

bool comes_with_frames(std::string_view name) {
  return std::find(kWithFrames.begin(), kWithFrames.end(), name) != kWithFrames.end() ||
         std::any_of(kGroupsWithFrames.begin(), kGroupsWithFrames.end(),
                     [&](std::string_view group) { return name.starts_with(group); });
}

std::vector<std::string> names_of(const points::PointResult& result) {
  std::vector<std::string> out(kWithFrames.begin(), kWithFrames.end());
  for (const auto& [name, unit] : result.units) out.push_back(name);
  return out;
}

}  // namespace

std::string names_hint(std::string_view name, const points::PointResult& result) {
  const std::string near = nearest_name(name, names_of(result));
  if (!near.empty() && near != name) return fmt::format("; did you mean '{}'?", near);
  return fmt::format("; those that it has are in {}", app::one_line((result.folder / "run/stats.json").string()));
}

void check_figures(Session& session, const Settings& settings, const std::vector<AskedFigure>& asked) {
  std::vector<AskedFigure> open;
  for (const AskedFigure& a : asked)
    if (!comes_with_frames(a.name)) open.push_back(a);
  // A run with a picture of its own would read that picture first.
  Settings shortest;
  const auto run = session.effective(settings);
  for (const char* setting : {"run.until=time:1us", "camera.kind=chart"})
    if (run->params.find(std::string_view(setting).substr(0, std::string_view(setting).find('='))))
      shortest.push_back(setting);
  if (open.empty() || shortest.empty()) return;
  session.run(
      settings, shortest,
      [open](const points::PointResult& result) {
        if (result.status != 0) return;
        for (const AskedFigure& a : open)
          if (!result.units.contains(a.name))
            throw UserError(fmt::format("{} '{}': a run has no figure of this name{}", a.option, app::one_line(a.name),
                                        names_hint(a.name, result)));
      },
      {}, "names of figures");
  session.runner().run();
}

}  // namespace fovea::limits
