// The answers of `fovea limits` as text and as tables.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "sw/fovea/limits/study.h"

namespace fovea::limits {

/// Sentences for people, for all combinations.
std::string answers_text(const std::vector<std::unique_ptr<Study>>& studies, const Question& question,
                         const std::vector<Condition>& conditions);
/// limits.csv: a row for each combination and search.
std::string limits_csv(const std::vector<std::unique_ptr<Study>>& studies);
/// binds.csv: a row for each combination and relaxation.
std::string binds_csv(const std::vector<std::unique_ptr<Study>>& studies);
/// points.csv: a row for each point that was asked for, sorted by what it is.
std::string points_csv(std::vector<points::Runner::Entry> entries,
                       const std::vector<Condition>& conditions);

}  // namespace fovea::limits
