// `fovea bless`: a baseline, new or changed, and its reference.
#include <fmt/format.h>

#include <ostream>

#include "sw/fovea/checked_file.h"
#include "sw/fovea/output_file.h"
#include "sw/fovea/regression/attribution.h"
#include "sw/fovea/regression/check.h"
#include "sw/fovea/regression/first_baseline.h"
#include "sw/fovea/regression/regression_command.h"
#include "sw/fovea/run_files.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using namespace regression;

/// Puts a complete text in place of a baseline, without a moment in which it is half written.
void replace_file(const fs::path& file, const std::string& text) {
  OutputFile out(file, "--against", "a baseline",
                 [](std::string_view first) { return first.find(kBaselineFormat) != first.npos; });
  out.write(text);
  out.commit();
}

/// True if a reference may be written into this folder.
bool may_hold_reference(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(folder, error))) return true;
  return fs::is_directory(folder, error) && !is_run_folder(folder) &&
         (fs::exists(folder / "figures.csv", error) || fs::is_empty(folder, error));
}

/// What the reference of a new baseline is called: as the baseline, unless a folder of results or another one is.
std::string reference_name(const fs::path& file) {
  const std::string stem = file.stem().string();
  for (const std::string& name : {stem, stem + "-reference"})
    if (may_hold_reference(file.parent_path() / name)) return name;
  throw UserError(
      fmt::format("--against '{}': '{}' and '{}-reference' beside it hold something else, and one of them "
                  "would be the reference; allowed: another name",
                  one_line(file.string()), one_line(stem), one_line(stem)));
}

/// Writes the reference of a baseline if it is missing, belongs to other figures, or can become one
/// by function. @return whether it was written
bool write_reference(const fs::path& folder, const RunFigures& run, const Baseline& baseline, bool changed) {
  std::error_code error;
  if (folder.empty()) return false;
  if (!changed && fs::exists(folder / "figures.csv", error)) {
    const Attribution had = attribution_of(read_reference(baseline), true), has = attribution_of(run, true);
    if (had.by_function >= has.by_function && had.places.empty() <= has.places.empty() &&
        had.startup.empty() <= has.startup.empty())
      return false;
  }
  if (!may_hold_reference(folder))
    throw UserError(
        fmt::format("'{}' would be the reference, but it holds something else; give the baseline another "
                    "name, or another 'reference'",
                    one_line(folder.string())));
  const auto files = reference_files(run);
  fs::create_directories(folder, error);
  for (const auto& [name, text] : files) write_file(folder / name, text);
  return true;
}

/// What was made is read back before it replaces anything. @throws UserError: it is not what was meant
Baseline read_back(const fs::path& file, const std::string& text, const RunFigures& run) {
  const auto wrong = [&](const std::string& what) {
    throw UserError(fmt::format("'{}' stays as it was: what would be written {}", one_line(file.string()), what));
  };
  Baseline now;
  try {
    now = parse_baseline(file, text);
  } catch (const UserError& e) {
    wrong(fmt::format("cannot be read back ({})", e.what()));
  }
  if (now.subject != run.subject) wrong("would be for " + now.subject.text());
  for (const Expectation& e : now.metrics) {
    const Metric* const m = run.metric(e.name);
    if (e.kind == Kind::kExact && (!m || m->value != e.value || m->unit != e.unit))
      wrong(fmt::format("would have another value or unit of '{}'", one_line(e.name, 60)));
  }
  return now;
}

std::string first_text(const RegressionOptions::Bless& o, const RunFigures& run, const fs::path& file) {
  FirstBaseline first{.run = &run, .reference = reference_name(file), .why = o.why};
  for (const auto& folder : o.layouts) first.layouts.push_back(read_run(folder));
  first.tolerance = parse_tolerance(o.tolerance.empty() ? kFirstTolerance : o.tolerance, "--tolerance");
  return new_baseline(first);
}

std::string next_text(const RegressionOptions::Bless& o, const RunFigures& run, const Baseline& baseline) {
  if (!o.tolerance.empty() || !o.layouts.empty())
    throw UserError(fmt::format("{}: '{}' is there, and its tolerances are changed by hand; allowed: a new baseline",
                                o.tolerance.empty() ? "--layout" : "--tolerance", one_line(o.against)));
  check_circumstances(run, baseline);
  return blessed_text(run, baseline, o.why);
}

}  // namespace

int command_bless(const RegressionOptions::Bless& o, const CliContext& context) {
  if (o.why.find_first_not_of(" \t") == std::string::npos)
    throw UserError("--why '': say in a sentence why the figures may change");
  if (!o.tolerance.empty() && !o.layouts.empty())
    throw UserError("--tolerance and --layout exclude each other; choose one");
  const RunFigures run = read_run(o.folder);
  const fs::path file = o.against;
  std::error_code error;
  std::string before, after;
  if (fs::exists(fs::symlink_status(file, error))) {
    const Baseline baseline = read_baseline(file);
    before = baseline.text;
    after = next_text(o, run, baseline);
  } else {
    after = first_text(o, run, file);
  }
  const std::string diff = unified_diff(file.string(), before, after);
  const Baseline now = read_back(file, after, run);
  const bool referred = write_reference(now.reference, run, now, !diff.empty());
  if (!diff.empty()) replace_file(file, after);
  context.out << (diff.empty() ? fmt::format("{} is as this run; nothing to bless\n", file.string()) : diff);
  if (referred) context.out << fmt::format("reference in {}\n", now.reference.string());
  context.out << std::flush;
  std::size_t failures = 0;
  for (const auto& e : now.metrics)
    if (const Finding f = judge(e, run); f.verdict == Verdict::kFail) {
      ++failures;
      context.err << fmt::format("fovea: {} still fails: its kind is {}, which is changed by hand: {}\n", e.name,
                                 kind_name(e.kind), f.words);
    }
  return failures ? kExitCheckFailed : kExitDone;
}

}  // namespace fovea::app
