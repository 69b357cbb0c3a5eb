#include "sw/fovea/results/stored_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/safe_json.h"

namespace fovea::results {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Figures and parameters that a run may have; a page looks for names one by one. A run on the board has about 900.
constexpr std::size_t kMaxNames = 5000;

std::string quoted(const fs::path& path) { return "'" + app::one_line(path.string()) + "'"; }

[[noreturn]] void damaged(const fs::path& file, const std::string& why) {
  throw UserError(fmt::format("{}: {}; it is damaged", quoted(file), why));
}

json read_object(const fs::path& file) {
  json value = app::read_json(file);
  if (!value.is_object()) damaged(file, "not a file of JSON");
  if (const std::size_t names = std::max(value.size(), app::json_member(value, "params").size()); names > kMaxNames)
    throw UserError(
        fmt::format("{}: it has {} figures or parameters; allowed: up to {}", quoted(file), names, kMaxNames));
  return value;
}

/// A member as text; empty if it is missing or null.
std::string text(const json& object, const char* name) {
  const json& member = app::json_member(object, name);
  return member.is_null() ? "" : member.is_string() ? member.get<std::string>() : member.dump();
}

std::vector<std::string> texts(const json& object, const char* name) {
  std::vector<std::string> out;
  for (const json& word : app::json_member(object, name))
    out.push_back(word.is_string() ? word.get<std::string>() : "");
  return out;
}

/// Members that are objects: {"value": number or null, "unit": text, "description": text}.
std::vector<Figure> figures_of(const json& object, const fs::path& file) {
  std::vector<Figure> out;
  for (const auto& [name, member] : object.items()) {
    if (!member.is_object()) continue;
    const json& value = app::json_member(member, "value");
    if (!member.contains("value") || !app::json_member(member, "unit").is_string() ||
        !(value.is_number() || value.is_null()))
      damaged(file, fmt::format("'{}' is no figure with a number and a unit", app::one_line(name, 60)));
    Figure f{name, {}, text(member, "unit"), text(member, "description"), value.is_number_integer()};
    if (value.is_number_unsigned()) f.value = value.get<std::uint64_t>();
    else if (value.is_number()) f.value = value.get<double>();
    out.push_back(std::move(f));
  }
  return out;
}

void read_config(StoredRun& out, const fs::path& file, const json& config) {
  out.version = text(config, "version");
  out.commit = text(config, "commit");
  out.modified = app::json_member(config, "modified") == true;
  out.experiment = text(config, "experiment");
  out.command = text(config, "command");
  out.input = text(config, "input");
  out.arguments = texts(config, "arguments");
  out.options = texts(config, "options");
  for (const auto& [key, hash] : app::json_member(config, "sha256").items())
    out.hashes.emplace_back(key, hash.is_string() ? hash.get<std::string>() : "");
  const json& params = app::json_member(config, "params");
  if (!params.is_object()) damaged(file, "it has no parameters");
  for (const auto& [key, p] : params.items()) {
    Parameter row{key, text(p, "value"), text(p, "origin"), text(p, "default"), text(p, "tag"), text(p, "source"), "",
                  text(p, "description")};
    if (const json& belief = app::json_member(p, "belief"); belief.is_object())
      row.belief = text(belief, "low") + " .. " + text(belief, "high");
    out.parameters.push_back(std::move(row));
  }
}

void read_stats(StoredRun& out, const fs::path& file) {
  const json stats = read_object(file);
  const json& complete = app::json_member(stats, "complete");
  if (!complete.is_boolean()) damaged(file, "it does not say whether its results are complete");
  out.complete = complete.get<bool>();
  out.ended_by = text(stats, "ended_by");
  out.kernel = text(stats, "kernel");
  out.figures = figures_of(stats, file);
  for (const json& w : app::json_member(stats, "warnings")) {
    if (!w.is_object()) damaged(file, "a warning is not an object");
    const json& count = app::json_member(w, "count");
    out.warnings.push_back(
        {text(w, "kind"), text(w, "what"), count.is_number_unsigned() ? count.get<std::uint64_t>() : 0});
  }
}

json config_of(const fs::path& folder) {
  std::error_code error;
  constexpr std::string_view kAllowed = "allowed: a folder of results, as 'fovea run', 'exec' and 'replay' write it";
  if (!fs::is_directory(folder, error))
    throw UserError(fmt::format("{} is not a folder; {}", quoted(folder), kAllowed));
  const fs::path file = folder / "config.json";
  json config;
  if (fs::is_regular_file(file, error)) config = app::read_json(file);
  const std::string format = text(config, "format");
  if (format.empty())
    throw UserError(fmt::format("{} is not a folder of results: it has no config.json of Fovea's; {}", quoted(folder),
                                kAllowed));
  if (format != kRunFormat)
    throw UserError(fmt::format("{}: its format is '{}'; this version reads '{}' only", quoted(folder),
                                app::one_line(format, 60), kRunFormat));
  return read_object(file);
}

}  // namespace

StoredRun read_stored_run(const fs::path& folder, bool partial, std::string_view remedy) {
  StoredRun out;
  out.folder = folder;
  const json config = config_of(folder);
  std::error_code error;
  if (!fs::is_regular_file(folder / "stats.json", error))
    throw UserError(fmt::format("{} has no stats.json: its run did not end; allowed: complete results",
                                quoted(folder)));
  read_stats(out, folder / "stats.json");
  if (!out.complete && !partial)
    throw UserError(fmt::format("{} holds partial results: its run was stopped or its guest failed; allowed: {}",
                                quoted(folder), remedy));
  read_config(out, folder / "config.json", config);
  if (const fs::path file = folder / "host.json"; fs::is_regular_file(file, error)) {
    const json host = read_object(file);
    out.command_line = texts(host, "command");
    out.host = figures_of(host, file);
  }
  return out;
}

std::vector<Figure> read_figures(const fs::path& stats_json) {
  return figures_of(read_object(stats_json), stats_json);
}

}  // namespace fovea::results
