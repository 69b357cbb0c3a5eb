// What the page's charts are drawn from.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "sw/fovea/report/results.h"

namespace fovea::report {

/// Bandwidth in consecutive intervals: `edges` in ps, one more than intervals; for each master the
/// mean of bytes per second, read and written together.
struct Bandwidth {
  std::vector<std::uint64_t> edges;
  std::vector<std::string> masters;  ///< those with any traffic
  std::vector<std::vector<double>> rates;
};
/// Joins rows of the timeline between `from` and `to` (ps) until at most `most` intervals are left.
/// Bytes are kept: the rates times the intervals' lengths add up to the rows' bytes.
Bandwidth bandwidth(const Timeline& timeline, std::uint64_t from, std::uint64_t to,
                    std::size_t most);

/// One run for the script of the page: figures, frames, bandwidth, stalls, latencies, stacks.
nlohmann::ordered_json chart_data(const Results& run, const std::string& label);

/// Folded stacks as a tree: name, clocks (with those of the children), children; sorted by name.
/// Parts below 1/5000 of all are joined under "(smaller ones)".
nlohmann::ordered_json stack_tree(const std::vector<std::pair<std::string, std::uint64_t>>& stacks);

}  // namespace fovea::report
