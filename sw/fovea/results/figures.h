// Figures that several commands derive from others: one name, unit and sentence for each.
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "model/bus/core/latency_stats.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::app {

/// What the SDRAM did in a span of time, in clocks of the SDRAM.
struct DdrSpan {
  std::uint64_t busy = 0;    ///< with data on its bus
  std::uint64_t queued = 0;  ///< with a request queued
  double clocks = 0;         ///< all
};
/// `ddr.utilisation`, `ddr.headroom` and, if anything was queued, `ddr.efficiency`. `span` is the name
/// of the time in the sentences, such as "the window".
void add_ddr_shares(std::vector<StatRow>& rows, const DdrSpan& of, std::string_view span);

/// The rows of latency.csv of one master.
void add_latency_rows(std::vector<LatencyRow>& rows, const std::string& master,
                      const bus::LatencyStats& of);

/// `frame.remap_time.*`, in seconds.
void add_remap_times(std::vector<StatRow>& rows, double shortest, double mean, double longest);

/// Host figures. `what` completes "host time of ...".
StatRow wall_time(double seconds, std::string_view what);
StatRow peak_rss();
/// `simulated` and `wall` in seconds; `when` completes the sentence, such as "in the measured window".
StatRow realtime_factor(double simulated, double wall, std::string_view when);
StatRow mips(std::uint64_t instructions, double wall, std::string_view when);

}  // namespace fovea::app
