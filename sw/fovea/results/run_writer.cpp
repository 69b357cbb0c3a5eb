#include "sw/fovea/results/run_writer.h"

#include "sw/fovea/results/provenance.h"

namespace fovea::app {

void write_run(RunDir& dir, const FinishedRun& run, std::span<const ResultFile> files,
               std::span<const std::string> command) {
  for (const ResultFile& f : files) dir.write(f.name, f.text);
  dir.write("host.json", host_json(run.host, command, provenance_text(program_provenance())));
  dir.write("stats.json", stats_json({run.stats.begin(), run.stats.end()}, run.complete, run.warnings, run.words));
}

}  // namespace fovea::app
