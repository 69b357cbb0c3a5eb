// What the page is about: which system ran, what is different among several runs, and the commands that say more.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "sw/fovea/explain/command.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/report/html.h"
#include "sw/fovea/report/page.h"
#include "sw/fovea/report/sections.h"
#include "sw/fovea/results/names.h"

namespace fovea::report {
namespace {

std::string value_of(const Results& run, std::string_view key) {
  const auto* p = run.parameter(key);
  return p ? p->value : "";
}

/// "297 MHz" of "297/243" for part 0, unless `key` sets it apart.
std::string clock_of(const Results& run, std::string_view key, std::size_t part) {
  const std::string own = value_of(run, key);
  if (!own.empty() && own[0] != '0') return own;
  const std::string preset = value_of(run, "clocks.preset");
  const auto slash = preset.find('/');
  if (slash == preset.npos) return "";
  return (part == 0 ? preset.substr(0, slash) : preset.substr(slash + 1)) + " MHz";
}

/// "-s key=value" of everything that was set on the command line, in the order of the keys.
std::vector<std::string> sets_of(const Results& run) {
  std::vector<std::string> out;
  for (const auto& p : run.parameters)
    if (p.origin == "command line") out.push_back(explain::without_folders(p.key + "=" + p.value));
  return out;
}

/// The experiment's file, as it was named on the command line.
std::string file_of(const Results& run) {
  std::string file = run.experiment + ".yaml";
  for (const auto& word : run.arguments)
    if (std::filesystem::path(word).stem() == run.experiment) file = word;
  return explain::without_folders(file);
}

/// Keys whose values are not the same in all runs.
std::vector<std::string> differing_keys(const Runs& runs) {
  std::set<std::string> keys;
  for (const auto& run : runs)
    for (const auto& p : run.parameters) keys.insert(p.key);
  std::vector<std::string> out;
  for (const auto& key : keys)
    if (std::any_of(runs.begin(), runs.end(),
                    [&](const Results& r) { return value_of(r, key) != value_of(runs[0], key); }))
      out.push_back(key);
  return out;
}

}  // namespace

std::string system_text(const Results& run) {
  if (run.command == "replay")
    return fmt::format("A bus trace, {}, played on the model of crossbar and SDRAM ({}); no core runs.",
                       run.experiment.empty() ? run.name : run.experiment, value_of(run, "ddr.part"));
  if (run.parameter("firmware.kernel") == nullptr || run.parameter("video.standard") == nullptr) return "";
  std::string out = fmt::format(
      "A simulated TI DM365 board runs its firmware: core ARM926EJ-S at {}, SDRAM {} at {}; video {}, camera {} "
      "through a lens {}.",
      clock_of(run, "clocks.arm", 0), value_of(run, "ddr.part"), clock_of(run, "clocks.ddr", 1),
      run.picture.empty() ? value_of(run, "video.standard") : run.picture, value_of(run, "camera.kind"),
      value_of(run, "camera.lens"));
  const std::string asked = value_of(run, "firmware.kernel");
  if (!run.kernel.empty())
    out += fmt::format(" Its loop is the kernel {}{}.", run.kernel,
                       asked == run.kernel ? std::string() : fmt::format(" (firmware.kernel: {})", asked));
  if (run.value(names::kRemapTimeMean))
    out +=
        " A remap is the correction of one captured frame: a look-up table says, for the pixels of the display, "
        "which pixels of the camera's picture to take.";
  return out;
}

std::string system_section(const Runs& runs) {
  std::set<std::string> texts;
  for (const auto& run : runs) texts.insert(system_text(run));
  std::string out;
  if (texts.size() == 1 && texts.begin()->empty()) return out;
  if (texts.size() == 1)
    out = fmt::format("<p class=\"system\">{}</p>", escaped(*texts.begin()));
  else
    out = panels(
        runs, [&](std::size_t i) { return fmt::format("<p class=\"system\">{}</p>", escaped(system_text(runs[i]))); });
  return out;
}

void name_apart(Runs& runs) {
  std::set<std::string> names;
  for (const auto& run : runs) names.insert(run.name);
  if (names.size() == runs.size()) return;
  const std::vector<std::string> keys = differing_keys(runs);
  constexpr std::size_t kShown = 3;
  for (auto& run : runs) {
    std::vector<std::string> settings;
    for (const auto& key : keys)
      if (settings.size() < kShown)
        settings.push_back(fmt::format("{}={}", key, explain::without_folders(value_of(run, key))));
    if (keys.size() > kShown) settings.push_back(fmt::format("{} more", keys.size() - kShown));
    if (!settings.empty()) {
      run.name = fmt::format("{}", fmt::join(settings, ", "));
      continue;
    }
    std::error_code error;  // the same settings: their folders' folders tell them apart
    const auto parent = std::filesystem::weakly_canonical(run.folder, error).parent_path().filename().string();
    if (!parent.empty()) run.name = parent + "/" + run.name;
  }
}

std::string binds_command_of(const Results& run) {
  if (run.command != "run" || run.value(names::kRemapTimeMean).value_or(0) <= 0) return "";
  return explain::binds_command(file_of(run), sets_of(run));
}

std::string around_command_of(const Results& run, const app::SlowestRow& slowest) {
  if (run.command != "run") return "";
  std::string out = "fovea run " + explain::shell_word(file_of(run));
  for (const auto& set : sets_of(run)) out += " -s " + explain::shell_word(set);
  return fmt::format("{} --around {}.{:09}ms", out, slowest.issued / kPsPerMs, slowest.issued % kPsPerMs);
}

}  // namespace fovea::report
