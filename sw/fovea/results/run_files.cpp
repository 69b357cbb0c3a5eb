#include "sw/fovea/results/run_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <nlohmann/json.hpp>
#include <vector>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/safe_json.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The files of all commands. RunDir refuses to write files that are not listed here.
constexpr auto kFiles = std::to_array<std::string_view>(
    {"profile.csv",   "profile.folded", "profile.callgrind", "profile.txt", "interrupts.csv", "frame_parts.csv",
     "functions.csv", "paths.csv",      "objects.csv",       "slowest.csv", "requests.csv",   "config.json",
     "stats.json",    "host.json",      "frames.csv",        "timeline.csv", "latency.csv",   "stalls.csv",
     "uart.log",      "uart0.input",    "registers.log",     "display.mp4", "report.html"});

/// Folders of numbered files.
struct Series {
  std::string_view folder, prefix, suffix;
};
constexpr std::array<Series, 2> kSeries = {{{"frames", "frame_", ".png"}, {"camera", "frame_", ".png"}}};
constexpr std::array<std::string_view, kSeries.size()> kFolders = {kSeries[0].folder, kSeries[1].folder};

/// A discarded value if the file cannot be read or is not JSON.
json json_if_any(const fs::path& file) {
  try {
    return read_json(file);
  } catch (const UserError&) {
    return json(json::value_t::discarded);
  }
}

std::string local_date(const fs::path& file) {
  struct stat info {};
  if (::lstat(file.c_str(), &info) != 0) return "";
  std::tm parts{};
  ::localtime_r(&info.st_mtime, &parts);
  std::array<char, 32> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S", &parts)};
}

}  // namespace

bool is_run_file(std::string_view name) {
  if (std::find(kFiles.begin(), kFiles.end(), name) != kFiles.end()) return true;
  return std::any_of(kSeries.begin(), kSeries.end(), [&](const Series& s) {
    if (name.size() <= s.folder.size() || !name.starts_with(s.folder) ||
        name[s.folder.size()] != '/')
      return false;
    std::string_view number = name.substr(s.folder.size() + 1);
    if (!number.starts_with(s.prefix) || !number.ends_with(s.suffix) ||
        number.size() <= s.prefix.size() + s.suffix.size())
      return false;
    number = number.substr(s.prefix.size(), number.size() - s.prefix.size() - s.suffix.size());
    return std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
  });
}

namespace {
bool is_run_config(const json& config) {
  return config.is_object() && config.contains("format") && config["format"] == kRunFormat;
}

/// A run that dies while it writes config.json leaves one that is cut off, and no JSON.
bool is_foreign_config(const fs::path& file) {
  const json config = json_if_any(file);
  return !config.is_discarded() && !is_run_config(config);
}
}  // namespace

const FolderKind kRunKind = {.owner = "a Fovea run",
                             .is_file = is_run_file,
                             .folders = kFolders,
                             .mark = "config.json",
                             .is_foreign_mark = is_foreign_config};

bool is_run_folder(const fs::path& dir) { return is_run_config(json_if_any(dir / "config.json")); }

std::string RunFolder::results() const {
  return (complete ? "the results of " : "the partial results of ") + date;
}

RunFolder inspect_run_folder(const fs::path& dir) {
  RunFolder found{folder_contents(dir, kRunKind), {}, {}, {}, {}};
  if (!found.folder) return found;
  std::error_code error;
  found.ours = is_run_folder(dir);
  if (!found.ours) return found;
  const json host = json_if_any(dir / "host.json");
  if (host.is_object() && host.contains("command") && host["command"].is_array() &&
      !host["command"].empty() && host["command"][0].is_string())
    found.command = host["command"][0];
  if (fs::exists(fs::symlink_status(dir / "stats.json", error))) {
    const json stats = json_if_any(dir / "stats.json");
    // Results that cannot be read count as complete, so that partial results do not replace them.
    found.complete =
        !(stats.is_object() && stats.contains("complete") && stats["complete"] == false);
    found.date = local_date(dir / "stats.json");
  } else {
    found.date = local_date(dir / "config.json");
  }
  return found;
}

}  // namespace fovea::app
