// Where the results come from: configuration and provenance.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "sw/fovea/explain/command.h"
#include "sw/fovea/report/html.h"
#include "sw/fovea/report/page.h"
#include "sw/fovea/report/sections.h"

namespace fovea::report {
namespace {

std::string code(std::string_view text) { return "<code>" + escaped(text) + "</code>"; }

/// A page is passed on to other readers: it shows the names of files, not the folders of the user who made it.
std::string shown(std::string_view text) { return escaped(explain::without_folders(text)); }

std::string changed_parameters(const Results& run) {
  Table table("Parameters that were set", {"Key", "Value", "Set by", "Default", "Meaning"});
  for (const auto& p : run.parameters)
    if (p.changed())
      table.row({code(p.key), shown(p.value), shown(p.origin), escaped(p.initial), escaped(p.description)});
  return table.empty() ? absent("Every parameter has its default.") : table.html();
}

std::string all_parameters(const Results& run) {
  Table table("All parameters", {"Key", "Value", "Set by", "Tag", "Source", "Belief", "Meaning"});
  for (const auto& p : run.parameters)
    table.row({code(p.key), shown(p.value), shown(p.origin), escaped(p.tag), escaped(p.source), escaped(p.belief),
               escaped(p.description)});
  return table.html();
}

std::string differing_parameters(const Runs& runs) {
  std::vector<std::string> headings{"Key"};
  for (std::size_t i = 0; i < runs.size(); ++i) headings.push_back(title_of(runs, i));
  headings.push_back("Meaning");
  Table table("Parameters that differ", headings);
  std::set<std::string> keys;
  for (const auto& run : runs)
    for (const auto& p : run.parameters) keys.insert(p.key);
  for (const auto& key : keys) {
    std::vector<std::string> cells{code(key)};
    std::set<std::string> values;
    std::string meaning;
    for (const auto& run : runs) {
      const auto* p = run.parameter(key);
      values.insert(p ? "=" + p->value : "");
      cells.push_back(p ? fmt::format("{} <small>({})</small>", shown(p->value), shown(p->origin)) : "");
      if (p) meaning = p->description;
    }
    cells.push_back(escaped(meaning));
    if (values.size() > 1) table.row(cells);
  }
  return table.empty() ? absent("The runs have the same parameters.") : table.html();
}

std::string command_text(const Results& run) {
  std::vector<std::string> words{"fovea"};
  for (const auto& word : run.arguments) words.push_back(explain::shell_word(explain::without_folders(word)));
  return fmt::format("{}", fmt::join(words, " "));
}

std::string simulator_text(const Results& run) {
  return fmt::format("{} (commit {}{})", run.version, run.commit.empty() ? "unknown" : run.commit,
                     run.modified ? ", modified" : "");
}

std::string origin_table(const Results& run) {
  Table table("Where these results come from", {"What", "Value"});
  table.row({"Experiment", escaped(run.experiment)});
  if (!run.arguments.empty()) table.row({"Command", code(command_text(run))});
  table.row({"Simulator", escaped(simulator_text(run))});
  if (!run.kernel.empty()) table.row({"Remap kernel", code(run.kernel)});
  if (!run.ended_by.empty()) table.row({"Ended by", code(run.ended_by)});
  for (const auto& [key, hash] : run.hashes)
    table.row({fmt::format("SHA-256 of {}", code(key)), hash.empty() ? "not known" : code(hash)});
  for (const auto* name : {"wall_time", "realtime_factor", "peak_rss"})
    if (const auto* figure = app::find(run.host, name))
      table.row({escaped(figure->description), figure_cell(figure)});
  return table.html();
}

}  // namespace

std::string configuration_section(const Runs& runs) {
  std::string out = runs.size() > 1 ? differing_parameters(runs) : "";
  out += panels(runs, [&](std::size_t i) {
    return (runs.size() == 1 ? changed_parameters(runs[i]) : "") +
           "<details><summary>Show all parameters</summary>" + all_parameters(runs[i]) +
           "</details>";
  });
  return out;
}

std::string provenance_section(const Runs& runs) {
  std::set<std::string> simulators;
  for (const auto& run : runs) simulators.insert(simulator_text(run));
  std::string out;
  if (simulators.size() > 1)
    out +=
        "<p class=\"note\">The runs come from different states of the simulator: differences may "
        "be the "
        "model's.</p>";
  else if (runs.size() > 1 && runs[0].modified)
    out +=
        "<p class=\"note\">The simulator's source was modified: the runs may come from different "
        "states of "
        "it.</p>";
  return out + panels(runs, [&](std::size_t i) { return origin_table(runs[i]); });
}

}  // namespace fovea::report
