// The table that `fovea params` prints.
#include "sw/fovea/cli/params_table.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>

#include "model/common/check.h"
#include "sw/fovea/config/experiment.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

/// Escapes '|', which would end a cell of the table.
std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

constexpr const char* kOrigins = R"(
origin   where the default is from: sourced, a document about this chip; family,
         one about a sister chip only; calibrated, fitted to a measurement;
         assumed, no public figure; choice, nobody's but the user's
belief   of family and assumed: between which values the chip's own figure is
         believed to lie
)";

bool matches(const std::string& key, const std::string& pattern) {
  const bool glob = pattern.find_first_of("*?[") != std::string::npos;
  return glob ? ::fnmatch(pattern.c_str(), key.c_str(), 0) == 0
              : key.find(pattern) != std::string::npos;
}

std::vector<const ParamBase*> rows_of(const ParamSet& params,
                                      const std::vector<std::string>& patterns) {
  std::vector<const ParamBase*> rows;
  for (const std::string& pattern : patterns) {
    const std::size_t before = rows.size();
    for (const ParamBase* p : params.all()) {
      // The keys of cameras 1 to 7 are those of camera 0: listed only to whom asks for them.
      const bool another = pattern.empty() && is_camera_row(p->key()) && p->key()[7] != '0';
      if (matches(p->key(), pattern) && !another) rows.push_back(p);
    }
    if (rows.size() > before) continue;
    const std::string near = params.nearest(pattern);
    throw UserError(fmt::format(
        "no parameter matches '{}'{}", one_line(pattern),
        near.empty() ? "; 'fovea params' lists all keys" : "; did you mean '" + near + "'?"));
  }
  std::sort(rows.begin(), rows.end(),
            [](const ParamBase* a, const ParamBase* b) { return a->key() < b->key(); });
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

}  // namespace

std::string params_table(const ParamSet& params, const std::vector<std::string>& patterns,
                         bool markdown) {
  std::vector<std::array<std::string, 6>> cells = {
      {"key", "default", "allowed", "belief", "origin", "meaning"}};
  const auto rows = rows_of(params, patterns.empty() ? std::vector<std::string>{""} : patterns);
  for (const auto* p : rows) {
    std::string origin(to_string(p->origin()));
    if (!p->source().empty()) origin += " (" + p->source() + ")";
    if (!p->belief().empty()) origin += "; belief: " + p->belief().reason;
    const std::string belief =
        p->belief().empty() ? "-" : p->belief().low + " .. " + p->belief().high;
    const std::string value = p->default_text().empty() ? "-" : p->default_text();
    std::string meaning = p->sentence();
    for (const auto& effect : p->effects()) meaning += "; needs " + effect.condition;
    cells.push_back({p->key(), value, p->allowed(), belief, origin, meaning});
  }
  std::string out;
  if (markdown) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      for (const auto& cell : cells[i]) out += "| " + markdown_cell(cell) + " ";
      out += "|\n";
      if (i == 0) out += "|---|---|---|---|---|---|\n";
    }
    return out;
  }
  // A few long cells (lists, sources) must not widen a column beyond the screen.
  constexpr std::size_t kMaxWidth = 44;
  std::array<std::size_t, 6> width{};
  for (const auto& row : cells)
    for (std::size_t c = 0; c < row.size(); ++c)
      width[c] = std::max(width[c], std::min(kMaxWidth, row[c].size()));
  for (const auto& row : cells) {
    for (std::size_t c = 0; c + 1 < row.size(); ++c)
      out += fmt::format("{:<{}}  ", row[c], width[c]);
    out += row.back() + "\n";
  }
  return out + kOrigins;
}

}  // namespace fovea::app
