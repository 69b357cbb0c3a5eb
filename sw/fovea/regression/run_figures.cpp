#include "sw/fovea/regression/run_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "model/common/check.h"
#include "model/common/nearest.h"
#include "sw/fovea/checked_file.h"
#include "sw/fovea/safe_json.h"
#include "sw/fovea/outputs.h"
#include "sw/fovea/run_files.h"

namespace fovea::regression {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json read_object(const fs::path& file) {
  const json value = app::read_json(file);
  if (!value.is_object())
    throw UserError(fmt::format("'{}' is not a JSON object; allowed: a file that 'fovea run' wrote",
                                app::one_line(file.string())));
  return value;
}

std::vector<std::string> texts_of(const json& object, const char* name) {
  std::vector<std::string> out;
  for (const auto& word : app::json_member(object, name))
    if (word.is_string()) out.push_back(word.get<std::string>());
  return out;
}

/// Results of `exec` and `replay` name their command; those of versions before tell by the input's hash.
Subject subject_of(const json& config, const std::map<std::string, std::string>& hashes) {
  const std::string command = app::json_text(config, "command");
  if (command == command_of(ResultKind::kExec) || hashes.contains("program"))
    return {ResultKind::kExec, app::json_text(config, "input"), texts_of(config, "arguments"),
            texts_of(config, "options")};
  if (command == command_of(ResultKind::kReplay) || hashes.contains("trace"))
    return {ResultKind::kReplay, app::json_text(config, "input"), {}, texts_of(config, "options")};
  return {ResultKind::kRun, app::json_text(config, "experiment")};
}

void read_config(const json& config, RunFigures& run) {
  run.version = app::json_text(config, "version");
  run.commit = app::json_text(config, "commit");
  run.modified = app::json_member(config, "modified") == true;
  for (const auto& [name, hash] : app::json_member(config, "sha256").items())
    run.hashes[name] = hash.is_string() ? hash.get<std::string>() : "";
  run.subject = subject_of(config, run.hashes);
  for (const auto& [key, p] : app::json_member(config, "params").items()) {
    if (!p.is_object()) continue;
    Parameter& parameter = run.parameters[key];
    parameter = {app::json_text(p, "value"), app::json_text(p, "default"), app::json_text(p, "tag")};
    parameter.path = run.hashes.contains(key);
  }
}

void read_stats(const json& stats, RunFigures& run) {
  for (const auto& [name, row] : stats.items()) {
    if (!row.is_object() || !row.contains("value") || !row.contains("unit")) continue;
    const json& value = row["value"];
    Metric& m = run.metrics[name];
    m.unit = app::json_text(row, "unit");
    m.whole = value.is_number_integer();
    if (value.is_number()) m.value = value.get<double>();
  }
}

}  // namespace

std::string RunFigures::simulator() const {
  return fmt::format("{} (commit {}{})", version, commit, modified ? ", modified" : "");
}

bool RunFigures::has_frames() const {
  return subject.kind != ResultKind::kExec && (metric("frame.rate") || metric("frame.remap_time.mean"));
}

std::string RunFigures::input_hash() const {
  for (const char* key : {"program", "trace", "firmware.elf"})
    if (const auto found = hashes.find(key); found != hashes.end() && !found->second.empty()) return found->second;
  return "";
}

const Metric* RunFigures::metric(const std::string& name) const {
  const auto found = metrics.find(name);
  return found == metrics.end() ? nullptr : &found->second;
}

double RunFigures::value(const std::string& name) const {
  const Metric* const m = metric(name);
  return m ? m->value.value_or(0) : 0;
}

RunFigures read_run(const fs::path& folder) {
  const std::string name = app::one_line(folder.string());
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw UserError(
        fmt::format("'{}' is not a folder; allowed: a folder of results, as 'fovea run', "
                    "'exec' and 'replay' write it",
                    name));
  if (!app::is_run_folder(folder))
    throw UserError(
        fmt::format("'{}' is not a folder of results: it has no config.json of Fovea's; "
                    "allowed: a folder that 'fovea run', 'exec' or 'replay' wrote",
                    name));
  if (!fs::exists(folder / "stats.json", error))
    throw UserError(fmt::format("'{}' has no stats.json: its run did not end; allowed: complete "
                                "results",
                                name));
  RunFigures run;
  run.folder = folder;
  const json stats = read_object(folder / "stats.json");
  if (app::json_member(stats, "complete") != true)
    throw UserError(fmt::format("'{}' holds partial results: its run was stopped or its guest "
                                "failed; allowed: complete results",
                                name));
  read_config(read_object(folder / "config.json"), run);
  read_stats(stats, run);
  if (fs::exists(folder / "host.json", error)) {
    const json host = read_object(folder / "host.json");
    const json& words = app::json_member(host, "command");
    if (!words.empty()) run.command.push_back("fovea");  // the file has the words behind it
    for (const auto& word : words)
      if (word.is_string()) run.command.push_back(word);
    const json& counted = app::json_member(app::json_member(host, "host_instructions"), "value");
    if (counted.is_number()) run.host_instructions = counted.get<double>();
  }
  return run;
}

std::string nearest_metric(const RunFigures& run, const std::string& name) {
  std::vector<std::string> names;
  for (const auto& [known, metric] : run.metrics) names.push_back(known);
  return nearest_name(name, names);
}

std::string exact_text(double value, bool whole) {
  return whole ? fmt::format("{:.0f}", value) : app::number_text(value);
}

std::string figure_text(const Metric& metric) {
  if (!metric.value) return "no value";
  if (metric.whole && metric.unit != "B") {
    const std::string unit = metric.unit == "1" ? "" : " " + metric.unit;
    return exact_text(*metric.value, true) + unit;
  }
  return app::human_text(*metric.value, metric.unit);
}

}  // namespace fovea::regression
