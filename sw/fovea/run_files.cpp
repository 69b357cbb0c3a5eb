#include "sw/fovea/run_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <nlohmann/json.hpp>
#include <vector>

#include "model/common/check.h"
#include "sw/fovea/checked_file.h"
#include "sw/fovea/safe_json.h"

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

bool is_series_folder(std::string_view name) {
  return std::any_of(kSeries.begin(), kSeries.end(),
                     [&](const Series& s) { return s.folder == name; });
}

/// Calls `f(relative name, entry, is a folder of numbered files)` for everything in `dir` and in
/// its folders of numbered files, sorted by name.
template <class F>
void each_entry(const fs::path& dir, const F& f) {
  const auto sorted = [](const fs::path& folder) {
    std::error_code ignored;
    std::vector<fs::path> names;
    for (fs::directory_iterator i(folder, ignored), end; !ignored && i != end; i.increment(ignored))
      names.push_back(i->path().filename());
    std::sort(names.begin(), names.end());
    return names;
  };
  std::error_code ignored;
  for (const fs::path& name : sorted(dir)) {
    const bool series = is_series_folder(name.string()) &&
                        fs::symlink_status(dir / name, ignored).type() == fs::file_type::directory;
    if (series)
      for (const fs::path& inner : sorted(dir / name)) f(name / inner, false);
    f(name, series);
  }
}

bool is_regular(const fs::path& file) {
  std::error_code ignored;
  return fs::symlink_status(file, ignored).type() == fs::file_type::regular;
}

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

bool is_run_folder(const fs::path& dir) {
  const json config = json_if_any(dir / "config.json");
  return config.is_object() && config.contains("format") && config["format"] == kRunFormat;
}

std::string RunFolder::results() const {
  return (complete ? "the results of " : "the partial results of ") + date;
}

RunFolder inspect_run_folder(const fs::path& dir) {
  RunFolder found;
  std::error_code error;
  const fs::file_status status = fs::symlink_status(dir, error);
  found.exists = fs::exists(status);
  if (status.type() != fs::file_type::directory) return found;
  found.ours = is_run_folder(dir);
  found.vacant = true;
  each_entry(dir, [&](const fs::path& name, bool series) {
    if (series) return;
    found.vacant = false;
    if (found.foreign.empty() && !(is_run_file(name.string()) && is_regular(dir / name)))
      found.foreign = name.string();
  });
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

bool remove_run_files(const fs::path& dir, bool keep_folder) {
  bool empty = true;
  each_entry(dir, [&](const fs::path& name, bool series) {
    std::error_code error;
    const bool ours = series || (is_run_file(name.string()) && is_regular(dir / name));
    // fs::remove() removes a folder only if it is empty.
    if (!ours || !fs::remove(dir / name, error)) empty = false;
  });
  std::error_code error;
  return empty && (keep_folder || fs::remove(dir, error));
}

}  // namespace fovea::app
