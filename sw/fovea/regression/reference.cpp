// The files that a baseline keeps of the run it was taken from.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "model/common/check.h"
#include "sw/fovea/compare/attribution.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/sha256.h"
#include "sw/fovea/regression/baseline.h"
#include "sw/fovea/results/table_file.h"

namespace fovea::regression {
namespace {

using results::TableFile;
using results::table_row;

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 7> kNames = {"figures.csv",   "parameters.csv", "inputs.csv", "profile.csv",
                                                    "functions.csv", "paths.csv",      "objects.csv"};
constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;

bool is_reference_file(std::string_view name) { return std::find(kNames.begin(), kNames.end(), name) != kNames.end(); }

}  // namespace

const app::FolderKind kReferenceKind = {.owner = "a baseline's reference",
                                        .is_file = is_reference_file,
                                        .folders = {},
                                        .mark = "figures.csv",
                                        .is_foreign_mark = [](const fs::path&) { return false; }};

std::map<std::string, std::string> reference_files(const RunFigures& run) {
  std::map<std::string, std::string> out;
  // Figures that are zero are left out: they are most of them, and say nothing.
  std::string& figures = out["figures.csv"] = table_row({"name", "value", "unit"});
  for (const auto& [name, m] : run.metrics)
    if (m.value && *m.value != 0) figures += table_row({name, exact_text(*m.value, m.whole), m.unit});
  std::string& parameters = out["parameters.csv"] = table_row({"key", "value", "default"});
  for (const auto& [key, p] : run.parameters)
    if (!p.path) parameters += table_row({key, p.value, p.default_value});
  std::string& inputs = out["inputs.csv"] = table_row({"key", "sha256"});
  for (const auto& [key, hash] : run.hashes) inputs += table_row({key, hash});
  const Attribution attribution = attribution_of(run, true);
  out["profile.csv"] = attribution_csv(attribution);
  if (!attribution.places.empty()) out["functions.csv"] = places_csv(attribution);
  if (!attribution.paths.empty()) out["paths.csv"] = paths_csv(attribution);
  if (!attribution.objects.empty()) out["objects.csv"] = objects_csv(attribution);
  return out;
}

std::string reference_hash(const std::map<std::string, std::string>& files) {
  std::string all;
  for (const auto& [name, text] : files) all += fmt::format("{} {}\n{}", name, text.size(), text);
  return files.empty() ? "" : app::sha256_of_text(all);
}

std::string reference_hash(const fs::path& folder) {
  std::error_code error;
  std::map<std::string, std::string> files;
  for (const std::string_view name : kNames)
    if (fs::exists(folder / name, error)) files[std::string(name)] = app::read_file(folder / name, kMaxFileBytes);
  return reference_hash(files);
}

fs::path reference_folder(const Baseline& baseline) {
  std::error_code error;
  const std::string file = app::one_line(baseline.file.string()), name = app::one_line(baseline.reference.string());
  if (baseline.reference_sha256.empty()) {
    if (fs::is_directory(baseline.reference, error)) return baseline.reference;
    throw UserError(fmt::format("{}: the folder '{}' that 'reference' names is not there", file, name));
  }
  for (const char* suffix : {"", ".tmp", ".old"})
    if (fs::path folder = app::with_suffix(baseline.reference, suffix);
        reference_hash(folder) == baseline.reference_sha256)
      return folder;
  throw UserError(
      fmt::format("{}: the folder '{}' {}; allowed: the folder that was made with the baseline, or 'fovea bless' of a "
                  "run, which writes both",
                  file, name,
                  fs::is_directory(baseline.reference, error) ? "has other files than 'reference_sha256' says"
                                                              : "that 'reference' names is not there"));
}

RunFigures read_reference(const Baseline& baseline) {
  RunFigures run;
  run.folder = reference_folder(baseline);
  run.version = baseline.version;
  run.commit = baseline.commit;
  constexpr std::string_view kModified = "-modified";
  if (run.commit.ends_with(kModified)) {
    run.modified = true;
    run.commit.resize(run.commit.size() - kModified.size());
  }
  run.subject = baseline.subject;
  const TableFile figures(run.folder / "figures.csv", {"name", "value", "unit"});
  for (std::size_t i = 0; i < figures.rows(); ++i) {
    const std::string& text = figures.text(i, "value");
    double value = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc{} || end != text.data() + text.size())
      throw UserError(fmt::format("'{}', row {}: '{}' is not a number",
                                  app::one_line((run.folder / "figures.csv").string()), i + 2,
                                  app::one_line(text, 40)));
    run.metrics[figures.text(i, "name")] = {value, figures.text(i, "unit"),
                                            text.find_first_of(".e") == text.npos};
  }
  const TableFile parameters(run.folder / "parameters.csv", {"key", "value", "default"});
  for (std::size_t i = 0; i < parameters.rows(); ++i)
    run.parameters[parameters.text(i, "key")] = {parameters.text(i, "value"),
                                                 parameters.text(i, "default"), ""};
  const TableFile inputs(run.folder / "inputs.csv", {"key", "sha256"});
  for (std::size_t i = 0; i < inputs.rows(); ++i)
    run.hashes[inputs.text(i, "key")] = inputs.text(i, "sha256");
  return run;
}

}  // namespace fovea::regression
