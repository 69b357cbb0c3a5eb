// `fovea bless`: a baseline, new or changed, and its reference.
#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <ostream>

#include "model/common/check.h"
#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/compare/attribution.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/output_file.h"
#include "sw/fovea/files/output_folder.h"
#include "sw/fovea/regression/check.h"
#include "sw/fovea/regression/first_baseline.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using namespace regression;

struct BlessOptions {
  std::string folder, against, why, tolerance;
  std::vector<std::string> layouts;
};

CLI::App* add_options(CLI::App& app, BlessOptions& b) {
  CLI::App* bless = app.add_subcommand("bless", "Put the figures of a run into a baseline, or begin one");
  bless->add_option("dir", b.folder, "Folder of results")->required()->type_name("DIR");
  bless->add_option("--against", b.against, "Baseline (YAML), required; a name that is not there makes a new one")
      ->required()
      ->type_name("FILE");
  bless->add_option("--why", b.why, "Reason, required; kept in the baseline")->required()->type_name("TEXT");
  bless->add_option("--tolerance", b.tolerance, "Of a new baseline: what its times and amounts may vary by; 0: nothing")
      ->type_name("TEXT")
      ->default_str(std::string(regression::kFirstTolerance));
  bless
      ->add_option("--layout", b.layouts,
                   "Of a new baseline: results of the program linked in another order or at other addresses; may be "
                   "repeated. Tolerances are then twice the largest deviation")
      ->type_name("DIR")
      ->allow_extra_args(false);
  bless->footer(
      "Prints the change as a diff. Comments and order stay; analytic values and budgets are "
      "never replaced (exit status 1 if one of them fails). The reference for blame, in the "
      "folder that the baseline names, becomes this run's.");
  return bless;
}

/// Why no reference may be put here; empty if one may.
std::string obstacle(const fs::path& folder) {
  const FolderContents found = folder_contents(folder, kReferenceKind);
  if (!found.exists) return "";
  if (!found.folder) return "is no folder";
  if (found.other_users) return "belongs to another user";
  if (!found.foreign.empty())
    return fmt::format("holds something else: '{}' is no file of a reference", one_line(found.foreign));
  std::error_code error;
  return found.vacant || fs::exists(folder / kReferenceKind.mark, error) ? "" : "holds something else";
}

/// What the reference of a new baseline is called: as the baseline, unless a folder of results or another one is.
std::string reference_name(const fs::path& file) {
  const std::string stem = file.stem().string();
  for (const std::string& name : {stem, stem + "-reference"})
    if (obstacle(file.parent_path() / name).empty()) return name;
  throw UserError(
      fmt::format("--against '{}': '{}' and '{}-reference' beside it hold something else, and one of them "
                  "would be the reference; allowed: another name",
                  one_line(file.string()), one_line(stem), one_line(stem)));
}

/// True if an unchanged baseline gets a reference: it has none, has lost it, or the run can tell more by function.
bool improves_reference(const Baseline& baseline, const RunFigures& run) {
  if (baseline.reference.empty()) return false;
  std::optional<RunFigures> reference;
  try {
    reference = read_reference(baseline);
  } catch (const UserError&) {
    return true;  // what cannot be read is written again
  }
  const Attribution had = attribution_of(*reference, true), has = attribution_of(run, true);
  return had.by_function < has.by_function || had.places.empty() > has.places.empty() ||
         had.startup.empty() > has.startup.empty();
}

/// A killed `bless` may have put in the place of the reference one whose baseline it did not write any more. Then the
/// right one lies beside it, and is put back. Nothing is lost if this is interrupted.
void restore_reference(const Baseline& baseline) {
  if (baseline.reference.empty() || baseline.reference_sha256.empty()) return;
  fs::path beside;
  try {
    beside = reference_folder(baseline);
  } catch (const UserError&) {
    return;  // there is none: it is written again
  }
  const fs::path& place = baseline.reference;
  if (beside == place) {
    std::error_code error;
    if (fs::exists(with_suffix(place, ".tmp"), error)) OutputFolder(fs::absolute(place), kReferenceKind);  // removes it
    return;
  }
  if (!obstacle(place).empty() || !obstacle(beside).empty()) return;
  if (::renameat2(AT_FDCWD, beside.c_str(), AT_FDCWD, place.c_str(), RENAME_EXCHANGE) == 0) {
    remove_folder(beside, kReferenceKind);
    return;
  }
  // There is none in its place, or the file system cannot exchange names.
  remove_folder(place, kReferenceKind);
  if (::rename(beside.c_str(), place.c_str()) != 0)
    throw UserError(fmt::format("'{}', the reference, cannot be renamed to '{}': {}", one_line(beside.string()),
                                one_line(place.string()), std::strerror(errno)));
}

/// What was made is read back before it replaces anything. @throws UserError: it is not what was meant
Baseline read_back(const fs::path& file, const std::string& text, const RunFigures& run, const std::string& hash = "") {
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
  if (!hash.empty() && now.reference_sha256 != hash) wrong("would have another 'reference_sha256'");
  for (const Expectation& e : now.metrics) {
    const Metric* const m = run.metric(e.name);
    if (e.kind == Kind::kExact && (!m || m->value != e.value || m->unit != e.unit))
      wrong(fmt::format("would have another value or unit of '{}'", one_line(e.name, 60)));
  }
  return now;
}

std::string first_text(const BlessOptions& o, const RunFigures& run, const fs::path& file) {
  FirstBaseline first{.run = &run, .reference = reference_name(file), .why = o.why};
  for (const auto& folder : o.layouts) first.layouts.push_back(read_run(folder));
  first.tolerance = parse_tolerance(o.tolerance.empty() ? kFirstTolerance : o.tolerance, "--tolerance");
  return new_baseline(first);
}

std::string next_text(const BlessOptions& o, const RunFigures& run, const Baseline& baseline) {
  if (!o.tolerance.empty() || !o.layouts.empty())
    throw UserError(fmt::format("{}: '{}' is there, and its tolerances are changed by hand; allowed: a new baseline",
                                o.tolerance.empty() ? "--layout" : "--tolerance", one_line(o.against)));
  check_circumstances(run, baseline);
  return blessed_text(run, baseline, o.why);
}

bool is_baseline(std::string_view first) { return first.find(kBaselineFormat) != first.npos; }

struct Blessed {
  std::string before, after;
  Baseline now;
  bool referred = false;  ///< a reference was written
};

/// Puts baseline and reference in place. Whatever happens in between, the baseline finds its own reference by its hash:
/// in its place before the last step, or beside it. So it is the last step that makes both valid.
void put_in_place(OutputFile& out, const Blessed& b, const std::map<std::string, std::string>& files) {
  out.write(b.after);
  out.sync();
  fs::path aside;
  std::optional<OutputFolder> folder;
  if (b.referred) {
    folder.emplace(fs::absolute(b.now.reference), kReferenceKind);
    for (const auto& [name, text] : files) {
      FOVEA_CHECK(kReferenceKind.is_file(name), "reference.cpp does not list the file " + name);
      folder->write(name, text);
    }
    folder->complete();
    aside = folder->place(fs::absolute(b.now.reference));
  }
  out.commit();
  if (!aside.empty()) remove_folder(aside, kReferenceKind);
}

/// One attempt, alone from reading to writing. @return nothing if the baseline was first given the hash of the
/// reference that it has, so that these two belong together; then another attempt follows
std::optional<Blessed> bless(const BlessOptions& o, const RunFigures& run) {
  const fs::path file = o.against;
  OutputFile out(file, "--against", "a baseline", is_baseline);
  Blessed b;
  std::optional<Baseline> had;
  std::error_code error;
  if (fs::exists(fs::symlink_status(file, error))) {
    had = read_baseline(file);
    restore_reference(*had);
    b.before = had->text;
    b.after = next_text(o, run, *had);
  } else {
    b.after = first_text(o, run, file);
  }
  b.now = read_back(file, b.after, run);
  b.referred = !b.now.reference.empty() && (b.after != b.before || improves_reference(b.now, run));
  const auto files = reference_files(run);
  if (b.referred) {
    if (const std::string why = obstacle(b.now.reference); !why.empty())
      throw UserError(fmt::format("'{}' would be the reference, but it {}; give the baseline another name, or another "
                                  "'reference'",
                                  one_line(b.now.reference.string()), why));
    if (const std::string hash = reference_hash(b.now.reference);
        had && had->reference_sha256.empty() && !hash.empty()) {
      out.write(with_reference_hash(*had, hash));
      out.commit();
      return std::nullopt;
    }
    const std::string hash = reference_hash(files);
    b.after = with_reference_hash(b.now, hash);
    b.now = read_back(file, b.after, run, hash);
  }
  if (b.referred || b.after != b.before) put_in_place(out, b, files);
  return b;
}

int bless_result(const BlessOptions& o, const CliContext& context) {
  if (o.why.find_first_not_of(" \t") == std::string::npos)
    throw UserError("--why '': say in a sentence why the figures may change");
  if (!o.tolerance.empty() && !o.layouts.empty())
    throw UserError("--tolerance and --layout exclude each other; choose one");
  const RunFigures run = read_run(o.folder);
  std::optional<Blessed> b;
  while (!b) b = bless(o, run);
  const std::string diff = unified_diff(fs::path(o.against).string(), b->before, b->after);
  context.out << (diff.empty() ? fmt::format("{} is as this run; nothing to bless\n", o.against) : diff);
  if (b->referred) context.out << fmt::format("reference in {}\n", b->now.reference.string());
  context.out << std::flush;
  std::size_t failures = 0;
  for (const auto& e : b->now.metrics)
    if (const Finding f = judge(e, run); f.verdict == Verdict::kFail) {
      ++failures;
      context.err << fmt::format("fovea: {} still fails: its kind is {}, which is changed by hand: {}\n", e.name,
                                 kind_name(e.kind), f.words);
    }
  return failures ? kExitCheckFailed : kExitDone;
}

}  // namespace

Command add_bless(CLI::App& app) {
  const auto o = std::make_shared<BlessOptions>();
  CLI::App* const c = add_options(app, *o);
  return {c, [o](const Call& call) { return bless_result(*o, call.context); }};
}

}  // namespace fovea::app
