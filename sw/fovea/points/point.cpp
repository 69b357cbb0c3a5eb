#include "sw/fovea/points/point.h"

#include <fmt/format.h>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/sha256.h"
#include "sw/fovea/results/stored_run.h"

namespace fovea::points {

std::string key_of(const Point& point) {
  std::string text = "fovea point 1\n" + point.command + "\n";
  for (const std::string& option : point.options) text += option + "\n";
  text += "\n" + point.identity;
  return app::sha256_of_text(text);
}

std::string folder_name(std::string_view key) { return std::string(key.substr(0, 16)); }

void read_stats(PointResult& result) {
  const std::filesystem::path file = result.folder / "run" / "stats.json";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return;
  for (const results::Figure& f : results::read_figures(file)) {
    if (f.value) result.stats[f.name] = std::visit([](auto v) { return static_cast<double>(v); }, *f.value);
    result.units[f.name] = f.unit;
  }
}

std::string reason_in(std::string_view messages) {
  std::string last, said;
  while (!messages.empty()) {
    const auto end = messages.find('\n');
    const std::string_view line = messages.substr(0, end);
    messages.remove_prefix(end == messages.npos ? messages.size() : end + 1);
    if (line.empty()) continue;
    last = line;
    // The guest's failure may have further lines, which begin otherwise.
    if (line.starts_with("fovea: ") && !line.starts_with("fovea: warning")) said = line;
  }
  return app::one_line(said.empty() ? last : said.substr(sizeof("fovea: ") - 1), 1000);
}

}  // namespace fovea::points
