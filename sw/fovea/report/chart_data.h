// What the page's charts are drawn from.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
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

/// From the beginning of one displayed frame to that of the next, in ps; `anchor` is such a beginning.
struct FramePeriod {
  std::uint64_t anchor = 0, length = 0;
};
/// The mean over the displayed frames; empty with fewer than two.
std::optional<FramePeriod> frame_period(const std::vector<video::FrameTimes>& frames);

/// Whole frame periods between two times, or so many together that there are at most `most` intervals.
struct Periods {
  std::vector<std::uint64_t> edges;
  std::uint64_t frames_each = 1;
};
Periods periods(std::uint64_t from, std::uint64_t to, FramePeriod of, std::size_t most);
/// The mean of each interval. A row of the timeline that lies in two of them counts in each by its share of the
/// time. Intervals of whole frames show equal frames alike; others would beat with them.
Bandwidth mean_bandwidth(const Timeline& timeline, const Periods& periods);

/// The words and colours of causes, culprits and masters for the script of the page.
nlohmann::ordered_json words_json();
/// One run for the script of the page: figures, frames, bandwidth, stalls, latencies, stacks.
nlohmann::ordered_json chart_data(const Results& run, const std::string& label);

/// Folded stacks as a tree: name, clocks (with those of the children), children; sorted by name.
/// Parts below 1/5000 of all are joined under "(smaller ones)".
nlohmann::ordered_json stack_tree(const std::vector<std::pair<std::string, std::uint64_t>>& stacks);

}  // namespace fovea::report
