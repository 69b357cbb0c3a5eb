// What the C++ reader of results reads of a folder, as lines with tabs: the oracle of the Python package.
//   figure FILE NAME VALUE UNIT DESCRIPTION     VALUE as number_text() has it; "none": it has none
//   param KEY VALUE
//   word NAME TEXT
//   warning KIND COUNT WHAT
//   cell TABLE ROW COLUMN TEXT NUMBER           NUMBER: as number_text(); "-": the cell is no number
#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "model/common/check.h"
#include "sw/fovea/results/csv.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/results/stored_run.h"

namespace {

namespace results = fovea::results;

/// A text in one line without tabs.
std::string plain(std::string text) {
  std::ranges::replace_if(text, [](char c) { return c == '\n' || c == '\t'; }, ' ');
  return text;
}

void say(std::initializer_list<std::string> fields) {
  bool first = true;
  for (const std::string& field : fields) {
    std::cout << (first ? "" : "\t") << plain(field);
    first = false;
  }
  std::cout << "\n";
}

void say_figures(const char* file, const std::vector<results::Figure>& figures) {
  for (const results::Figure& f : figures)
    say({"figure", file, f.name, f.value ? fovea::app::number_text(*f.value) : "none", f.unit, f.description});
}

std::string number_of(const results::CsvPlace& place, const std::string& field) {
  try {
    return fovea::app::number_text(results::number(place, field));
  } catch (const fovea::UserError&) {
    return "-";
  }
}

void say_table(const std::filesystem::path& file) {
  std::vector<std::string> names;
  std::size_t number = 0;
  results::each_csv_row(
      file, {},
      [&](const results::CsvPlace& place, std::span<const std::string> fields) {
        for (std::size_t n = 0; n < fields.size(); ++n)
          say({"cell", file.stem(), std::to_string(number), names.at(n), fields[n], number_of(place, fields[n])});
        ++number;
      },
      results::kMaxRowsBytes, [&](std::span<const std::string> all) { names.assign(all.begin(), all.end()); });
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  const results::StoredRun run = results::read_stored_run(argv[1], true);
  say({"word", "complete", run.complete ? "true" : "false"});
  say({"word", "ended_by", run.ended_by});
  say({"word", "kernel", run.kernel});
  say({"word", "version", run.version});
  say({"word", "commit", run.commit});
  for (const results::Parameter& p : run.parameters) say({"param", p.key, p.value});
  for (const results::Warning& w : run.warnings) say({"warning", w.kind, std::to_string(w.count), w.what});
  say_figures("stats", run.figures);
  say_figures("host", run.host);
  std::vector<std::filesystem::path> tables;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1]))
    if (entry.path().extension() == ".csv") tables.push_back(entry.path());
  std::ranges::sort(tables);
  for (const auto& table : tables) say_table(table);
} catch (const fovea::UserError& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
