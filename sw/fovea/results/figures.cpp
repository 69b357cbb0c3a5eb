#include "sw/fovea/results/figures.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include "sw/fovea/results/names.h"

namespace fovea::app {

void add_ddr_shares(std::vector<StatRow>& rows, const DdrSpan& of, std::string_view span) {
  const auto busy = static_cast<double>(of.busy), queued = static_cast<double>(of.queued);
  rows.push_back({names::kDdrUtilisation, busy / of.clocks, "ratio",
                  fmt::format("share of {} in which the SDRAM's data bus moves data", span)});
  rows.push_back({names::kDdrHeadroom, 1 - queued / of.clocks, "ratio",
                  fmt::format("share of {} in which no request is queued at the SDRAM (not the "
                              "bandwidth left over)",
                              span)});
  if (of.queued > 0)
    rows.push_back({names::kDdrEfficiency, busy / queued, "ratio",
                    "clocks with data on the SDRAM's bus / clocks in which a request is queued"});
}

void add_latency_rows(std::vector<LatencyRow>& rows, const std::string& master,
                      const bus::LatencyStats& of) {
  of.each([&](const char* direction, const char* beat, const bus::LatencyHistogram& h) {
    h.each_bin([&](Picoseconds low, Picoseconds high, std::uint64_t count) {
      rows.push_back({master, direction, beat, low, high, count});
    });
  });
}

void add_remap_times(std::vector<StatRow>& rows, double shortest, double mean, double longest) {
  const std::string what = "time to correct (remap) one frame, ";
  rows.push_back({names::kRemapTimeMin, shortest, "s", what + "shortest"});
  rows.push_back({names::kRemapTimeMean, mean, "s", what + "mean"});
  rows.push_back({names::kRemapTimeMax, longest, "s", what + "longest"});
}

StatRow wall_time(double seconds, std::string_view what) {
  return {"wall_time", seconds, "s", fmt::format("host time of {}", what)};
}

StatRow peak_rss() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {"peak_rss", static_cast<std::uint64_t>(usage.ru_maxrss) * 1024, "B",
          "largest resident memory of the process"};
}

StatRow realtime_factor(double simulated, double wall, std::string_view when) {
  return {"realtime_factor", simulated / wall, "x",
          fmt::format("speed against real time: simulated time / host time, {}", when)};
}

StatRow mips(std::uint64_t instructions, double wall, std::string_view when) {
  return {"mips", static_cast<double>(instructions) / wall * 1e-6, "1e6/s",
          fmt::format("guest instructions per host second, {}", when)};
}

}  // namespace fovea::app
