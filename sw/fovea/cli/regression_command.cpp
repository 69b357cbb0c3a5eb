#include "sw/fovea/cli/regression_command.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <memory>
#include <ostream>

#include "sw/fovea/compare/compare.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/output_file.h"
#include "sw/fovea/regression/check.h"
#include "sw/fovea/regression/pair_check.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using namespace regression;

constexpr std::array<const char*, 4> kCommands = {"compare", "check", "bless", "trend"};

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
void check_words(const RegressionOptions::Check& o) {
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

int compare(const RegressionOptions& options, const CliContext& context) {
  const auto& o = options.compare;
  if (o.csv && o.json) throw UserError("--csv and --json exclude each other; choose one");
  const Tolerance tolerance = parse_tolerance(o.tolerance, "--tolerance");
  const RunFigures a = read_run(o.a), b = read_run(o.b);
  if (!o.across_versions) refuse_other_simulator(a, b);
  const Comparison c = compare_runs(a, b, tolerance, o.only);
  if (c.compared == 0)
    throw UserError(fmt::format("no figure matches --only '{}'; stats.json lists all", one_line(o.only)));
  context.out << (o.csv    ? comparison_csv(c)
                  : o.json ? comparison_json(c)
                           : comparison_text(c, tolerance, o.all))
              << std::flush;
  return c.changes.empty() ? kExitDone : kExitCheckFailed;
}

/// A file of `check` beside its report; it is opened before anything is run.
std::unique_ptr<OutputFile> output(const std::string& name, const char* option, const char* kind, const char* part) {
  if (name.empty()) return nullptr;
  return std::make_unique<OutputFile>(name, option, kind,
                                      [part](std::string_view text) { return text.find(part) != text.npos; });
}

int check(const RegressionOptions& options, const CliContext& context) {
  const auto& o = options.check;
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

bool is_regression_command(const std::string& name) {
  return std::find(kCommands.begin(), kCommands.end(), name) != kCommands.end();
}

int command_regression(const std::string& name, const RegressionOptions& options,
                       const CliContext& context) {
  if (name == "compare") return compare(options, context);
  if (name == "check") return check(options, context);
  if (name == "bless") return command_bless(options.bless, context);
  return command_trend(options.trend, context);
}

}  // namespace fovea::app
