// slowest.csv: the slowest request of each master and direction in the window, with what passed meanwhile.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/bus/core/latency_stats.h"

namespace fovea::app {

/// A stretch of the time: `culprit` is "bridge", "service", "row_conflict" ..., a master that was served,
/// "own" or "not_known".
struct SlowestStep {
  std::string place, culprit;  ///< place: port, crossbar, controller, return
  Picoseconds from = 0, to = 0;
};

struct SlowestRow {
  std::string master, direction, port, row_state;  ///< row_state: hit, miss, conflict; empty: not known
  Picoseconds issued = 0, latency = 0;
  std::uint32_t address = 0, row = 0;
  unsigned bytes = 0, bank = 0;
  std::vector<SlowestStep> steps;
};

/// The rows of one master. @param name_of what a port is called in the figures of this command
void add_slowest_rows(std::vector<SlowestRow>& rows, const std::string& master, const bus::LatencyStats& of,
                      const std::function<std::string(Master)>& name_of);

/// A line for each step; those of one request add up to its latency.
std::string slowest_csv(std::span<const SlowestRow> rows);

/// The times of a request by what they were spent on, largest first.
std::vector<std::pair<std::string, Picoseconds>> slowest_parts(const SlowestRow& row);
/// "1.92 us at 80.153412 ms"
std::string slowest_when(const SlowestRow& row);
/// Of each master the slower of its two directions, the slowest first.
std::vector<SlowestRow> slowest_of_each(std::span<const SlowestRow> rows);

}  // namespace fovea::app
