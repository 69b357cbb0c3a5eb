#include "sw/fovea/results/run_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/common/nearest.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/results/stored_run.h"

namespace fovea::regression {
namespace {

namespace fs = std::filesystem;

/// Results of `exec` and `replay` name their command; those of versions before tell by the input's hash.
Subject subject_of(const results::StoredRun& run, const std::map<std::string, std::string>& hashes) {
  if (run.command == command_of(ResultKind::kExec) || hashes.contains("program"))
    return {ResultKind::kExec, run.input, run.arguments, run.options};
  if (run.command == command_of(ResultKind::kReplay) || hashes.contains("trace"))
    return {ResultKind::kReplay, run.input, {}, run.options};
  return {ResultKind::kRun, run.experiment};
}

double real(const StatBase::Value& value) {
  return std::visit([](auto v) { return static_cast<double>(v); }, value);
}

Metric metric_of(const results::Figure& f) {
  Metric m{{}, f.unit, f.whole};
  if (f.value) m.value = real(*f.value);
  return m;
}

}  // namespace

std::string RunFigures::simulator() const {
  return fmt::format("{} (commit {}{})", version, commit, modified ? ", modified" : "");
}

bool RunFigures::has_frames() const {
  return subject.kind != ResultKind::kExec && (metric(names::kRate) || metric(names::kRemapTimeMean));
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
  const results::StoredRun stored = results::read_stored_run(folder);
  RunFigures run;
  run.folder = folder;
  run.version = stored.version;
  run.commit = stored.commit;
  run.modified = stored.modified;
  run.hashes.insert(stored.hashes.begin(), stored.hashes.end());
  run.subject = subject_of(stored, run.hashes);
  for (const results::Parameter& p : stored.parameters)
    run.parameters[p.key] = {p.value, p.initial, p.tag, run.hashes.contains(p.key)};
  for (const results::Figure& f : stored.figures) run.metrics[f.name] = metric_of(f);
  if (!stored.command_line.empty()) run.command.push_back("fovea");  // the file has the words behind it
  run.command.insert(run.command.end(), stored.command_line.begin(), stored.command_line.end());
  for (const results::Figure& f : stored.host)
    if (f.name == "host_instructions" && f.value) run.host_instructions = real(*f.value);
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
