// How each run of a report ended. The example of model/howto/add-a-report-section.md.
#include "sw/fovea/report/html.h"
#include "sw/fovea/report/sections.h"

namespace fovea::report {

std::string ending_section(const Runs& runs) {
  Table table("What ended each run", {"Run", "Ended by", "Results"});
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (!runs[i].ended_by.empty())
      table.row({escaped(title_of(runs, i)), escaped(runs[i].ended_by), runs[i].complete ? "complete" : "partial"});
  return table.empty() ? "" : table.html();
}

}  // namespace fovea::report
