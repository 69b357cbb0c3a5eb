#include "sw/fovea/cli/report_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <ostream>

#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/output_file.h"
#include "sw/fovea/report/page.h"
#include "sw/fovea/report/sections.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

struct ReportOptions {
  std::vector<std::string> folders;
  std::string out, limits;
  bool text = false, partial = false, across_versions = false;
};

constexpr const char* kName = "report.html";

/// Beside the results of a single run; several have no common folder.
fs::path default_place(const ReportOptions& options) {
  return options.folders.size() == 1 ? fs::path(options.folders.front()) / kName : fs::path(kName);
}

CLI::App* add_options(CLI::App& app, ReportOptions& o) {
  CLI::App* c = app.add_subcommand("report", "Make a page of HTML about a run, or compare several");
  c->add_option("folders", o.folders, "Folder of results; several are compared with the first")
      ->required()
      ->type_name("DIR");
  c->add_option("-o,--out", o.out, "File for the page")
      ->type_name("FILE")
      ->default_str("DIR/report.html; report.html for several");
  c->add_option("--limits", o.limits, "Folder of 'fovea limits --binds' about the first run: what binds it")
      ->type_name("DIR");
  c->add_flag("--text", o.text, "Print verdict and findings instead of making a page");
  c->add_flag("--partial", o.partial,
              "Accept partial results: of a run that was stopped or failed");
  c->add_flag("--across-versions", o.across_versions, "Accept results of another version of fovea");
  return c;
}

int make_report(const ReportOptions& options, const CliContext& context) {
  if (options.folders.size() > report::kMaxRuns)
    throw UserError(fmt::format("report: {} folders; allowed: 1 to {}", options.folders.size(),
                                report::kMaxRuns));
  if (options.text && !options.out.empty())
    throw UserError("report: --text prints to the output; --out does not go with it");
  std::vector<report::Results> runs;
  for (const auto& folder : options.folders)
    runs.push_back(report::load_results(folder, {options.partial, options.across_versions}));
  report::name_apart(runs);
  if (!options.limits.empty()) runs.front().binds = report::load_binds(options.limits, runs.front());
  if (options.text) {
    context.out << report::report_text(runs) << std::flush;
    return kExitDone;
  }
  const fs::path place = options.out.empty() ? default_place(options) : fs::path(options.out);
  OutputFile file(place, "report --out", "a report of Fovea", report::is_report_page);
  file.write(report::report_page(runs));
  file.commit();
  context.out << fmt::format("report in {}\n", one_line(place.string(), std::string::npos)) << std::flush;
  return kExitDone;
}

}  // namespace

Command add_report(CLI::App& app) {
  const auto o = std::make_shared<ReportOptions>();
  CLI::App* const c = add_options(app, *o);
  return {c, [o](const Call& call) { return make_report(*o, call.context); }};
}

void write_report(RunDir& dir, const std::string& name) {
  std::vector<report::Results> runs{report::load_results(dir.folder(), {.partial = true})};
  runs.front().name = name;
  dir.write(kName, report::report_page(runs));
}

}  // namespace fovea::app
