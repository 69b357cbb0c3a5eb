#include "sw/fovea/machine/command.h"

#include <ostream>

#include "sw/fovea/results/provenance.h"

namespace fovea::app {

void say_note(const std::string& note, const CliContext& context) {
  if (!note.empty()) context.err << "fovea: " << note << std::endl;
}

void say_lost(const LostOutputs& lost, const CliContext& context) {
  for (const auto& why : lost) context.err << "fovea: error: " << why << "; all other results are kept" << std::endl;
}

std::string version_text() { return provenance_text(program_provenance()); }

}  // namespace fovea::app
