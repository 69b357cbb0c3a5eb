// `fovea check EXPERIMENT A B`: two programs are run, and the second is held against the first.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "sw/fovea/machine/command.h"
#include "sw/fovea/regression/baseline.h"

namespace fovea::regression {

struct PairRequest {
  std::string experiment, before, after;  ///< files
  std::vector<std::string> settings;      ///< key=value, for both runs
  std::string out;                        ///< folder for the results; empty: they are not kept
  std::string tolerance;                  ///< of the costs, as of a first baseline
};

/// The results of both, and the first ones as a baseline. Files that are not kept live as long as the object.
class PairRuns {
 public:
  /// Runs both at once, with a profile. @throws UserError, Stopped
  PairRuns(const PairRequest& request, const app::CliContext& context);
  ~PairRuns();
  PairRuns(const PairRuns&) = delete;
  PairRuns& operator=(const PairRuns&) = delete;

  /// The exit status of a run that failed, which has said why; 0: both have results.
  int status() const { return status_; }
  const RunFigures& after() const { return after_; }
  const Baseline& baseline() const { return baseline_; }

 private:
  std::filesystem::path temporary_;
  int status_ = 0;
  RunFigures after_;
  Baseline baseline_;
};

}  // namespace fovea::regression
