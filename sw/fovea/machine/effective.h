// The effective configuration of a run: what decides its result, however it was written down.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sw/fovea/config/experiment.h"
#include "sw/fovea/machine/machine.h"

namespace fovea::app {

/// The parameters of an experiment with some settings, as a run would have them.
struct EffectiveRun {
  std::unique_ptr<Machine> machine;
  ParamSet params;
  Experiment experiment{params};
  std::string shared;  ///< what share_pictures() says
};

/// What follows from the keys that are set: calibrations, and pictures that cameras share.
/// @return what share_pictures() says @throws UserError
std::string complete_experiment(const ParamSet& params, Experiment& experiment);

/// Reads the experiment, applies the settings and completes it. @throws UserError
std::unique_ptr<EffectiveRun> effective_run(
    const MakeMachine& make_machine, const std::string& experiment, const std::vector<std::string>& settings);

/// The hash of the program, every value of a parameter, and the hashes of all files that are read: a
/// line each. Of a file that is read, the contents count and not its name, except for what is behind
/// the last dot, which tells its format. `program` is program_hash().
std::string identity_of(const EffectiveRun& run, const std::string& program);

/// SHA-256 of this program's own file: another build may have other results.
std::string program_hash();

}  // namespace fovea::app
