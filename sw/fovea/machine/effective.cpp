#include "sw/fovea/machine/effective.h"

#include <fmt/format.h>

#include "sw/fovea/config/calibration.h"
#include "sw/fovea/config/shared_pictures.h"
#include "sw/fovea/results/provenance.h"

namespace fovea::app {

std::string complete_experiment(const ParamSet& params, Experiment& experiment) {
  apply_calibrations(params, experiment);
  return share_pictures(params, experiment);
}

std::unique_ptr<EffectiveRun> effective_run(
    const MakeMachine& make_machine, const std::string& experiment, const std::vector<std::string>& settings) {
  auto out = std::make_unique<EffectiveRun>();
  out->machine = make_machine(MachineKind::kBoard);
  out->machine->declare(out->params);
  out->experiment.load(experiment);
  for (const std::string& s : settings) out->experiment.override_with(s);
  out->shared = complete_experiment(out->params, out->experiment);
  return out;
}

std::string identity_of(const EffectiveRun& run, const std::string& program) {
  std::string out = "program " + program + "\n";
  std::map<std::string, std::string> hashes;
  for (const auto& [key, hash] :
       provenance_of(run.params, run.machine->input_files()).inputs)
    if (!hash.empty()) hashes[key] = hash;
  for (const ParamBase* p : run.params.all()) {
    const auto hash = hashes.find(p->key());
    if (hash == hashes.end())
      out += fmt::format("{}={}\n", p->key(), p->text());
    else
      out += fmt::format("{}=sha256 {} {}\n", p->key(), hash->second,
                         std::filesystem::path(p->text()).extension().string());
  }
  return out;
}

std::string program_hash() {
  // The link itself: the file may have been replaced or removed meanwhile.
  static const std::string hash = sha256_of("/proc/self/exe");
  return hash;
}

}  // namespace fovea::app
