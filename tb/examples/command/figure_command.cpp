// `fovea figure`: one figure of a folder of results, for scripts. The example of model/howto/add-a-command.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <ostream>

#include "sw/fovea/cli/command_row.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::app {
namespace {

struct FigureOptions {
  std::string folder, name;
};

int print_figure(const FigureOptions& o, const CliContext& context) {
  const results::StoredRun stored = results::read_stored_run(o.folder);
  for (const results::Figure& f : stored.figures) {
    if (f.name != o.name) continue;
    context.out << (f.value ? number_text(*f.value) : "null") << " " << f.unit << std::endl;
    return kExitDone;
  }
  throw UserError(fmt::format("figure '{}': {} has none of that name; allowed: those of its stats.json",
                              one_line(o.name), one_line(o.folder)));
}

}  // namespace

Command add_figure(CLI::App& app) {
  const auto o = std::make_shared<FigureOptions>();
  CLI::App* const c = app.add_subcommand("figure", "Print one figure of a folder of results");
  c->add_option("dir", o->folder, "Folder of results")->required()->type_name("DIR");
  c->add_option("name", o->name, "Its name in stats.json")->required()->type_name("NAME");
  return {c, [o](const Call& call) { return print_figure(*o, call.context); }};
}

}  // namespace fovea::app
