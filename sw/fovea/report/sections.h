// The sections of the page, each as HTML. What a chart shows is drawn by the page's script; every
// figure that a reader may quote is text here.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "sw/fovea/explain/explain.h"
#include "sw/fovea/report/pictures.h"
#include "sw/fovea/report/results.h"

namespace fovea::report {

using Runs = std::vector<Results>;

/// A section of the page: the word in its address, its heading, its HTML.
struct Section {
  const char *id, *title;
  std::string html;
};
/// All sections, in the order of the page, without those that have nothing to show (page_sections.cpp). The one of the
/// pictures is empty: how much room they have is known last.
std::vector<Section> sections_of(const Runs& runs);
std::string pictures_section(const Runs& runs, const std::vector<RunPictures>& pictures);

/// Clocks of each function in the frames of a run; those of the whole run if it has no frames.
std::vector<explain::FunctionClocks> functions_of(const Results& run);
std::vector<explain::Finding> findings_of(const Results& run);
/// What is different in run `index` from the first one.
std::vector<explain::Finding> differences_of(const Runs& runs, std::size_t index);

/// Which system ran, in a sentence or two; empty if the results do not say.
std::string system_text(const Results& run);
std::string system_section(const Runs& runs);
/// Gives runs whose folders have the same name those of the settings in which they differ.
void name_apart(Runs& runs);
/// "Slowest read of vpbe (the display): 1.924 us at 80.153412 ms: 1.100 us behind ...".
std::string slowest_sentence(const app::SlowestRow& row);
/// The command that runs it again and lists the requests around this one; empty for a replay.
std::string around_command_of(const Results& run, const app::SlowestRow& slowest);
/// The command that finds what binds the remaps of a run; empty for a run without remaps.
std::string binds_command_of(const Results& run);

// Pieces that several sections use.

/// "A: default"; the name alone if there is one run.
std::string title_of(const Runs& runs, std::size_t index);
/// <data value="exact">for people</data>; a dash for a figure without value.
std::string figure_cell(const app::StatRow* figure);
/// A panel for each run beside one another; `inside` gives its HTML.
std::string panels(const Runs& runs, const std::function<std::string(std::size_t)>& inside);
/// The place of a chart, which the script fills. `sentence` says what it shows.
std::string chart(std::string_view kind, std::size_t run, std::string_view sentence);
/// A sentence in place of something that a run does not have.
std::string absent(std::string_view sentence);

/// A table with a heading line; cells are HTML. Columns whose heading begins with '#' are numbers.
class Table {
 public:
  Table(std::string caption, std::vector<std::string> headings);
  void row(const std::vector<std::string>& cells);
  bool empty() const { return rows_.empty(); }
  std::string html() const;

 private:
  std::string caption_, rows_;
  std::vector<std::string> headings_;
};

}  // namespace fovea::report
