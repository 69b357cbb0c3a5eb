// `fovea check`: a result against a baseline, or a program against an earlier one.
#include <fmt/format.h>
#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <array>
#include <ctime>
#include <memory>
#include <ostream>

#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/cli/shared_options.h"
#include "sw/fovea/files/output_file.h"
#include "sw/fovea/regression/check.h"
#include "sw/fovea/regression/first_baseline.h"
#include "sw/fovea/regression/pair_check.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using namespace regression;

struct CheckOptions {
  std::vector<std::string> what, sets;  ///< a folder, or an experiment and two programs
  std::string against, junit, markdown, out, tolerance;
  bool all = false, across_versions = false;
};

CLI::App* add_options(CLI::App& app, CheckOptions& k) {
  CLI::App* check = app.add_subcommand(
      "check", "Compare a result with a baseline, or a program with an earlier one, and blame what is worse");
  check
      ->add_option("what", k.what,
                   "Folder of results; or an experiment and two programs, of which the second is held "
                   "against the first")
      ->required()
      ->expected(1, 3)
      ->type_name("DIR | EXPERIMENT A B");
  check->add_option("--against", k.against, "Baseline (YAML) for a folder; 'fovea bless' makes one")->type_name("FILE");
  check->add_option("-s,--set", k.sets, "With two programs: set a parameter of both runs; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  check->add_option("-o,--out", k.out, "With two programs: keep their results as a/ and b/ in this folder")
      ->type_name("DIR");
  check->add_option("--tolerance", k.tolerance, "With two programs: what times and amounts may vary by")
      ->type_name("TEXT")
      ->default_str(std::string(regression::kFirstTolerance));
  check
      ->add_option("--markdown", k.markdown,
                   "Also write five lines for a merge request: figure, before, after, who, why; - prints them instead "
                   "of the report")
      ->type_name("FILE");
  check->add_option("--junit", k.junit, "Also write the result as JUnit XML")->type_name("FILE");
  check->add_flag("--all", k.all, "Also list figures that pass");
  check->add_flag("--across-versions", k.across_versions, kAcrossVersions);
  check->footer(
      "Exit status: 0 passed; 1 a figure is missing or worse than its tolerance allows; 2 wrong "
      "input. A figure of a baseline has: value; unit; tolerance (1%, 2, '1% or 2'; none: the same "
      "number); worse (higher, lower, both): the direction that fails; kind: exact (from a run, "
      "replaced by bless), analytic (calculated) or budget (a limit); reason.");
  return check;
}

/// Date and time of a file in UTC, as JUnit XML wants it.
std::string time_of(const fs::path& file) {
  struct stat info {};
  const std::time_t seconds = ::stat(file.c_str(), &info) == 0 ? info.st_mtime : 0;
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts)};
}

/// What does not go together. @throws UserError
void check_words(const CheckOptions& o) {
  if (o.what.size() == 2)
    throw UserError("check: two words; allowed: DIR --against FILE, or EXPERIMENT A B with two programs");
  if (o.what.size() == 1) {
    if (o.against.empty()) throw UserError("--against is missing: the baseline that the results are compared with");
    if (!o.sets.empty() || !o.out.empty() || !o.tolerance.empty())
      throw UserError("--set, --out and --tolerance are for two programs: check EXPERIMENT A B");
  } else if (!o.against.empty() || o.across_versions) {
    throw UserError("--against and --across-versions do not go with two programs: B is compared with A");
  }
}

/// A file of `check` beside its report; it is opened before anything is run.
std::unique_ptr<OutputFile> output(const std::string& name, const char* option, const char* kind, const char* part) {
  if (name.empty()) return nullptr;
  return std::make_unique<OutputFile>(name, option, kind,
                                      [part](std::string_view text) { return text.find(part) != text.npos; });
}

int check(const CheckOptions& o, const CliContext& context) {
  const bool pair = o.what.size() == 3;
  check_words(o);
  const bool shown = o.markdown == "-";  // in the place of the report
  const auto junit = output(o.junit, "--junit", "JUnit XML", "<testsuite");
  const auto markdown = output(shown ? "" : o.markdown, "--markdown", "the result of a check", "**figure**");
  std::optional<PairRuns> runs;
  if (pair) runs.emplace(PairRequest{o.what[0], o.what[1], o.what[2], o.sets, o.out, o.tolerance}, context);
  if (pair && runs->status()) return runs->status();
  const Baseline baseline = pair ? runs->baseline() : read_baseline(o.against);
  const RunFigures run = pair ? runs->after() : read_run(o.what[0]);
  const CheckResult result = check_run(run, baseline, o.across_versions);
  if (junit) {
    junit->write(junit_xml(result, run, baseline, time_of(run.folder / "stats.json")));
    junit->commit();
  }
  if (markdown) {
    markdown->write(markdown_text(result, run, baseline));
    markdown->commit();
  }
  context.out << (shown ? markdown_text(result, run, baseline) : check_text(result, run, baseline, o.all))
              << std::flush;
  return result.failures() ? kExitCheckFailed : kExitDone;
}

}  // namespace

Command add_check(CLI::App& app) {
  const auto o = std::make_shared<CheckOptions>();
  CLI::App* const c = add_options(app, *o);
  return {c, [o](const Call& call) { return check(*o, call.context); }};
}

}  // namespace fovea::app
