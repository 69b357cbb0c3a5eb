// What binds, from the answers of `fovea limits`, in a report.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/explain/explain.h"

namespace fovea::report {

struct Results;

/// A row of binds.csv: one resource, relaxed alone.
struct Relaxed {
  std::string resource;
  std::string binds;  ///< yes, no, perhaps (at an end of what is believed of it), or empty: not tried
  std::string metric, unit, by, settings, remark;
  std::optional<double> gain, plain, reference, relaxed;
  std::string origin = {};                              ///< of the parameters that were relaxed
  std::optional<double> gain_low = {}, gain_high = {};  ///< from both ends of what is believed of them
};

/// The rows that are about this run: those whose plain run has the same figure.
/// @param folder of `fovea limits --binds`
/// @throws UserError: no binds.csv, a damaged one, or answers about other runs only
std::vector<Relaxed> load_binds(const std::filesystem::path& folder, const Results& run);

/// "What binds ...": the finding that runs support; no rows give none.
std::vector<explain::Finding> binds_findings(const std::vector<Relaxed>& rows);

}  // namespace fovea::report
